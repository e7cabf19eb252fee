//! Statistics of many runs.
//!
//! - [`mod@allan`] has the Allan variance of a sensor at rest, and the noise terms that describe it
//! - [`sample`] has the figures of a sample, [`position`] those of position errors: CEP50, R95, drms
//! - [`chi_squared`] has the distribution of χ²
//! - [`radius`] has the distance of a normal error in the plane
//! - [`cluster`] finds the independent draws among rows, the unit of inference
//! - [`quantile`] gives distribution-free bounds, [`proportion`] bounds of a pass probability
//! - [`looks`] has claims on a pass probability from data that is looked at while it grows
//! - [`rate`] has the radial error rate and the time-RMS, [`mod@envelope`] percentiles over time
//! - [`rank`] finds the factors that an output is sensitive to, [`outlier`] the runs that stand out
//! - [`paired`] compares two sets of runs seed by seed
//! - [`power`] gives the smallest effect that a number of runs detects
//! - [`multiple`] corrects for many comparisons
//! - [`draw`] draws the factors of runs: distributions, Latin hypercubes, correlations
//! - [`mod@convergence`] shows the convergence of an estimate with the number of runs
//!
//! Every function names its source. Nothing in this crate depends on scenarios or files.

pub mod allan;
pub mod chi_squared;
pub mod cluster;
pub mod convergence;
pub mod draw;
pub mod envelope;
pub mod looks;
pub mod multiple;
pub mod normal;
pub mod outlier;
pub mod paired;
pub mod position;
pub mod power;
pub mod proportion;
pub mod quantile;
pub mod radius;
pub mod rank;
pub mod rate;
pub mod sample;
