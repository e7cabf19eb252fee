//! Reasons why the files of a solution can't be compared.

use super::point::TimeScale;
use super::reader::TrajectoryError;
use octant_scenario::FileNameError;

/// The files of a solution can't be compared.
#[derive(Debug, thiserror::Error)]
pub enum PairsError {
    /// A file can't be read.
    #[error("read {0}")]
    File(#[from] TrajectoryError),
    /// A file name can't be expanded.
    #[error(transparent)]
    Name(#[from] FileNameError),
    /// The difference between the times of the two files isn't known.
    #[error(
        "compare {solution}, which tells the time in {}, with {reference}, in {}: expected source.trajectory.offset, which is \
         added to the solution's times to get those of the reference, such as \"0 s\"",
        scales.0.name(), scales.1.name()
    )]
    Scales {
        /// File of the solution.
        solution: String,
        /// File of the reference.
        reference: String,
        /// Their scales.
        scales: (TimeScale, TimeScale),
    },
    /// The scenario has another place.
    #[error(
        "score against {reference}, which begins {:.0} km from the site of the scenario: expected site.latitude = \"{:.4} deg\" and \
         site.longitude = \"{:.4} deg\", or near", off_m / 1e3, position_deg[0], position_deg[1]
    )]
    Site {
        /// File of the reference.
        reference: String,
        /// Distance, m.
        off_m: f64,
        /// Its first position, deg.
        position_deg: [f64; 2],
    },
    /// The files are of different times.
    #[error(
        "compare {solution} with {reference}: found no point that has a reference; the solution is from {:.3} to {:.3} s, and the reference from {:.3} to {:.3} s \
         of the same time",
        spans_s[0], spans_s[1], spans_s[2], spans_s[3]
    )]
    Apart {
        /// File of the solution.
        solution: String,
        /// File of the reference.
        reference: String,
        /// Beginning and end of both on the scale of the reference, s.
        spans_s: [f64; 4],
    },
}
