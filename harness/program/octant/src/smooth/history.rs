//! Estimates over time as a CSV file: a row for each node.

use crate::failure::Failure;
use octant_calibration::covariance::{PARAMETERS, STATE_COUNT};
use octant_observe::covariance::state_name;
use octant_observe::ensemble::state_unit;
use octant_smoother::backward::SmoothedCalibration;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// Version of the columns.
const VERSION: u32 = 1;

/// Writes the file, which must not be there yet.
pub(super) fn write(file: &Path, smoothed: &SmoothedCalibration) -> Result<(), Failure> {
    let bad = |error: std::io::Error| {
        Failure::input(format!("failed to write {}: {error}", file.display()))
    };
    let mut out = std::fs::File::create_new(file).map_err(bad)?;
    out.write_all(table(smoothed).as_bytes()).map_err(bad)
}

/// Time, and for each state: what the smoother adds to the filter's value (parameters) or takes away from its solution (attitude,
/// velocity, position), and σ of filter and smoother; for parameters the filter's value before them.
fn table(smoothed: &SmoothedCalibration) -> String {
    let mut out = format!("# octant smooth, version {VERSION}\ntime_s");
    for state in 0..STATE_COUNT {
        let name = state_name(state);
        let unit = state_unit(state).0;
        if state >= PARAMETERS {
            let _ = write!(out, ",{name} filter [{unit}]");
        }
        let what = if state >= PARAMETERS { "correction" } else { "error" };
        let _ = write!(
            out,
            ",{name} {what} [{unit}],{name} filter sigma [{unit}],{name} smoothed sigma [{unit}]"
        );
    }
    out.push('\n');
    for node in &smoothed.nodes {
        let _ = write!(out, "{}", node.time_s);
        let (errors, after) = (node.errors(), node.covariance());
        for state in 0..STATE_COUNT {
            let si = state_unit(state).1;
            if state >= PARAMETERS {
                let _ = write!(out, ",{:e}", node.node.parameters[state - PARAMETERS] / si);
            }
            let before = node.node.covariance[state][state];
            let sigmas = [before, after[(state, state)]].map(|v| libm::sqrt(v.max(0.0)) / si);
            let _ = write!(out, ",{:e},{:e},{:e}", errors[state] / si, sigmas[0], sigmas[1]);
        }
        out.push('\n');
    }
    out
}
