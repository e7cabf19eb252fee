//! Hello messages, and the check that two ends fit together.

use super::kind::{EndRole, MessageKind};
use super::link::{Bye, Reason};
use crate::bytes::{Reader, Writer};
use crate::{Text, Unreadable, VERSION};
use core::fmt;

/// Pacing of the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum StepPacing {
    /// The harness waits for each answer, and repeats unanswered requests: no step is ever lost.
    #[default]
    LockStep = 0,
    /// Samples are sent when they are due, each end by its own clock.
    RealTime = 1,
}

impl StepPacing {
    /// Name used in texts.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LockStep => "lock-step",
            Self::RealTime => "real-time",
        }
    }
}

bitflags::bitflags! {
    /// Capabilities of an end.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct Capabilities: u32 {
        /// Answers in lock-step.
        const LOCK_STEP = 1 << 0;
        /// Keeps up in real time.
        const REAL_TIME = 1 << 1;
        /// Restarts its core on request.
        const RESTART = 1 << 2;
        /// Sends parameters with their σ.
        const PARAMETERS = 1 << 3;
        /// Concludes at the end of the stream, and answers it.
        const END = 1 << 4;
        /// Answers requests for the time.
        const TIME = 1 << 5;
        /// Sends its status.
        const STATUS = 1 << 6;
        /// Uses or sends a reference of velocity.
        const VELOCITY = 1 << 7;
        /// Uses or sends a reference of position.
        const POSITION = 1 << 8;
    }
}

/// Limits of an end, which the other has to keep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EndLimits {
    /// Number of unanswered samples that the end accepts.
    pub window: u16,
    /// Silence after which the end gives up the other, ms; 0: never.
    pub silence_ms: u16,
    /// Shortest sample period that the end can process in real time, ns.
    pub shortest_period_ns: u32,
}

/// First message of each end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hello {
    /// Protocol version of the sender.
    pub version: u16,
    /// Role of the sender.
    pub role: EndRole,
    /// Pacing of the steps: chosen by the harness, repeated by the others.
    pub pacing: StepPacing,
    /// Session number: drawn by the harness, not 0, and repeated by the others. 0 in a hello that isn't
    /// an answer, after power on.
    pub session: u32,
    /// Capabilities of the sender.
    pub capabilities: Capabilities,
    /// Sample period that the sender is configured for, ns.
    pub sample_period_ns: u64,
    /// Limits that the sender asks the other end to keep.
    pub limits: EndLimits,
    /// Hash of the core's configuration; zeros: unknown.
    pub configuration: [u8; 32],
    /// Name of the sender.
    pub name: Text<24>,
    /// Firmware or program of the sender, with version.
    pub firmware: Text<24>,
}

impl Default for Hello {
    fn default() -> Self {
        Self {
            version: VERSION,
            role: EndRole::Harness,
            pacing: StepPacing::LockStep,
            session: 0,
            capabilities: Capabilities::empty(),
            sample_period_ns: 0,
            limits: EndLimits::default(),
            configuration: [0; 32],
            name: Text::default(),
            firmware: Text::default(),
        }
    }
}

impl Hello {
    pub(super) fn write(&self, w: &mut Writer<'_>) {
        w.u16(self.version);
        w.u8(self.role as u8);
        w.u8(self.pacing as u8);
        w.u32(self.session);
        w.u32(self.capabilities.bits());
        w.u64(self.sample_period_ns);
        w.u16(self.limits.window);
        w.u16(self.limits.silence_ms);
        w.u32(self.limits.shortest_period_ns);
        w.put(&self.configuration);
        w.put(self.name.bytes());
        w.put(self.firmware.bytes());
    }

    pub(super) fn read(r: &mut Reader<'_>) -> Result<Self, Unreadable> {
        let wrong = |field, found: u16, expected| {
            let found = found.into();
            Unreadable::Value { kind: MessageKind::Hello, field, found, expected }
        };
        let version = r.u16();
        // Newer versions were already refused.
        if version == 0 {
            return Err(wrong("version", version, "1 or more"));
        }
        let [role, pacing] = r.take();
        let role = *EndRole::ALL
            .get(usize::from(role))
            .ok_or_else(|| wrong("role", role.into(), "0 to 2"))?;
        let pacing = match pacing {
            0 => StepPacing::LockStep,
            1 => StepPacing::RealTime,
            found => return Err(wrong("pacing", found.into(), "0 (lock-step) or 1 (real-time)")),
        };
        let text =
            |field| move |reason| Unreadable::Text { kind: MessageKind::Hello, field, reason };
        Ok(Self {
            version,
            role,
            pacing,
            session: r.u32(),
            capabilities: Capabilities::from_bits_retain(r.u32()),
            sample_period_ns: r.u64(),
            limits: EndLimits { window: r.u16(), silence_ms: r.u16(), shortest_period_ns: r.u32() },
            configuration: r.take(),
            name: Text::from_bytes(r.take()).map_err(text("name"))?,
            firmware: Text::from_bytes(r.take()).map_err(text("firmware"))?,
        })
    }
}

/// Result of an agreement between two ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Agreement {
    /// Session number.
    pub session: u32,
    /// Pacing of the steps.
    pub pacing: StepPacing,
    /// True if both ends know the hash of their configuration, and the two are equal.
    pub configuration_compared: bool,
}

/// Reason why two ends don't fit together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SessionRefusal {
    /// Neither or both are the harness.
    #[error("{} talks to {}: one of the two has to be the harness", theirs.name(), ours.name())]
    Role {
        /// Role of this end.
        ours: EndRole,
        /// Role of the peer.
        theirs: EndRole,
    },
    /// The answer belongs to another session.
    #[error("the answer is of session {theirs:#010x}, this is session {ours:#010x}")]
    Session {
        /// Session of this end.
        ours: u32,
        /// Session of the peer.
        theirs: u32,
    },
    /// The pacing is one that the other end doesn't support or didn't repeat.
    #[error("the harness asks for {} steps, which the {} doesn't do", asked.name(), by.name())]
    Pacing {
        /// Pacing that the harness chose.
        asked: StepPacing,
        /// Role of the end that doesn't support it.
        by: EndRole,
    },
    /// The sample periods differ.
    #[error(
        "the harness is configured for a sample period of {harness_ns} ns, the other end for \
         {other_ns} ns"
    )]
    Period {
        /// Sample period of the harness, ns.
        harness_ns: u64,
        /// Sample period of the device or instrument, ns.
        other_ns: u64,
    },
    /// The sample period is too short for the other end.
    #[error(
        "samples come every {asked_ns} ns, the other end keeps up with one every {shortest_ns} ns"
    )]
    Rate {
        /// Sample period, ns.
        asked_ns: u64,
        /// Shortest period of the device or instrument, ns.
        shortest_ns: u32,
    },
    /// The cores are configured differently.
    #[error(
        "the harness expects a core of configuration {}, the other end has {}: \
         give both the same scenario", Short(*harness), Short(*other)
    )]
    Configuration {
        /// First bytes of the harness's hash.
        harness: [u8; 8],
        /// First bytes of the other end's hash.
        other: [u8; 8],
    },
}

/// The first bytes of a hash.
struct Short([u8; 8]);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))?;
        f.write_str("…")
    }
}

impl SessionRefusal {
    /// Bye that tells the peer the reason.
    #[must_use]
    pub fn bye(&self) -> Bye {
        let (reason, text) = match self {
            Self::Role { .. } => (Reason::ROLE, "one of the two has to be the harness"),
            Self::Session { .. } => (Reason::SESSION, "another session runs"),
            Self::Pacing { .. } => (Reason::PACING, "this pacing isn't there"),
            Self::Period { .. } => (Reason::PERIOD, "the sample period is another one"),
            Self::Rate { .. } => (Reason::PERIOD, "the sample period is too short"),
            Self::Configuration { .. } => {
                (Reason::CONFIGURATION, "the configuration is another one")
            }
        };
        Bye { reason, text: Text::fitting(text) }
    }
}

/// Checks that two ends fit together, from their hellos.
///
/// # Errors
/// If they don't fit, with the first reason found.
pub fn agree(ours: &Hello, theirs: &Hello) -> Result<Agreement, SessionRefusal> {
    let (harness, other) = match (ours.role, theirs.role) {
        (EndRole::Harness, EndRole::Device | EndRole::Instrument) => (ours, theirs),
        (EndRole::Device | EndRole::Instrument, EndRole::Harness) => (theirs, ours),
        (ours, theirs) => return Err(SessionRefusal::Role { ours, theirs }),
    };
    if harness.session != other.session {
        return Err(SessionRefusal::Session { ours: ours.session, theirs: theirs.session });
    }
    let needed = match harness.pacing {
        StepPacing::LockStep => Capabilities::LOCK_STEP,
        StepPacing::RealTime => Capabilities::REAL_TIME,
    };
    if !other.capabilities.contains(needed) || other.pacing != harness.pacing {
        return Err(SessionRefusal::Pacing { asked: harness.pacing, by: other.role });
    }
    if harness.sample_period_ns != other.sample_period_ns {
        return Err(SessionRefusal::Period {
            harness_ns: harness.sample_period_ns,
            other_ns: other.sample_period_ns,
        });
    }
    let shortest_ns = other.limits.shortest_period_ns;
    if harness.pacing == StepPacing::RealTime && u64::from(shortest_ns) > harness.sample_period_ns {
        return Err(SessionRefusal::Rate { asked_ns: harness.sample_period_ns, shortest_ns });
    }
    let known = [harness, other].map(|hello| hello.configuration != [0; 32]);
    if known == [true, true] && harness.configuration != other.configuration {
        let first = |hello: &Hello| core::array::from_fn(|i| hello.configuration[i]);
        return Err(SessionRefusal::Configuration { harness: first(harness), other: first(other) });
    }
    Ok(Agreement {
        session: harness.session,
        pacing: harness.pacing,
        configuration_compared: known == [true, true],
    })
}
