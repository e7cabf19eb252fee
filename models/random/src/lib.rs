//! Named, counter-based streams of random numbers: what a model draws depends on the seed, the
//! stream's name and the sample number, and on nothing that was drawn before.
//!
//! Adding a sensor, a fault or a stream moves no number of any other; a run with a fault minus the
//! run without it is a controlled experiment.
#![no_std]

extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod normal;
pub mod philox;
pub mod stream;
