//! Nightly regression: the fault suite and campaigns, run every night and compared with an accepted
//! one.
//!
//! [`night`] is the record of one, [`suite`] runs the fault suite, [`results`] reads the results of
//! campaigns, [`compare`](mod@compare) pairs two nights seed by seed and finds regressions,
//! [`history`] stores the numbers of all nights, [`accept`](mod@accept) the baseline, [`render`]
//! and [`trend`] show them, in [`units`].

pub mod accept;
mod change;
pub mod compare;
pub mod error;
mod file;
pub mod history;
pub mod night;
pub mod render;
pub mod results;
pub mod suite;
pub mod trend;
pub mod units;
