//! Faults on connections between models: on a value on its way from an output to an input.
//!
//! A master of several models transfers values at communication points, one before each step. The
//! faults on a connection act on what is transferred, in the order in which they are declared,
//! after units and types were converted: on the value as the input gets it. Epoch k is the step
//! from point k − 1 to point k, counted from 1, so that a fault which sets in at time t alters first
//! what is transferred at t, as in [`crate::station`].
//!
//! - [`kinds`]: the kinds, with their models, as data
//! - [`station`]: which faults act at an epoch, on what, and what they altered

pub mod kinds;
pub mod station;

pub use kinds::{Kind, Target};
pub use station::{Spec, Station};
