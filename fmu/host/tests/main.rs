//! Tests of foreign FMUs from outside, in the one test program of the crate.

#[path = "common/foreign.rs"]
mod foreign;

mod events;
#[cfg(feature = "model-exchange")]
mod exchange;
mod instance;
