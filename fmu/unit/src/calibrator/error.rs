//! Errors in the values of a Calibrator.

use octant_calibration::sequence::{STOPS_MAX, SequenceError};
use octant_calibration::state_machine::CoreConfigError;
use octant_state::StateError;

/// A value of the parameters that no configuration can have.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibratorValueError {
    /// An enumeration has no such item.
    #[error("{label} is {found}, which is none of its items")]
    NoItem {
        /// Name of the variable.
        label: &'static str,
        /// Value found.
        found: i32,
    },
    /// A count is too large.
    #[error("{label} is {found}, at most {} is expected", u32::MAX)]
    TooLarge {
        /// Name of the variable.
        label: &'static str,
        /// Value found.
        found: u64,
    },
    /// The number of stops is out of range.
    #[error("{label} is {found}, 1 to {STOPS_MAX} is expected")]
    Stops {
        /// Name of the variable.
        label: &'static str,
        /// Value found.
        found: i32,
    },
    /// The stops are no sequence.
    #[error("{label}: {error}")]
    Sequence {
        /// Name of the variable.
        label: &'static str,
        /// Error in the sequence of stops.
        error: SequenceError,
    },
    /// Four numbers are not a unit quaternion.
    #[error("{label} has the norm {norm}, a unit quaternion is expected")]
    Norm {
        /// Name of the variable.
        label: &'static str,
        /// Norm found.
        norm: f64,
    },
}

/// Reason why there is no Calibrator.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibratorFailure {
    /// The values make no configuration.
    #[error(transparent)]
    Value(#[from] CalibratorValueError),
    /// The core can't be made from the configuration.
    #[error(transparent)]
    Config(#[from] CoreConfigError),
    /// The bytes are no state.
    #[error(transparent)]
    State(#[from] StateError),
}
