//! State shared by the thread of the samples and the desk of a person at the bench.
//!
//! Steps are numbers from 0. The thread of the samples reads and writes atomics alone, except for the lines at its end.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// State that a run and the desk share.
#[derive(Debug)]
pub struct Attendance {
    steps: Vec<AttendedStep>,
    /// A person holds the run.
    held: AtomicBool,
    /// Sample before which the run stands, from 1; 0: it goes on.
    stands: AtomicU64,
    /// Records so far, each a line of JSON.
    lines: Mutex<Vec<String>>,
}

#[derive(Debug, Default)]
struct AttendedStep {
    /// Sample before which it is due, plus 1; 0: not yet.
    due: AtomicU64,
    closed: AtomicBool,
}

impl Attendance {
    /// Makes that of a number of steps.
    #[must_use]
    pub fn new(steps: usize) -> Self {
        let steps = (0..steps).map(|_| AttendedStep::default()).collect();
        let (held, stands) = (AtomicBool::new(false), AtomicU64::new(0));
        Self { steps, held, stands, lines: Mutex::default() }
    }

    /// Tells that a step is due before a sample, from 1; 0: before the start.
    pub fn ask(&self, step: usize, sample: u64) {
        if let Some(step) = self.steps.get(step) {
            step.due.store(sample.saturating_add(1), Ordering::Release);
        }
    }

    /// Sample before which a step is due; 0: before the start. `None`: it isn't due yet.
    #[must_use]
    pub fn due(&self, step: usize) -> Option<u64> {
        self.steps.get(step)?.due.load(Ordering::Acquire).checked_sub(1)
    }

    /// Tells that a step has its answer.
    pub fn close(&self, step: usize) {
        if let Some(step) = self.steps.get(step) {
            step.closed.store(true, Ordering::Release);
        }
    }

    /// Returns whether a step has its answer.
    #[must_use]
    pub fn is_closed(&self, step: usize) -> bool {
        self.steps.get(step).is_none_or(|step| step.closed.load(Ordering::Acquire))
    }

    /// Holds the run, or lets it go on.
    pub fn hold(&self, held: bool) {
        self.held.store(held, Ordering::Release);
    }

    /// Returns whether a person holds the run.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.held.load(Ordering::Acquire)
    }

    /// Tells the sample before which the run stands, from 1; 0: it goes on.
    pub fn stand(&self, sample: u64) {
        self.stands.store(sample, Ordering::Release);
    }

    /// Sample before which the run stands; `None`: it goes on.
    #[must_use]
    pub fn stands(&self) -> Option<u64> {
        Some(self.stands.load(Ordering::Acquire)).filter(|sample| *sample > 0)
    }

    /// Adds a record.
    pub fn tell(&self, line: String) {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner).push(line);
    }

    /// Records so far.
    #[must_use]
    pub fn told(&self) -> Vec<String> {
        self.lines.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
