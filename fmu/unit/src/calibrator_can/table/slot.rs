//! The first slot of each variable.

use super::MODEL;

pub const NOTIFICATIONS: usize = MODEL.slot(super::NOTIFICATIONS);
pub const FD: usize = MODEL.slot("can.fd");
pub const BIT_RATE: usize = MODEL.slot("can.bit_rate");
pub const DATA_BIT_RATE: usize = MODEL.slot("can.data_bit_rate");
pub const ARBITRATION_LOST: usize = MODEL.slot("can.arbitration_lost");
pub const NODE_STATE: usize = MODEL.slot("can.node_state");
pub const TRANSMIT_ERRORS: usize = MODEL.slot("can.transmit_errors");
pub const RECEIVE_ERRORS: usize = MODEL.slot("can.receive_errors");
pub const WAITING: usize = MODEL.slot("can.waiting");
pub const LOST: usize = MODEL.slot("can.lost");
/// The first output of the core, here and in the Calibrator.
pub const OUTPUTS: usize = MODEL.slot("gimbal_command.azimuth");
pub const CALIBRATOR_OUTPUTS: usize =
    crate::calibrator::table::MODEL.slot("gimbal_command.azimuth");
