//! One way of a wire: what is on it, in order, and when it arrives.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Frames that are remembered, to be sent again.
const HISTORY: usize = 33;

/// One way.
#[derive(Clone, Debug)]
pub(super) struct Lane<U> {
    /// On their way, by the time of their arrival.
    queue: VecDeque<(Instant, U)>,
    /// As they were given, the last one first.
    history: VecDeque<U>,
    /// Waits for the next one.
    pub(super) held: Option<U>,
}

impl<U: Clone> Lane<U> {
    pub(super) fn new() -> Self {
        Self {
            queue: VecDeque::with_capacity(64),
            history: VecDeque::with_capacity(HISTORY + 1),
            held: None,
        }
    }

    /// It arrives after a time, and not before those that are on their way already.
    pub(super) fn push(&mut self, unit: U, now: Instant, after: Duration) {
        let due = now + after;
        let due = self.queue.back().map_or(due, |(last, _)| due.max(*last));
        self.queue.push_back((due, unit));
    }

    /// The next one that has arrived.
    pub(super) fn pop(&mut self, now: Instant) -> Option<U> {
        match self.queue.front() {
            Some((due, _)) if *due <= now => self.queue.pop_front().map(|(_, unit)| unit),
            _ => None,
        }
    }

    /// How long until the next one arrives.
    pub(super) fn next_in(&self, now: Instant) -> Option<Duration> {
        self.queue.front().map(|(due, _)| due.saturating_duration_since(now))
    }

    /// Remembers one as it was given.
    pub(super) fn remember(&mut self, unit: &U) {
        self.history.push_front(unit.clone());
        self.history.truncate(HISTORY);
    }

    /// The one that was given so many ago; 0 is the present one.
    pub(super) fn ago(&self, age: u32) -> Option<&U> {
        self.history.get(age as usize)
    }

    /// All that is on its way is lost.
    pub(super) fn clear(&mut self) {
        self.queue.clear();
        self.held = None;
    }
}

/// A time of a fault.
pub(super) fn seconds(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds.clamp(0.0, 1e6))
}

/// A whole number below `count` from one in (0, 1).
pub(super) fn below(number: f64, count: usize) -> usize {
    ((number * count as f64) as usize).min(count.saturating_sub(1))
}
