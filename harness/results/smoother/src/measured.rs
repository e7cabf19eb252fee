//! A measurement of the filter, as the smoother needs it.

use octant_calibration::covariance::{MOVING, STATE_COUNT};
use octant_sample::parameters::PARAMETER_COUNT;

/// A row over the states.
pub type Row = [f64; STATE_COUNT];

/// One measurement that the filter used, of three states in a row.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Time of the filter, s.
    pub time_s: f64,
    /// Rows of the moving states of the transition since the measurement before.
    pub transition: [Row; MOVING],
    /// First of the measured states.
    pub first: usize,
    /// Variance of the measurement, of each axis.
    pub variance: f64,
    /// Measured minus expected: the error that the measurement shows, m/s or m.
    pub innovation: [f64; 3],
    /// Rows of the measured states of the covariance after it.
    pub covariance: [Row; 3],
    /// All of the filter, where it is looked at.
    pub node: Option<Box<Node>>,
}

/// The filter at one time, after the measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Covariance of all states.
    pub covariance: [Row; STATE_COUNT],
    /// Estimates of the parameters, SI.
    pub parameters: [f64; PARAMETER_COUNT],
}
