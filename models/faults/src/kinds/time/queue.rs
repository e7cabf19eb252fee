//! Queue of epochs that are held back.

use crate::station::FLIGHT_MAX;
use alloc::collections::VecDeque;
use octant_state::StateError;

/// Checks that a loaded queue is not longer than can be held back, and reserves room for as much.
pub(super) fn check_queue<T>(queue: &mut VecDeque<T>) -> Result<(), StateError> {
    octant_state::check_below("queue", queue.len() as u64, FLIGHT_MAX as u64)?;
    queue.reserve_exact(FLIGHT_MAX - queue.len());
    Ok(())
}
