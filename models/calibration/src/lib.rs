//! The calibration core of a dual-axis rotational INS: the unit under test.
//!
//! A state machine that is stepped one sample at a time ([`Core::step`]): it aligns, turns its own
//! gimbals through a position sequence, estimates its sensors' errors, compensates them and
//! navigates. It gets samples and aiding, never the truth, and it neither allocates nor reads a
//! clock.
//!
//! The modules, in the order in which they handle a sample:
//!
//! | module | idea |
//! |---|---|
//! | [`config`] | configuration of the core, given before the first sample |
//! | [`sequence`], [`positions`], [`schedule`], [`visits`] | `octant_positions`: stops, published sequences, timing of the moves |
//! | [`monitor`] | plain faults of a sample: gaps, stuck channels, saturation |
//! | [`screen`] | increments that jump further than any motion allows |
//! | [`continuity`] | discontinuities of rates, by spikes too small to show in a single sample |
//! | [`compensation`] | subtracting the estimated errors |
//! | [`alignment`] | the first attitude, from gravity and Earth rate |
//! | [`inertial_alignment`] | the same on a base that may turn: from the way in which gravity turns |
//! | [`strapdown`] | attitude, velocity and position from increments |
//! | [`error_model`] | growth of errors: phi-angle and psi-angle form (paper, eq. 1 to 3) |
//! | [`covariance`] | the 39 × 39 covariance and its kernels |
//! | [`filter`] | the closed-loop Kalman filter, its gate and its recovery |
//! | [`further`] | errors beside the parameters that the filter can consider or estimate |
//! | [`drift`] | test whether the parameters are constant while they are estimated |
//! | [`least_squares`] | the second estimator: static attitudes and the moves between them |
//! | [`external_turntable`] | the third estimator: an external turntable's angles as reference |
//! | [`state_machine`] | the procedure, and [`Core`] |
//! | [`table`] | a finished calibration that can be exported and loaded |
#![cfg_attr(not(test), no_std)]

pub mod alignment;
pub mod compensation;
pub mod config;
pub mod continuity;
pub mod covariance;
pub mod drift;
pub mod error_model;
pub mod external_turntable;
pub mod filter;
pub mod further;
pub mod inertial_alignment;
pub mod least_squares;
pub mod monitor;
pub mod screen;
pub mod standstill;
pub mod state_machine;
pub mod strapdown;
pub mod table;

pub use config::CoreConfig;
pub use octant_positions::{positions, schedule, sequence, visits};
pub use state_machine::Core;

// The tests name the crate as its users do. They are a part of it because what they look at is
// private: inlined where samples pass, and in no interface.
#[cfg(test)]
extern crate self as octant_calibration;
#[cfg(test)]
#[path = "../tests/main.rs"]
mod tests;
