//! What a run is worth: drift of the navigation, accuracy of the parameters, verdict.
//!
//! - [`drift`]: errors of the navigation solution, streamed at 1 Hz or slower
//! - [`parameters`]: estimates against truth, normalized by their σ
//! - [`reference`]: what physics says the scores should be
//! - [`floor`]: what the noise of the sensors alone does to a free inertial solution
//! - [`ensemble`]: statistics over many runs
//! - [`compare`]: two methods, paired
//! - [`summary`]: `summary.json`
//! - [`verdict`]: requirements, and the verdict that follows from them
//! - [`junit`]: the same for CI systems

pub mod compare;
pub mod drift;
pub mod ensemble;
pub mod floor;
pub mod junit;
pub mod parameters;
pub mod reference;
mod regression;
mod series;
pub mod summary;
pub mod verdict;
