//! Runs several FMUs together in fixed steps: reads, initializes and steps a system structure, with
//! faults on its connections.
//!
//! | module | idea |
//! |---|---|
//! | [`ssp`] | system structures as files: SSP |
//! | [`flat`] | a structure without its systems: FMUs and wires |
//! | [`order`] | order in which FMUs step, and the values they step from |
//! | [`graph`], [`solve`] | dependencies, and the solution of loops |
//! | [`references`] | connectors of references to signal dictionaries against their entries |
//! | [`convert`] | conversion of a value on a wire: units, transformations, types |
//! | [`values`] | values on their way between types |
//! | `open` | the FMUs opened |
//! | [`tuning`] | parameters that change while a system runs |
//! | [`requirements`] | limits on signals of the system |
//! | [`stream`] | hash of the inputs, outputs and parameters of a run |
//! | [`system`] | connectors found in the descriptions of the FMUs |

pub mod convert;
mod elements;
pub mod error;
pub mod experiment;
pub mod faults;
pub mod flat;
pub mod graph;
pub mod initialize;
mod open;
pub mod order;
pub mod parameters;
pub mod record;
pub mod references;
pub mod requirements;
pub mod run;
pub mod simulation;
pub mod single;
pub mod solve;
pub mod ssp;
pub mod stream;
pub mod summary;
pub mod system;
pub mod tuning;
pub mod values;
