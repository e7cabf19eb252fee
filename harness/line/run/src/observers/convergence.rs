//! The parameters as they converge.

use super::solution::hours;
use octant_sample::Output;
use octant_sample::parameters::ParameterEstimate;
use octant_score::points::ParameterPoint;

/// Number of points that a report draws well.
const POINTS: u64 = 400;

/// Estimates over a calibration, and the last one.
#[derive(Clone, Debug)]
pub struct Convergence {
    period_ns: u64,
    next_ns: u64,
    /// Estimates at about equal intervals.
    pub points: Vec<ParameterPoint>,
    /// Parameters as last reported.
    pub last: Option<ParameterEstimate>,
}

impl Convergence {
    /// Creates the series of a calibration of this duration, s.
    pub(super) fn over(calibration_s: f64) -> Self {
        let period_ns = (calibration_s * 1e9) as u64 / POINTS;
        Self { period_ns, next_ns: 0, points: Vec::new(), last: None }
    }

    /// Takes the parameters that came with an answer.
    pub(super) fn parameters(&mut self, output: &Output, estimate: &ParameterEstimate) {
        self.last = Some(*estimate);
        if output.device_time.ns >= self.next_ns {
            self.next_ns = output.device_time.ns + self.period_ns.max(1);
            self.points.push(ParameterPoint {
                hours: hours(output),
                estimate: estimate.parameters,
                sigma: estimate.sigma,
            });
        }
    }
}
