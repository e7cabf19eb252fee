//! Fixed-interval smoothing of a calibration, and tests of what the filter takes for constant.
//!
//! The filter's estimate at a time rests on what came before. The smoothed one rests on the whole calibration: on what
//! came after too. For a parameter that is constant the two agree at the end, and nothing is gained; attitude and
//! velocity on the way, and biases that walk, are known better afterwards.
//!
//! | module | idea |
//! |---|---|
//! | [`store`] | measurements of a filter, in a file that is read backward: memory doesn't grow with their number |
//! | [`backward`] | the smoother: modified Bryson-Frazier recursion |
//! | [`constancy`] | jumps, ramps, walks and wandering of the parameters |
//! | [`quadratic`] | tail of a quadratic form in normal variables |
//! | [`history`] | the measurements taken from a core while it runs |

pub mod backward;
pub mod constancy;
pub mod history;
pub mod quadratic;
pub mod store;

use nalgebra::{SMatrix, SVector};
use octant_calibration::covariance::STATE_COUNT;

/// A matrix over the states of the filter.
pub type States = SMatrix<f64, STATE_COUNT, STATE_COUNT>;
/// A vector over the states of the filter.
pub type StateVector = SVector<f64, STATE_COUNT>;
