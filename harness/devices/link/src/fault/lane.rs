//! One direction of a wire: the frames on it, in order, and their times of arrival.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Number of frames that are remembered for replay.
const HISTORY: usize = 33;

/// One direction of a wire.
#[derive(Clone, Debug)]
pub(super) struct Lane<U> {
    /// Frames on their way, with their times of arrival.
    queue: VecDeque<(Instant, U)>,
    /// Frames as they were sent, the last one first.
    history: VecDeque<U>,
    /// Frame held back until the next one.
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

    /// Queues a frame that arrives after a delay, and not before those already queued.
    pub(super) fn push(&mut self, unit: U, now: Instant, after: Duration) {
        let due = now + after;
        let due = self.queue.back().map_or(due, |(last, _)| due.max(*last));
        self.queue.push_back((due, unit));
    }

    /// Takes the next frame that has arrived.
    pub(super) fn pop(&mut self, now: Instant) -> Option<U> {
        match self.queue.front() {
            Some((due, _)) if *due <= now => self.queue.pop_front().map(|(_, unit)| unit),
            _ => None,
        }
    }

    /// Time until the next frame arrives.
    pub(super) fn next_in(&self, now: Instant) -> Option<Duration> {
        self.queue.front().map(|(due, _)| due.saturating_duration_since(now))
    }

    /// Remembers a frame as it was sent.
    pub(super) fn remember(&mut self, unit: &U) {
        self.history.push_front(unit.clone());
        self.history.truncate(HISTORY);
    }

    /// Frame sent `age` frames ago; 0 is the present one.
    pub(super) fn ago(&self, age: u32) -> Option<&U> {
        self.history.get(age as usize)
    }

    /// Drops all frames on their way.
    pub(super) fn clear(&mut self) {
        self.queue.clear();
        self.held = None;
    }
}

/// Duration of a fault's time, s, limited to 1e6 s.
pub(super) fn seconds(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds.clamp(0.0, 1e6))
}

/// Maps a number in (0, 1) to an integer below `count`.
pub(super) fn below(number: f64, count: usize) -> usize {
    ((number * count as f64) as usize).min(count.saturating_sub(1))
}
