//! Events of a session: messages of the other end, outcomes of sending, repetitions.

use crate::clock::Stamps;
use octant_wire::message::{
    AidingMessage, DeviceStatus, Gathered, Heartbeat, OutputMessage, SampleMessage, StepNumber,
};
use std::time::Duration;

/// Event received from the other end.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "the large variant is the one that comes")]
pub enum LinkEvent {
    /// The device answered a sample or the end.
    Output(OutputMessage),
    /// All segments of the parameters arrived.
    Parameters(Gathered),
    /// The device restarted, as requested.
    Ready(StepNumber),
    /// Status of the device: its counts of steps and losses.
    Status(DeviceStatus),
    /// Sign of life.
    Heartbeat(Heartbeat),
    /// The device answered a time request.
    Time(Stamps),
    /// An instrument's sample.
    Sample(SampleMessage),
    /// Reference for an instrument's next sample.
    Aiding(AidingMessage),
    /// Hello without a session: the device restarted, or an old frame arrived again. A harness whose
    /// requests go unanswered too can tell which.
    Anew,
    /// Message without meaning here.
    Other,
}

/// Outcome of sending a sample without waiting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sending {
    /// The sample is on its way.
    Sent(StepNumber),
    /// The port did not accept the whole message: the device will count a missing step.
    NotTaken(StepNumber),
    /// The device's window is full: the sample was not sent, and has no step.
    WindowFull,
}

/// Counts of repetitions and reconnections.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Requests that were sent again.
    pub repeated: u64,
    /// Answers received a second time.
    pub doubled: u64,
    /// Number of times that the port went away and came back.
    pub reconnected: u32,
    /// Total time that the port was away.
    pub away: Duration,
}
