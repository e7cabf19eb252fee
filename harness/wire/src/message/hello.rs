//! Who is there, and whether two fit together.

use super::{Bye, Kind, Reason, Role};
use crate::bytes::{Reader, Writer};
use crate::{Text, Unreadable, VERSION};
use core::fmt;

/// How the steps are paced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Pacing {
    /// The harness waits for each answer, and repeats what is not answered: nothing is ever lost.
    #[default]
    LockStep = 0,
    /// Samples come when they are due, each end by its own clock.
    RealTime = 1,
}

impl Pacing {
    /// The name used in texts.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::LockStep => "lock-step",
            Self::RealTime => "real-time",
        }
    }
}

bitflags::bitflags! {
    /// What an end can do.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub struct Capabilities: u32 {
        /// Answers in lock-step.
        const LOCK_STEP = 1 << 0;
        /// Keeps up in real time.
        const REAL_TIME = 1 << 1;
        /// Starts its core anew when asked to.
        const RESTART = 1 << 2;
        /// Sends parameters with their σ.
        const PARAMETERS = 1 << 3;
        /// Concludes at the end of the stream and answers.
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

/// What an end asks of the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Limits {
    /// Samples that it takes before it has answered the first of them.
    pub window: u16,
    /// Silence after which it takes the other for gone, ms; 0: never.
    pub silence_ms: u16,
    /// Shortest sample period that it keeps up with in real time, ns.
    pub shortest_period_ns: u32,
}

/// The first message of each end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hello {
    /// Version of the protocol that the sender speaks.
    pub version: u16,
    /// Who sends.
    pub role: Role,
    /// How steps are paced: the harness chooses, the others repeat it.
    pub pacing: Pacing,
    /// Number of the session: the harness draws one that isn't 0, the others repeat it. 0 in a hello
    /// that answers none, after power on.
    pub session: u32,
    /// What the sender can do.
    pub capabilities: Capabilities,
    /// Sample period that the sender is configured with, ns.
    pub sample_period_ns: u64,
    /// What the sender asks of the other.
    pub limits: Limits,
    /// Hash of the configuration of the core; zeros: not known.
    pub configuration: [u8; 32],
    /// Name of the sender.
    pub name: Text<24>,
    /// Its firmware or program, with version.
    pub firmware: Text<24>,
}

impl Default for Hello {
    fn default() -> Self {
        Self {
            version: VERSION,
            role: Role::Harness,
            pacing: Pacing::LockStep,
            session: 0,
            capabilities: Capabilities::empty(),
            sample_period_ns: 0,
            limits: Limits::default(),
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
            Unreadable::Value { kind: Kind::Hello, field, found, expected }
        };
        let version = r.u16();
        // Newer versions were refused before.
        if version == 0 {
            return Err(wrong("version", version, "1 or more"));
        }
        let [role, pacing] = r.take();
        let role = *Role::ALL
            .get(usize::from(role))
            .ok_or_else(|| wrong("role", role.into(), "0 to 2"))?;
        let pacing = match pacing {
            0 => Pacing::LockStep,
            1 => Pacing::RealTime,
            found => return Err(wrong("pacing", found.into(), "0 (lock-step) or 1 (real-time)")),
        };
        let text = |field| move |reason| Unreadable::Text { kind: Kind::Hello, field, reason };
        Ok(Self {
            version,
            role,
            pacing,
            session: r.u32(),
            capabilities: Capabilities::from_bits_retain(r.u32()),
            sample_period_ns: r.u64(),
            limits: Limits { window: r.u16(), silence_ms: r.u16(), shortest_period_ns: r.u32() },
            configuration: r.take(),
            name: Text::from_bytes(r.take()).map_err(text("name"))?,
            firmware: Text::from_bytes(r.take()).map_err(text("firmware"))?,
        })
    }
}

/// What two ends agreed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Agreement {
    /// Number of the session.
    pub session: u32,
    /// How steps are paced.
    pub pacing: Pacing,
    /// Both know the hash of their configuration, and it is the same.
    pub configuration_compared: bool,
}

/// Why two ends don't fit together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// Neither or both are the harness.
    #[error("{} talks to {}: one of the two has to be the harness", theirs.name(), ours.name())]
    Role {
        /// Our role.
        ours: Role,
        /// The peer's.
        theirs: Role,
    },
    /// Another session.
    #[error("the answer is of session {theirs:#010x}, this is session {ours:#010x}")]
    Session {
        /// Our session.
        ours: u32,
        /// The peer's.
        theirs: u32,
    },
    /// A pacing that the device can't do, or another one than the harness chose.
    #[error("the harness asks for {} steps, which the {} doesn't do", asked.name(), by.name())]
    Pacing {
        /// What the harness chose.
        asked: Pacing,
        /// Who can't.
        by: Role,
    },
    /// Different sample periods.
    #[error(
        "the harness is configured for a sample period of {harness_ns} ns, the other end for \
         {other_ns} ns"
    )]
    Period {
        /// Of the harness.
        harness_ns: u64,
        /// Of device or instrument.
        other_ns: u64,
    },
    /// Too fast for it.
    #[error(
        "samples come every {asked_ns} ns, the other end keeps up with one every {shortest_ns} ns"
    )]
    Rate {
        /// Sample period.
        asked_ns: u64,
        /// Shortest period of device or instrument.
        shortest_ns: u32,
    },
    /// Differently configured cores.
    #[error(
        "the harness expects a core of configuration {}, the other end has {}: \
         give both the same scenario", Short(*harness), Short(*other)
    )]
    Configuration {
        /// First bytes of the harness's hash.
        harness: [u8; 8],
        /// First bytes of the other one's.
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

impl Refusal {
    /// What is said to the peer.
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

/// Whether two ends that said hello fit together.
///
/// # Errors
/// If they don't, with the first reason found.
pub fn agree(ours: &Hello, theirs: &Hello) -> Result<Agreement, Refusal> {
    let (harness, other) = match (ours.role, theirs.role) {
        (Role::Harness, Role::Device | Role::Instrument) => (ours, theirs),
        (Role::Device | Role::Instrument, Role::Harness) => (theirs, ours),
        (ours, theirs) => return Err(Refusal::Role { ours, theirs }),
    };
    if harness.session != other.session {
        return Err(Refusal::Session { ours: ours.session, theirs: theirs.session });
    }
    let needed = match harness.pacing {
        Pacing::LockStep => Capabilities::LOCK_STEP,
        Pacing::RealTime => Capabilities::REAL_TIME,
    };
    if !other.capabilities.contains(needed) || other.pacing != harness.pacing {
        return Err(Refusal::Pacing { asked: harness.pacing, by: other.role });
    }
    if harness.sample_period_ns != other.sample_period_ns {
        return Err(Refusal::Period {
            harness_ns: harness.sample_period_ns,
            other_ns: other.sample_period_ns,
        });
    }
    let shortest_ns = other.limits.shortest_period_ns;
    if harness.pacing == Pacing::RealTime && u64::from(shortest_ns) > harness.sample_period_ns {
        return Err(Refusal::Rate { asked_ns: harness.sample_period_ns, shortest_ns });
    }
    let known = [harness, other].map(|hello| hello.configuration != [0; 32]);
    if known == [true, true] && harness.configuration != other.configuration {
        let first = |hello: &Hello| core::array::from_fn(|i| hello.configuration[i]);
        return Err(Refusal::Configuration { harness: first(harness), other: first(other) });
    }
    Ok(Agreement {
        session: harness.session,
        pacing: harness.pacing,
        configuration_compared: known == [true, true],
    })
}
