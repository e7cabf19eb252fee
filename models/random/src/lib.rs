//! Named, counter-based streams of random numbers: a number depends on the seed, the stream's name
//! and the sample number, and on no number drawn before.
//!
//! Adding a sensor, a fault or a stream changes no number of any other stream; a run with a fault
//! minus the run without it is a controlled experiment.
#![no_std]

extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod draws;
pub mod normal;
pub mod philox;
pub mod stream;
