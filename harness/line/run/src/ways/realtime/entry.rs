//! Messages from the real-time thread to the rest of the program about a step.

use crate::bench::records::Measured;
use octant_faults::rule::UnitEvent;
use octant_faults::station::Occurrence;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{NoiseIntegral, Output, Truth};
use octant_source::Epoch;

/// One message. Placed into a ring that has room for the largest: a box would be an allocation on
/// the real-time thread.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug)]
pub(super) enum Entry {
    /// Epoch that the source delivered, that which it would have delivered without the faults inside its plant, and
    /// the epoch that reached the core, with its answer.
    Frame { source: Epoch, undisturbed: Epoch, faulted: Epoch, answer: Answer },
    /// Epoch that reached no core, or whose answer hasn't come yet.
    Lost { source: Epoch, undisturbed: Epoch, truth: Option<Truth> },
    /// Answer to an additional epoch in a step of the source, or to one of an earlier step.
    Added { step_ns: u64, faulted: Epoch, answer: Answer },
    /// Event of the unit before the epoch of this number.
    Unit { event: UnitEvent, epoch: u64 },
    /// Onset or end of a fault.
    Occurrence(Occurrence),
    /// First violation of a real-time limit by the bench, at a time of the source.
    Broke { step_ns: u64, broke: Broke },
    /// Time keeping so far, for display: once a second.
    Pace { frames: u64, latest_ns: u64, overruns: u64, late_answers: u64 },
}

/// Violation of a real-time limit by the bench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Broke {
    /// A frame began this late, ns: more frames were late than allowed, or the delay is so long
    /// that the run is no evidence for the time between.
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

/// Output with its parameters and truth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    pub(super) output: Output,
    /// Innovation and covariance, if there was a measurement.
    pub(super) measured: Measured,
    /// Parameters, if they are new.
    pub(super) estimate: Option<ParameterEstimate>,
    pub(super) known: Known,
}

/// Knowledge of the source at an answer.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    pub(super) truth: Option<Truth>,
    /// Whether the truth is that at the answer before, as the source says.
    pub(super) stands: Option<bool>,
    /// Noise in the samples so far, as far as the source knows it.
    pub(super) noise: Option<NoiseIntegral>,
}
