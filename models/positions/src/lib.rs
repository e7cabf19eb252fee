//! Sequences of gimbal positions as data, and the timing of the moves between them.
//!
//! | module | idea |
//! |---|---|
//! | [`sequence`] | stops of the two gimbals, and their repetition |
//! | [`positions`] | the published sequences |
//! | [`schedule`] | rates of the turntable, dwells, moves, and the cursor that walks them |
//! | [`visits`] | positions that the stops of a sequence visit, for those who describe it |
#![cfg_attr(not(test), no_std)]

pub mod positions;
pub mod schedule;
pub mod sequence;
pub mod visits;

#[cfg(test)]
extern crate self as octant_positions;
#[cfg(test)]
#[path = "../tests/main.rs"]
mod tests;
