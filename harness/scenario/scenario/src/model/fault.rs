//! A fault of a scenario.

use crate::error::Place;
use octant_faults::station::FaultSpec;

/// A fault of a scenario.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Specification for the station.
    pub spec: FaultSpec,
    /// Epochs at which it is fired by hand, in order. Empty if its trigger isn't manual, or if nobody
    /// fires it.
    pub fires: Vec<u64>,
    /// Place in the scenario.
    pub place: Place,
}
