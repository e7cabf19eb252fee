//! What the real-time thread tells the rest of the program about a step.

use crate::source::Epoch;
use octant_faults::rule::UnitEvent;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Output, Truth};

/// One thing that happened. Laid into a ring that has room for all of them: a box would be an
/// allocation on the real-time thread.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug)]
pub(super) enum Entry {
    /// An epoch that the source delivered, with what reached the core and its answer.
    Frame { clean: Epoch, faulted: Epoch, answer: Answer },
    /// An epoch that reached no core, or whose answer isn't there yet.
    Lost { clean: Epoch, truth: Option<Truth> },
    /// An answer to one more epoch in a step of the source, or to one of a step before.
    Added { step_ns: u64, faulted: Epoch, answer: Answer },
    /// What happened to the unit before the epoch of this number.
    Unit { event: UnitEvent, epoch: u64 },
    /// A fault, by its place in the list, set in or ended.
    Occurrence { fault: usize, begins: bool, epoch: u64 },
    /// The bench broke its promise at a time of the source, for the first time.
    Broke { step_ns: u64, broke: Broke },
    /// How time is kept, for who watches: once a second.
    Pace { frames: u64, latest_ns: u64, overruns: u64, late_answers: u64 },
}

/// How the bench broke its promise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Broke {
    /// A frame began so late, ns, that more did than may, or that nothing can be said of the time between.
    Late(u64),
    /// A sample could not be sent.
    NotSent,
    /// A step found no room on its way to the recorder.
    Dropped,
}

impl std::fmt::Display for Broke {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Late(late_ns) => write!(f, "a sample left {} us late", late_ns / 1000),
            Self::NotSent => write!(f, "a sample could not be sent"),
            Self::Dropped => write!(f, "a step found no room on its way to the recorder"),
        }
    }
}

/// An output with what belongs to it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    pub(super) output: Output,
    /// Parameters where they are new.
    pub(super) estimate: Option<ParameterEstimate>,
    pub(super) truth: Option<Truth>,
}
