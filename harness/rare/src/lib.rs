//! Probabilities of rare failures, and protection levels, by simulation.

pub mod estimate;
pub mod mixture;
pub mod point;
pub mod proposal;
pub mod subset;
