//! Fault injection: possible faults between instrument and calibration core, each kind with a model
//! of its own and with evidence of its effect.
//!
//! - [`catalogue`]: every kind with its parameters, its model and its place. The scenario's keys,
//!   `octant faults describe` and the documentation are made from it.
//! - [`trigger`]: onset, duration, fading and repetition of a fault.
//! - [`rule`]: interface of a kind: one small trait for each place where a fault acts.
//! - [`station`]: the ordered pipeline between source and endpoint. It decides for every epoch
//!   which faults are active, lets them act in the order of the scenario, and *measures* what they
//!   altered: a receipt states the differences found, not the claims of a fault.
//! - [`kinds`]: the kinds themselves, one family a folder.
//! - [`connection`]: faults on values on their way from one model to another, with the same
//!   triggers and receipts.
//!
//! Faults of the physical world act inside the plant, before its sensors integrate
//! ([`octant_sample::disturbance`]), so that gyros and accelerometers feel the same motion. Faults
//! of a wire are described here ([`wire`]) and realised by the owner of the wire; those of the host
//! ([`kinds::host`]) by the program that runs on it.
//!
//! Nothing here allocates after the station is built, and a station whose faults wait costs a few
//! comparisons an epoch.
#![no_std]

extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod catalogue;
pub mod connection;
mod dimension;
pub mod kinds;
mod once;
pub mod receipt;
pub mod rule;
mod setup;
pub mod station;
pub mod trigger;
pub mod values;
pub mod wire;

pub use catalogue::FaultKind;
pub use once::TriggerOnce;
pub use receipt::Receipt;
pub use setup::{FaultBuildError, Setup};
pub use station::{FaultSpec, Station};
pub use values::{Channels, Value, Values};
