//! Gimbals, drives and encoders.

mod command;
mod drive;
mod encoder;
mod gimbal;

use crate::catalogue::FaultKind;

pub(super) static KINDS: &[&FaultKind] = &[
    &gimbal::GIMBAL_SLIP,
    &encoder::ENCODER_SLIP,
    &encoder::INDEX_LOSS,
    &gimbal::BACKLASH,
    &drive::STALL,
    &drive::RUNAWAY,
    &drive::OVERSHOOT,
    &gimbal::SHORT_SETTLE,
    &command::SKIPPED_POSITION,
    &command::REPEATED_POSITION,
    &command::WRONG_DIRECTION,
    &command::COMMAND_LATE,
    &command::COMMAND_LOST,
];
