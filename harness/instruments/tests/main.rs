//! Tests of the protocols of inertial units, in one program.
#![allow(clippy::unwrap_used)]

mod common;
mod damage;
#[cfg(feature = "dbc")]
mod dbc;
mod fuzz_corpus;
mod manuals;
mod no_allocation;
mod round_trip;
mod sampler;
