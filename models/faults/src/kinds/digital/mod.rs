//! Alteration of numbers after they were measured.

mod aiding_nan;
mod bit_flip;
mod dropout;
mod lying_status;
mod slow_rate;
mod spike;
mod stuck;
mod wiring;

use crate::catalogue::FaultKind;

pub(super) static KINDS: &[&FaultKind] = &[
    &spike::SPIKE,
    &stuck::STUCK_AT_CURRENT,
    &stuck::STUCK_AT_VALUE,
    &stuck::OUT_OF_RANGE,
    &dropout::DROPOUT_ZERO,
    &dropout::DROPOUT_HELD,
    &dropout::INTERMITTENT,
    &wiring::SIGN_FLIP,
    &wiring::AXIS_SWAP,
    &bit_flip::BIT_FLIP,
    &slow_rate::SLOW_RATE,
    &lying_status::LYING_STATUS,
    &aiding_nan::AIDING_NAN,
];
