//! Observability of a position sequence, and the predicted result, without a run.
//!
//! [`static_rank`](mod@static_rank) is the algebra of static positions, [`covariance`] predicts the
//! result of one configuration, [`ensemble`] that of a scenario's draws, [`perfect`] what a filter with further states
//! sees, [`mod@protection`] what its test for drifts doesn't.

mod bands;
mod border;
pub mod covariance;
pub mod ensemble;
mod not_modelled;
pub mod perfect;
mod platform;
pub mod protection;
pub mod static_rank;
pub mod truth;

pub use static_rank::{StaticRank, static_rank};

// The tests name the crate as its users do. They are a part of it because some look at what is private.
#[cfg(test)]
extern crate self as octant_observe;
#[cfg(test)]
#[path = "../tests/main.rs"]
mod tests;
