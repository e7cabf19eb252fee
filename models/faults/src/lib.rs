//! Fault injection: what can go wrong between instrument and calibration core, each kind a model of
//! its own, and the proof that it happened.
//!
//! - [`catalogue`]: every kind with its parameters, its model and where it acts. The scenario's
//!   keys, `octant faults describe` and the documentation are made from it.
//! - [`trigger`]: when a fault sets in, how long it lasts, how it fades and how often it comes back.
//! - [`rule`]: what a kind has to implement: one small trait for each place where a fault acts.
//! - [`station`]: the ordered pipeline between source and endpoint. It decides for every epoch
//!   which faults are active, lets them act in the order of the scenario, and *measures* what they
//!   altered: a receipt is what was found to differ, not what a fault says of itself.
//! - [`kinds`]: the kinds themselves, one family a folder.
//! - [`connection`]: faults on values on their way from one model to another, with the same
//!   triggers and receipts.
//!
//! Faults of the physical world act inside the plant, before its sensors integrate
//! ([`disturbance`]), so that gyros and accelerometers feel the same motion. Faults of a wire are
//! described here ([`wire`]) and realised by who has it; those of the host ([`host`]) by who runs on it.
//!
//! Nothing here allocates after the station is built, and a station whose faults wait costs two
//! comparisons an epoch.
#![no_std]

extern crate alloc;
#[cfg(test)]
extern crate std;

pub mod catalogue;
pub mod connection;
pub mod disturbance;
pub mod host;
pub mod kinds;
pub mod receipt;
pub mod rule;
mod setup;
pub mod station;
pub mod trigger;
pub mod values;
pub mod wire;

pub use catalogue::Kind;
pub use receipt::Receipt;
pub use setup::{BuildError, Setup};
pub use station::{Spec, Station};
pub use values::{Channels, Value, Values};
