//! The reference of the calibration.

mod late;
mod lost;
mod wrong;

use crate::catalogue::FaultKind;

pub(super) static KINDS: &[&FaultKind] = &[
    &wrong::AIDING_WRONG,
    &wrong::POSITION_JUMP,
    &wrong::AIDING_NOISE,
    &lost::AIDING_LOST,
    &late::AIDING_LATE,
];
