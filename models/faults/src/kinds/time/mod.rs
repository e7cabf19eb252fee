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

use crate::catalogue::Kind;
use crate::station::FLIGHT_MAX;
use alloc::collections::VecDeque;
use octant_state::StateError;

pub(super) static KINDS: &[&Kind] = &[
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

/// Of a queue that was read: no more than can be held back, and room for as many.
fn check_queue<T>(queue: &mut VecDeque<T>) -> Result<(), StateError> {
    octant_state::check_below("queue", queue.len() as u64, FLIGHT_MAX as u64)?;
    queue.reserve_exact(FLIGHT_MAX - queue.len());
    Ok(())
}
