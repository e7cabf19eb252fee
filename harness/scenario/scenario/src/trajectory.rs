//! Files with positions over time: an instrument's own solution, and what it is scored against.

use crate::model::FileName;
use crate::recorded::{Delimiter, RecordedColumn, TimeUnit};
use octant_instruments::navigation::NavigationProtocol;

/// A file with positions over time.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectorySpec {
    /// The file.
    pub file: FileName,
    /// What it is.
    pub format: TrajectoryFormat,
}

/// What a file is.
#[derive(Clone, Debug, PartialEq)]
pub enum TrajectoryFormat {
    /// Columns of text.
    Csv(Box<TrajectoryColumns>),
    /// Sentences of NMEA 0183 (IEC 61162-1).
    Nmea(NmeaChoice),
    /// A solution of RTKLIB.
    Rtklib,
    /// A smoothed best estimate of trajectory: records of 17 doubles.
    Sbet,
    /// The bytes that a unit sent.
    Messages(NavigationProtocol),
}

/// Sentences of an NMEA file that count.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NmeaChoice {
    /// Letters of the talker; `None`: all, which have to agree.
    pub talker: Option<String>,
    /// True if estimated positions and headings (dead reckoning) are left out, as in a reference.
    pub fixes_alone: bool,
    /// Sentences that make a point each; `None`: positions, where the file has some, else headings.
    pub points: Option<NmeaPoints>,
    /// Time of headings that have none of their own; `None`: the first way that the file allows.
    pub heading_time: Option<HeadingTime>,
}

/// Sentences of an NMEA file that make a point each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NmeaPoints {
    /// Positions, each with the heading that follows it.
    Positions,
    /// Headings, each alone.
    Headings,
}

/// Time of a heading that has none of its own, such as that of HDT and THS.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeadingTime {
    /// Parameter `c` of the TAG block before the sentence.
    Tag,
    /// The stamp that a logger wrote before the sentence.
    Stamp,
    /// The sentences with a time of day around it: headings are evenly spread from one to the next.
    Cycle,
    /// An even rate, Hz, from a first time on, ns since 1970, UTC; without one from zero.
    Rate(f64, Option<i64>),
}

/// Columns of a text file; `None`: the name that Octant's exports have, where the header has it.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectoryColumns {
    /// True if names with `true_` before them come first: Octant's exports have a solution and its truth side by
    /// side.
    pub truth_first: bool,
    /// What separates columns.
    pub delimiter: Delimiter,
    /// Lines to skip at the start.
    pub skip_lines: usize,
    /// Lines that start with this are skipped; empty: none.
    pub comment: String,
    /// Time, and its unit where it is a number.
    pub time: (Option<RecordedColumn>, TimeUnit),
    /// Latitude, longitude and height.
    pub position: [Option<RecordedColumn>; 3],
    /// Velocity over ground, north and east.
    pub velocity: [Option<RecordedColumn>; 2],
    /// Roll, pitch and heading.
    pub attitude: [Option<RecordedColumn>; 3],
    /// Radians in a unit of the angles.
    pub angle_rad: f64,
    /// Metres per second in a unit of the velocities.
    pub velocity_mps: f64,
}

/// Reference of a solution.
#[derive(Clone, Debug, PartialEq)]
pub enum SolutionReference {
    /// A file.
    File(TrajectorySpec),
    /// A heading that was surveyed, of an instrument that stands still.
    Heading {
        /// True heading, rad.
        heading_rad: f64,
        /// Its expanded uncertainty (95 %), rad.
        uncertainty_rad: Option<f64>,
    },
}

impl SolutionReference {
    /// The file, where there is one.
    #[must_use]
    pub fn file(&self) -> Option<&TrajectorySpec> {
        match self {
            Self::File(spec) => Some(spec),
            Self::Heading { .. } => None,
        }
    }
}

/// A solution, and the trajectory that it is scored against.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionSpec {
    /// The instrument's solution.
    pub solution: TrajectorySpec,
    /// Time at its beginning that isn't scored, ns.
    pub skip_ns: i64,
    /// The reference.
    pub reference: SolutionReference,
    /// Time added to the solution's times to get those of the reference, ns; `None`: nothing, if both
    /// tell the time on a scale that is known.
    pub offset_ns: Option<i64>,
    /// How far that may be wrong (95 %), s.
    pub offset_uncertainty_s: f64,
    /// Longest time between two rows of the reference that is no gap, ns.
    pub gap_ns: i64,
}
