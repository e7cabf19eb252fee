//! Several FMUs run together in fixed steps: a system structure read, initialized, stepped, with
//! faults on its connections.
//!
//! | module | idea |
//! |---|---|
//! | [`ssp`] | system structures as files: SSP |
//! | [`flat`] | a structure without its systems: FMUs and wires |
//! | [`order`] | in which order FMUs step, and from which values |
//! | [`graph`], [`solve`] | what depends on what, and values that depend on themselves |
//! | [`values`] | values on their way between types |

pub mod flat;
pub mod graph;
pub mod order;
pub mod solve;
pub mod ssp;
pub mod values;
