//! Faults on connections between models: on a value on its way from an output to an input.
//!
//! A master of several models transfers values at communication points, one before each step. The
//! faults on a connection act on each transfer in the order in which they are declared, after the
//! conversion of units and types: on the value that the input gets. Epoch k is the step from point
//! k − 1 to point k, counted from 1, so that a fault which sets in at time t first alters the
//! transfer at t, as in [`crate::station`].
//!
//! - [`kinds`]: the kinds, with their models, as data
//! - [`station`]: active faults of an epoch, their elements, and the values that they altered

pub mod kinds;
pub mod station;

pub use kinds::{ConnectionFaultKind, Target};
pub use station::{ConnectionFaultSpec, ConnectionStation};
