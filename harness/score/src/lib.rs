//! What a run is worth: drift of the navigation, accuracy of the parameters, verdict.
//!
//! - [`drift`] scores the errors of the navigation solution, streamed at 1 Hz or slower
//! - [`parameters`] holds estimates against truth, normalized by their σ
//! - [`mod@reference`] and [`floor`] say what physics lets the scores be
//! - [`ensemble`] has the statistics over many runs, [`compare`] those of two methods in pairs
//! - [`health`] counts what the core reported on the way
//! - [`summary`] is `summary.json`, [`work`] is what was planned and done
//! - [`verdict`] holds a measure against its limit, [`judge`] derives the verdict of a summary, [`junit`] tells CI
//! - [`rederive`] holds a stored summary against itself, [`numerics`] says whose bits can be compared, [`equipment`] what expired certificates come to

pub mod compare;
pub mod counterfactual;
pub mod drift;
pub mod ensemble;
pub mod equipment;
pub mod floor;
pub mod health;
pub mod judge;
pub mod junit;
pub mod numerics;
pub mod parameters;
pub mod rederive;
pub mod reference;
mod regression;
mod series;
pub mod summary;
pub mod trace;
pub mod verdict;
pub mod work;
