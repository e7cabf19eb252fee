//! Modes of an instance, and the calls allowed in each.
//!
//! FMI 2.0.5, section 4.2.4, and FMI 3.0.2, sections 2.3 and 4.2. The standards have few states,
//! nearly the same in both.

use octant_fmi::fmi2::Status;

/// A standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ServedStandard {
    /// FMI 2.0.
    Fmi2,
    /// FMI 3.0.
    Fmi3,
}

/// A state of the standards' state machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Mode {
    /// After instantiation and reset.
    Instantiated = 0,
    /// Initialization Mode.
    Initialization = 1,
    /// FMI 2.0: step complete; FMI 3.0: Step Mode.
    Step = 2,
    /// FMI 3.0: Event Mode.
    Event = 3,
    /// FMI 3.0: Intermediate Update Mode, while its callback runs.
    IntermediateUpdate = 4,
    /// FMI 2.0: step failed, after a step that was discarded.
    StepFailed = 5,
    /// The simulation has ended.
    Terminated = 6,
    /// After an error: FMI 2.0: error; FMI 3.0: Terminated, too.
    Error = 7,
    /// After a panic: the instance can only be freed.
    Fatal = 8,
}

impl Mode {
    pub(super) const ALL: [Self; 9] = [
        Self::Instantiated,
        Self::Initialization,
        Self::Step,
        Self::Event,
        Self::IntermediateUpdate,
        Self::StepFailed,
        Self::Terminated,
        Self::Error,
        Self::Fatal,
    ];

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Instantiated => "the instance has not been initialized",
            Self::Initialization => "the instance is in initialization mode",
            Self::Step => "the instance is between steps",
            Self::Event => "the instance is in event mode",
            Self::IntermediateUpdate => "the instance is within a step",
            Self::StepFailed => "the last step was discarded",
            Self::Terminated => "the simulation has ended",
            Self::Error => "an earlier call failed",
            Self::Fatal => "the instance is dead",
        }
    }
}

/// A set of modes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Modes(u16);

impl Modes {
    pub(super) const fn of(modes: &[Mode]) -> Self {
        let (mut bits, mut i) = (0, 0);
        while i < modes.len() {
            bits |= 1 << modes[i] as u16;
            i += 1;
        }
        Self(bits)
    }

    #[inline]
    pub(super) const fn has(self, mode: Mode) -> bool {
        self.0 & 1 << mode as u16 != 0
    }
}

use Mode::*;

pub(super) const INSTANTIATED: Modes = Modes::of(&[Instantiated]);
pub(super) const INITIALIZATION: Modes = Modes::of(&[Initialization]);
pub(super) const STEP: Modes = Modes::of(&[Step]);
pub(super) const EVENT: Modes = Modes::of(&[Event]);
pub(super) const NEVER: Modes = Modes::of(&[]);

/// All modes except after a panic and within a step.
pub(super) const ALIVE: Modes =
    Modes::of(&[Instantiated, Initialization, Step, Event, StepFailed, Terminated, Error]);

/// The same modes, and within a step.
pub(super) const LOGGING: Modes = Modes::of(&[
    Instantiated,
    Initialization,
    Step,
    Event,
    IntermediateUpdate,
    StepFailed,
    Terminated,
    Error,
]);

/// Modes for reading: FMI 3.0 allows reading start values before initialization, FMI 2.0 doesn't.
pub(super) const fn get(standard: ServedStandard) -> Modes {
    match standard {
        ServedStandard::Fmi2 => Modes::of(&[Initialization, Step, StepFailed, Terminated, Error]),
        ServedStandard::Fmi3 => ALIVE,
    }
}

/// Modes for setting; the variable decides which are allowed.
pub(super) const SET: Modes = Modes::of(&[Instantiated, Initialization, Step, Event]);

/// Modes for the end of a simulation: FMI 3.0 has no failed step.
pub(super) const TERMINATE: Modes = Modes::of(&[Step, Event, StepFailed]);

/// Modes in which FMI 2.0 allows asking for the status of a step.
pub(super) const STATUS: Modes = Modes::of(&[Step, StepFailed, Terminated]);

pub(super) const NO_MODEL_EXCHANGE: &str = "there is no model exchange, only co-simulation";
pub(super) const NO_DERIVATIVES: &str = "the model is sampled: its variables have no derivatives";

/// Reason why a call is not answered with OK.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    /// Discard: the call had no effect, and the instance continues. Error: it ends.
    pub status: Status,
    /// Reason.
    pub reason: String,
    /// True if it is said also where debug logging is off: without it a user has no way on.
    pub always_said: bool,
}

impl Refusal {
    #[cold]
    pub(super) fn error(reason: impl Into<String>) -> Self {
        Self { status: octant_fmi::fmi2::ERROR, reason: reason.into(), always_said: false }
    }

    #[cold]
    pub(super) fn discard(reason: impl Into<String>) -> Self {
        Self { status: octant_fmi::fmi2::DISCARD, reason: reason.into(), always_said: false }
    }
}
