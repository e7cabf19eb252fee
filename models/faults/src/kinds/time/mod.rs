//! Stamps, order and delivery.

mod clock;
mod dropout;
mod duplicate;
mod jitter;
mod late;
mod offset;
mod rate;
mod reorder;
mod sequence;
mod stamp;

use crate::catalogue::FaultKind;

pub(super) static KINDS: &[&FaultKind] = &[
    &offset::TIME_OFFSET,
    &offset::TIME_STEP,
    &rate::CLOCK_SKEW,
    &rate::FROZEN_CLOCK,
    &rate::TIME_BACKWARDS,
    &jitter::TIME_JITTER,
    &stamp::DUPLICATE_STAMP,
    &sequence::SEQUENCE_GAP,
    &dropout::DROPOUT,
    &reorder::REORDER,
    &late::LATE_DELIVERY,
    &duplicate::DUPLICATE,
];
