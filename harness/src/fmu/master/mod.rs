//! Several FMUs run together in fixed steps: a system structure read, initialized, stepped, with
//! faults on its connections.
//!
//! | module | idea |
//! |---|---|
//! | [`ssp`] | system structures as files: SSP |
//! | [`flat`] | a structure without its systems: FMUs and wires |
//! | [`order`] | in which order FMUs step, and from which values |
//! | [`graph`], [`solve`] | what depends on what, and values that depend on themselves |
//! | [`convert`] | what happens to a value on a wire: units, transformations, types |
//! | [`values`] | values on their way between types |
//! | [`system`] | connectors found in the descriptions of the FMUs |

pub mod convert;
pub mod error;
pub mod experiment;
pub mod faults;
pub mod flat;
pub mod graph;
pub mod initialize;
pub mod order;
pub mod parameters;
pub mod record;
pub mod run;
pub mod simulation;
pub mod solve;
pub mod ssp;
pub mod summary;
pub mod system;
pub mod values;
