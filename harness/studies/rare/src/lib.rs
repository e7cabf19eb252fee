//! Rare failures: the probability that a requirement of a scenario fails, and protection levels of a calibration.
//!
//! [`estimators`] is the mathematics, of anything that runs points of random inputs; [`runs`] are those of a scenario.

pub mod estimators;
pub mod runs;
