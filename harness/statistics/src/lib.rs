//! Statistics of many runs.
//!
//! - [`sample`] has the figures of a sample, [`position`] those of position errors: CEP50, R95, drms
//! - [`mod@deviation`] says how well a σ is known, [`radius`] how far a normal error in the plane gets
//! - [`cluster`] tells the independent draws among rows, the unit of inference
//! - [`quantile`] bounds them without a distribution, [`proportion`] a pass probability
//! - [`rate`] is the radial error rate and the time-RMS, [`mod@envelope`] percentiles over time
//! - [`rank`] says what an output is sensitive to, [`outlier`] which runs stand out
//! - [`paired`] compares two sets of runs seed by seed
//! - [`power`] says what so many runs would find
//! - [`multiple`] corrects many comparisons at once
//! - [`draw`] makes the factors of runs: distributions, Latin hypercubes, correlations
//! - [`mod@convergence`] says how an estimate settles with the number of runs
//!
//! Every function names its source. Nothing here knows scenarios or files.

pub mod cluster;
pub mod convergence;
pub mod deviation;
pub mod draw;
pub mod envelope;
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
