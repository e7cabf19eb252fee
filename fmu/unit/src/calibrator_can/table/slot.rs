//! The first slot of each variable.

use super::MODEL;

pub(in super::super) const NOTIFICATIONS: usize = MODEL.slot(super::NOTIFICATIONS);
pub(in super::super) const FD: usize = MODEL.slot("can.fd");
pub(in super::super) const BIT_RATE: usize = MODEL.slot("can.bit_rate");
pub(in super::super) const DATA_BIT_RATE: usize = MODEL.slot("can.data_bit_rate");
pub(in super::super) const ARBITRATION_LOST: usize = MODEL.slot("can.arbitration_lost");
pub(in super::super) const NODE_STATE: usize = MODEL.slot("can.node_state");
pub(in super::super) const TRANSMIT_ERRORS: usize = MODEL.slot("can.transmit_errors");
pub(in super::super) const RECEIVE_ERRORS: usize = MODEL.slot("can.receive_errors");
pub(in super::super) const WAITING: usize = MODEL.slot("can.waiting");
pub(in super::super) const LOST: usize = MODEL.slot("can.lost");
/// The first output of the core, here and in the Calibrator.
pub(in super::super) const OUTPUTS: usize = MODEL.slot("gimbal_command.azimuth");
pub(in super::super) const CALIBRATOR_OUTPUTS: usize =
    crate::calibrator::table::MODEL.slot("gimbal_command.azimuth");
