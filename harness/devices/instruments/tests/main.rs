//! Tests of the protocols of inertial units, in one program.
#![allow(clippy::unwrap_used)]

mod align;
mod axes;
mod checksum;
mod common;
mod damage;
#[cfg(feature = "dbc")]
mod dbc;
#[cfg(feature = "descriptions")]
mod described;
#[cfg(feature = "descriptions")]
mod described_problems;
mod fuzz_corpus;
mod lines;
mod manuals;
mod navigation;
mod no_allocation;
mod pulses;
mod records;
mod rollover;
mod round_trip;
mod sampler;
mod stamp_scale;
mod timeline;
