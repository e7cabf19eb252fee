//! Errors in the values of a Calibrator on CAN.

use crate::calibrator::CalibratorValueError;
use octant_calibration::state_machine::CoreConfigError;
use octant_state::StateError;

/// Reason why there is no device.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibratorCanFailure {
    /// The values make no configuration of the core.
    #[error(transparent)]
    Value(#[from] CalibratorValueError),
    /// The core can't be made from the configuration.
    #[error(transparent)]
    Config(#[from] CoreConfigError),
    /// Frames that lose the bus would be lost.
    #[error(
        "can.arbitration_lost is discard, for which can.bus_notifications has to be true: frames \
         that lose the bus would be lost"
    )]
    Discard,
    /// The bytes are no state.
    #[error(transparent)]
    State(#[from] StateError),
}
