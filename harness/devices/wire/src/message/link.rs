//! Messages about the link: heartbeat, status, clocks, and its end.

use super::kind::MessageKind;
use super::step::StepNumber;
use crate::bytes::{Reader, Writer};
use crate::{Text, Unreadable};

/// Time of an end's own monotonic clock, ns since an arbitrary start. Times of different ends can't be
/// compared; time messages find the offset between two ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ClockTime {
    /// Nanoseconds.
    pub ns: u64,
}

impl ClockTime {
    /// Makes a time from nanoseconds.
    #[must_use]
    pub const fn from_ns(ns: u64) -> Self {
        Self { ns }
    }
}

/// Condition of an end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum EndCondition {
    /// No session.
    #[default]
    Waiting = 0,
    /// Both said hello; no step yet.
    Ready = 1,
    /// Steps are being done.
    Stepping = 2,
    /// The stream has ended.
    Ended = 3,
    /// A failure; the text of a bye names it.
    Failed = 4,
}

impl EndCondition {
    /// All conditions, in the order of their codes.
    pub const ALL: [Self; 5] =
        [Self::Waiting, Self::Ready, Self::Stepping, Self::Ended, Self::Failed];

    /// Name used in texts.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Waiting => "waiting",
            Self::Ready => "ready",
            Self::Stepping => "stepping",
            Self::Ended => "ended",
            Self::Failed => "failed",
        }
    }
}

/// Sign of life.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Heartbeat {
    /// Last step sent (harness), answered (device) or made (instrument).
    pub step: StepNumber,
    /// Condition of the sender.
    pub condition: EndCondition,
    /// Number of samples that wait for their step.
    pub queued: u8,
    /// Time of the sender's clock.
    pub clock: ClockTime,
}

impl Heartbeat {
    pub(super) fn write(&self, w: &mut Writer<'_>) {
        w.u16(self.step.number());
        w.u8(self.condition as u8);
        w.u8(self.queued);
        w.u64(self.clock.ns);
    }

    pub(super) fn read(r: &mut Reader<'_>) -> Result<Self, Unreadable> {
        let step = StepNumber::new(r.u16());
        let [condition, queued] = r.take();
        let condition =
            *EndCondition::ALL.get(usize::from(condition)).ok_or(Unreadable::Value {
                kind: MessageKind::Heartbeat,
                field: "condition",
                found: condition.into(),
                expected: "0 to 4",
            })?;
        Ok(Self { step, condition, queued, clock: ClockTime { ns: r.u64() } })
    }
}

/// Work and losses of a device, counted since the hello of its session. A count stays at its largest
/// value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeviceStatus {
    /// Last step answered.
    pub step: StepNumber,
    /// Steps done.
    pub steps: u32,
    /// Repeated requests that were answered again, without a step.
    pub repeated: u32,
    /// Steps that are missing: gaps in their numbers.
    pub skipped: u32,
    /// Samples whose announced aiding was missing.
    pub aiding_missing: u32,
    /// Samples dropped because the queue was full.
    pub queue_full: u32,
    /// Steps that took longer than a sample period.
    pub late: u32,
    /// Messages received.
    pub received: u32,
    /// Bytes (CAN: frames) received that belong to no message.
    pub lost: u32,
    /// Frames (CAN: messages) that arrived damaged.
    pub damaged: u32,
    /// Frames (CAN: segments) that never arrived.
    pub missing: u32,
    /// Frames (CAN: segments) that arrived again, or after later ones.
    pub out_of_order: u32,
    /// Undamaged frames (CAN: messages) that could not be decoded.
    pub unreadable: u32,
}

impl DeviceStatus {
    pub(super) fn write(&self, w: &mut Writer<'_>) {
        w.u16(self.step.number());
        w.u16(0);
        for count in [
            self.steps,
            self.repeated,
            self.skipped,
            self.aiding_missing,
            self.queue_full,
            self.late,
            self.received,
            self.lost,
            self.damaged,
            self.missing,
            self.out_of_order,
            self.unreadable,
        ] {
            w.u32(count);
        }
    }

    pub(super) fn read(r: &mut Reader<'_>) -> Self {
        let step = StepNumber::new(r.u16());
        r.u16();
        Self {
            step,
            steps: r.u32(),
            repeated: r.u32(),
            skipped: r.u32(),
            aiding_missing: r.u32(),
            queue_full: r.u32(),
            late: r.u32(),
            received: r.u32(),
            lost: r.u32(),
            damaged: r.u32(),
            missing: r.u32(),
            out_of_order: r.u32(),
            unreadable: r.u32(),
        }
    }
}

/// Request of the harness for the time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TimeRequest {
    /// Identifier that tells requests apart.
    pub id: u16,
    /// Harness's clock when it sent the request.
    pub harness_sent: ClockTime,
}

impl TimeRequest {
    pub(super) fn write(&self, w: &mut Writer<'_>) {
        w.u16(self.id);
        w.u16(0);
        w.u64(self.harness_sent.ns);
    }

    pub(super) fn read(r: &mut Reader<'_>) -> Self {
        let id = r.u16();
        r.u16();
        Self { id, harness_sent: ClockTime { ns: r.u64() } }
    }
}

/// Answer to a time request. With its time of arrival it gives an offset and the bound of its error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TimeReply {
    /// Identifier of the request.
    pub id: u16,
    /// Harness's clock when it sent the request.
    pub harness_sent: ClockTime,
    /// The replier's clock when the request arrived.
    pub received: ClockTime,
    /// The replier's clock when it sent the reply.
    pub sent: ClockTime,
}

/// Offset between two clocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offset {
    /// Offset by which the other clock is ahead of the harness's, ns.
    pub ahead_ns: i128,
    /// Bound of the error, ns: half of the round-trip delay. Negative if the timestamps contradict each
    /// other.
    pub error_ns: i128,
}

impl TimeReply {
    /// Offset of the replier's clock, for a reply that arrived at this time of the harness's clock.
    #[must_use]
    pub fn offset(&self, harness_received: ClockTime) -> Offset {
        let between =
            |later: ClockTime, earlier: ClockTime| i128::from(later.ns) - i128::from(earlier.ns);
        let there = between(self.received, self.harness_sent);
        let back = between(harness_received, self.sent);
        Offset { ahead_ns: (there - back) / 2, error_ns: (there + back) / 2 }
    }

    pub(super) fn write(&self, w: &mut Writer<'_>) {
        w.u16(self.id);
        w.u16(0);
        w.u64(self.harness_sent.ns);
        w.u64(self.received.ns);
        w.u64(self.sent.ns);
    }

    pub(super) fn read(r: &mut Reader<'_>) -> Self {
        let id = r.u16();
        r.u16();
        let [harness_sent, received, sent] = r.array(|r| ClockTime { ns: r.u64() });
        Self { id, harness_sent, received, sent }
    }
}

/// Reason of a bye. An unknown code is passed on unchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Reason(pub u8);

impl Reason {
    /// The work is done.
    pub const DONE: Self = Self(0);
    /// The peer speaks a newer version.
    pub const VERSION: Self = Self(1);
    /// The peer has the wrong role.
    pub const ROLE: Self = Self(2);
    /// Another session is running.
    pub const SESSION: Self = Self(3);
    /// One end doesn't support the pacing.
    pub const PACING: Self = Self(4);
    /// The sample periods differ, or one is too short.
    pub const PERIOD: Self = Self(5);
    /// The configurations differ.
    pub const CONFIGURATION: Self = Self(6);
    /// The sender failed.
    pub const FAILED: Self = Self(7);
    /// The sender was stopped.
    pub const STOPPED: Self = Self(8);
    /// The peer was silent for too long.
    pub const SILENCE: Self = Self(9);
    /// The peer requested something that the sender doesn't support.
    pub const UNSUPPORTED: Self = Self(10);

    /// Names of the codes, from 0.
    pub const NAMES: [&str; 11] = [
        "done",
        "version",
        "role",
        "session",
        "pacing",
        "period",
        "configuration",
        "failed",
        "stopped",
        "silence",
        "unsupported",
    ];

    /// Name used in texts.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES.get(usize::from(self.0)).copied().unwrap_or("another reason")
    }
}

/// Notice that the sender leaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bye {
    /// Reason.
    pub reason: Reason,
    /// Reason in words.
    pub text: Text<40>,
}

impl Bye {
    pub(super) fn write(&self, w: &mut Writer<'_>) {
        w.u8(self.reason.0);
        w.put(&[0; 3]);
        w.put(self.text.bytes());
    }

    pub(super) fn read(r: &mut Reader<'_>) -> Result<Self, Unreadable> {
        let [reason, _, _, _] = r.take();
        let text = Text::from_bytes(r.take()).map_err(|reason| Unreadable::Text {
            kind: MessageKind::Bye,
            field: "text",
            reason,
        })?;
        Ok(Self { reason: Reason(reason), text })
    }
}
