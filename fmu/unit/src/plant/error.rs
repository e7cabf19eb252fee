//! Errors in the values of a Plant, and in the configurations and faults that become values.

use super::table::{FAULT_SLOTS, SINUSOIDS_MAX};
use octant_plant::PlantConfigError;
use octant_state::StateError;

/// A value of the parameters that no configuration can have, or one for which there is no room.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlantValueError {
    /// An enumeration has no such item.
    #[error("{label} is {found}, which is none of its items")]
    NoItem {
        /// Name of the variable.
        label: &'static str,
        /// Value found.
        found: i32,
    },
    /// An error of the sensors or of gravity for which there is no parameter.
    #[error("{0} is not zero, and the FMU has no parameter for it")]
    NoParameter(&'static str),
    /// The number of sinusoids is out of range.
    #[error("{label} is {found}, 0 to {SINUSOIDS_MAX} is expected")]
    Sinusoids {
        /// Name of the variable.
        label: &'static str,
        /// Value found.
        found: i32,
    },
    /// A motion of the ship has more sinusoids than there is room for.
    #[error("{label} would be {found}, at most {SINUSOIDS_MAX} are possible")]
    TooManySinusoids {
        /// Name of the variable.
        label: &'static str,
        /// Number of sinusoids.
        found: usize,
    },
}

/// Reason why a kind of fault can't act inside a plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Misplaced {
    /// It needs a unit under test.
    #[error("acts on the unit under test, and a plant has none")]
    Unit,
    /// It can deliver more than one sample.
    #[error("can deliver several samples at once, and a plant gives one sample a step")]
    Delivery,
    /// It acts elsewhere.
    #[error("can't act inside a plant")]
    Elsewhere,
}

/// Reason why a fault can't be one of the parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unplaced {
    /// Its kind can't act inside a plant.
    #[error(transparent)]
    Misplaced(#[from] Misplaced),
    /// It has a repetition.
    #[error("comes back, for which there is no place")]
    Repeats,
    /// It has another trigger.
    #[error("has a trigger other than a time and a hand, for which there is no place")]
    Trigger,
    /// It has no value of its parameter of this name.
    #[error("has no value for {0}")]
    NoValue(&'static str),
}

/// Errors in the faults of a Plant.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FaultError {
    /// More faults than the variables have slots.
    #[error("{found} faults were found, at most {FAULT_SLOTS} are possible")]
    TooMany {
        /// Number of faults.
        found: usize,
    },
    /// A fault can't be one of the parameters.
    #[error("fault {id:?} ({kind}) {why}")]
    Unplaced {
        /// Id of the fault.
        id: String,
        /// Name of its kind.
        kind: &'static str,
        /// Reason.
        why: Unplaced,
    },
    /// Unknown kind.
    #[error("{id}.kind is {found}, which is none of its items")]
    NoItem {
        /// Id of the fault.
        id: String,
        /// Value found.
        found: i32,
    },
    /// The kind can't act inside a plant.
    #[error("{id}.kind is {found} ({kind}): it {why}")]
    Misplaced {
        /// Id of the fault.
        id: String,
        /// Value found.
        found: i32,
        /// Name of the kind.
        kind: &'static str,
        /// Reason.
        why: Misplaced,
    },
    /// The kind is of connections.
    #[error("{id}.kind can't act inside a plant")]
    OfConnections {
        /// Id of the fault.
        id: String,
    },
    /// A time is above 0 and is no sample.
    #[error("{label} is {found_s} s, which is less than half a sample")]
    TooShort {
        /// Name of the variable.
        label: &'static str,
        /// Value found, s.
        found_s: f64,
    },
    /// The kind doesn't fade.
    #[error(
        "{id}.recovery is {found_s} s, and a fault of the kind {kind} doesn't fade: 0 is expected"
    )]
    Recovery {
        /// Id of the fault.
        id: String,
        /// Value found, s.
        found_s: f64,
        /// Name of the kind.
        kind: &'static str,
    },
    /// A number is out of the range of its parameter.
    #[error("{id}.values[{place}] ({name} of {kind}) is {found}, {expected} is expected")]
    Number {
        /// Id of the fault.
        id: String,
        /// Place of the number, from 1.
        place: usize,
        /// Parameter of the kind.
        name: &'static str,
        /// Name of the kind.
        kind: &'static str,
        /// Value found.
        found: f64,
        /// Values expected.
        expected: String,
    },
    /// A number beyond those that the kind takes isn't 0.
    #[error("{id}.values[{place}] is {found}, and {kind} takes fewer numbers: 0 is expected")]
    Surplus {
        /// Id of the fault.
        id: String,
        /// Place of the number, from 1.
        place: usize,
        /// Value found.
        found: f64,
        /// Name of the kind.
        kind: &'static str,
    },
    /// The station can't be built.
    #[error("{id}: {error}")]
    Build {
        /// Id of the fault.
        id: String,
        /// Error in its parameters.
        error: octant_faults::FaultBuildError,
    },
    /// The faults can deliver more than one sample.
    #[error("the faults together can deliver {samples} samples in a step, one is possible")]
    Burst {
        /// Largest number of samples.
        samples: usize,
    },
}

/// Reason why a configuration and faults can't become values.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PutError {
    /// The configuration has more values than the variables hold.
    #[error(transparent)]
    Value(#[from] PlantValueError),
    /// The faults have more values than the variables hold.
    #[error(transparent)]
    Fault(#[from] FaultError),
}

/// Reason why there is no Plant.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlantFailure {
    /// The values make no configuration.
    #[error(transparent)]
    Value(#[from] PlantValueError),
    /// The plant can't be made from the configuration.
    #[error(transparent)]
    Config(#[from] PlantConfigError),
    /// The values make no faults.
    #[error(transparent)]
    Fault(#[from] FaultError),
    /// The bytes are no state.
    #[error(transparent)]
    State(#[from] StateError),
}
