//! Gimbals, drives and encoders.

mod drive;
mod encoder;
mod gimbal;

use crate::catalogue::Kind;

pub(super) static KINDS: &[&Kind] = &[
    &gimbal::GIMBAL_SLIP,
    &encoder::ENCODER_SLIP,
    &encoder::INDEX_LOSS,
    &gimbal::BACKLASH,
    &drive::STALL,
    &drive::RUNAWAY,
    &drive::OVERSHOOT,
    &gimbal::SHORT_SETTLE,
];
