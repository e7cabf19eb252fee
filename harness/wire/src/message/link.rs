//! What keeps a link: heartbeat, status, clocks, and the end of it.

use super::{Kind, Step};
use crate::bytes::{Reader, Writer};
use crate::{Text, Unreadable};

/// Time of an end's own monotonic clock, ns since an arbitrary start. Two of them can be compared
/// only where they are of the same end; the offset between two ends is what time messages find.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ClockTime {
    /// Nanoseconds.
    pub ns: u64,
}

impl ClockTime {
    /// A time from its nanoseconds.
    #[must_use]
    pub const fn from_ns(ns: u64) -> Self {
        Self { ns }
    }
}

/// What an end is about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Condition {
    /// No session.
    #[default]
    Waiting = 0,
    /// Both said hello; no step yet.
    Ready = 1,
    /// Steps are done.
    Stepping = 2,
    /// The stream has ended.
    Ended = 3,
    /// Something failed; the text of a bye says what.
    Failed = 4,
}

impl Condition {
    /// All of them, in the order of their codes.
    pub const ALL: [Self; 5] =
        [Self::Waiting, Self::Ready, Self::Stepping, Self::Ended, Self::Failed];

    /// The name used in texts.
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

/// The sender is there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Heartbeat {
    /// Last step sent (harness), answered (device) or made (instrument).
    pub step: Step,
    /// What the sender is about.
    pub condition: Condition,
    /// Samples that wait for their step.
    pub queued: u8,
    /// The sender's clock.
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
        let step = Step::new(r.u16());
        let [condition, queued] = r.take();
        let condition = *Condition::ALL.get(usize::from(condition)).ok_or(Unreadable::Value {
            kind: Kind::Heartbeat,
            field: "condition",
            found: condition.into(),
            expected: "0 to 4",
        })?;
        Ok(Self { step, condition, queued, clock: ClockTime { ns: r.u64() } })
    }
}

/// What a device has done and what it lost, counted since the hello of its session; a count stays
/// at its largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status {
    /// Last step answered.
    pub step: Step,
    /// Steps done.
    pub steps: u32,
    /// Requests that came again and were answered again, without a step.
    pub repeated: u32,
    /// Steps that never came: gaps in their numbers.
    pub skipped: u32,
    /// Samples whose announced aiding wasn't there.
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
    /// Undamaged frames (CAN: messages) that could not be understood.
    pub unreadable: u32,
}

impl Status {
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
        let step = Step::new(r.u16());
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

/// The harness asks for the time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TimeRequest {
    /// Tells requests apart.
    pub id: u16,
    /// The harness's clock when it sent this.
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

/// The answer: with the time of its arrival, an offset and the bounds of its error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TimeReply {
    /// Of the request.
    pub id: u16,
    /// Of the request.
    pub harness_sent: ClockTime,
    /// The replier's clock when the request arrived.
    pub received: ClockTime,
    /// The replier's clock when it sent this.
    pub sent: ClockTime,
}

/// What two clocks show at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Offset {
    /// How far the other clock is ahead of the harness's, ns.
    pub ahead_ns: i128,
    /// By how much this may be wrong, ns: half of the time that was spent on the way. Negative where
    /// the stamps contradict each other.
    pub error_ns: i128,
}

impl TimeReply {
    /// The offset of the replier's clock, when the reply came at this time of the harness's clock.
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

/// Why an end goes. A code that has no name here is passed on as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Reason(pub u8);

impl Reason {
    /// All was done.
    pub const DONE: Self = Self(0);
    /// The peer speaks a newer version.
    pub const VERSION: Self = Self(1);
    /// The peer has the wrong role.
    pub const ROLE: Self = Self(2);
    /// Another session runs.
    pub const SESSION: Self = Self(3);
    /// Pacing that one end doesn't do.
    pub const PACING: Self = Self(4);
    /// Different sample periods, or one too short.
    pub const PERIOD: Self = Self(5);
    /// Different configurations.
    pub const CONFIGURATION: Self = Self(6);
    /// The sender failed.
    pub const FAILED: Self = Self(7);
    /// Somebody stopped it.
    pub const STOPPED: Self = Self(8);
    /// The peer was silent for too long.
    pub const SILENCE: Self = Self(9);
    /// The peer asked for what the sender doesn't do.
    pub const UNSUPPORTED: Self = Self(10);

    /// The names of the codes, from 0.
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

    /// The name used in texts.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES.get(usize::from(self.0)).copied().unwrap_or("another reason")
    }
}

/// The sender goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bye {
    /// Why.
    pub reason: Reason,
    /// Why, in words.
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
            kind: Kind::Bye,
            field: "text",
            reason,
        })?;
        Ok(Self { reason: Reason(reason), text })
    }
}
