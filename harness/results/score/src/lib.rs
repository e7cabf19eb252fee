//! Scores of a run: drift of the navigation, accuracy of the parameters, verdict.
//!
//! - [`drift`] scores the errors of the navigation solution, streamed at 1 Hz or slower, and
//!   [`every_answer`] the largest of all answers between;
//!   [`mod@attitude`] has heading, pitch and roll of the case, [`mod@alignment`] attitude and velocity at one
//!   time with their σ
//! - [`parameters`] compares estimates with truth, normalized by their σ
//! - [`mod@reference`] and [`floor`] give the physical limits of the scores
//! - [`compare`] has the statistics of two methods in pairs
//! - [`health`] counts the reports of the core, [`allan`] has the noise of the sensors at rest
//! - [`summary`] is `summary.json`, [`work`] compares the work planned with the work done
//! - [`verdict`] compares a measure with its limit, [`judge`] derives the verdict of a summary,
//!   [`junit`] writes it for CI
//! - [`points`] and [`run_series`] hold a run over its time, for charts, in bounded memory
//! - [`rederive`] checks a stored summary for contradictions, [`numerics`] tells which programs give
//!   the same bits, [`equipment`] finds expired certificates

pub mod alignment;
pub mod allan;
pub mod attitude;
mod calibration;
mod claim;
pub mod compare;
pub mod counterfactual;
pub mod drift;
pub mod equipment;
pub mod every_answer;
mod finding;
pub mod floor;
mod gaps;
pub mod heading_output;
pub mod health;
pub mod information;
pub mod judge;
pub mod junit;
mod maxima;
mod navigation;
pub mod numerics;
pub mod parameters;
pub mod points;
pub mod rederive;
pub mod reference;
mod regression;
pub mod run_series;
pub mod series;
pub mod sessions;
pub mod summary;
pub mod trace;
pub mod verdict;
pub mod work;
