//! Why an FMU could not go on.

use super::Group;
use serde::{Deserialize, Serialize};

/// Why an FMU could not go on. It crosses processes, so it holds text and no sources.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum InstanceError {
    /// There is nothing to load.
    #[error("load {fmu}: {reason}")]
    Load {
        /// Name of the FMU.
        fmu: String,
        /// What was found and what is expected.
        reason: String,
    },
    /// A function answered that it failed.
    #[error("{function} of {fmu} answered {status}{said}")]
    Failed {
        /// Name of the FMU.
        fmu: String,
        /// The function.
        function: String,
        /// `error`, `fatal`, `discard`.
        status: String,
        /// What the FMU logged, after a colon; else empty.
        said: String,
    },
    /// The FMU hasn't what is asked for.
    #[error("{fmu} can't {what}: {reason}")]
    Unsupported {
        /// Name of the FMU.
        fmu: String,
        /// What is asked for.
        what: String,
        /// Why it can't.
        reason: String,
    },
    /// It is asked for at a time at which the standard forbids it.
    #[error("{fmu}: {what} isn't possible {when}")]
    Order {
        /// Name of the FMU.
        fmu: String,
        /// What is asked for.
        what: String,
        /// `before the initialization`, `after it failed`.
        when: String,
    },
    /// A value doesn't fit the variable's type.
    #[error("{fmu}: {value} of {variable} can't be carried between {kind} and f64")]
    Value {
        /// Name of the FMU.
        fmu: String,
        /// The variable.
        variable: String,
        /// The value.
        value: String,
        /// Its type.
        kind: String,
    },
    /// Something doesn't come to an end.
    #[error("{fmu}: {what}, and no end of them")]
    Endless {
        /// Name of the FMU.
        fmu: String,
        /// What, and how often.
        what: String,
    },
    /// A state that isn't one of this FMU.
    #[error("{fmu}: the state {reason}")]
    State {
        /// Name of the FMU.
        fmu: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The equations can't be integrated.
    #[error("{fmu} can't be integrated beyond {time_s} s: {reason}")]
    Integration {
        /// Name of the FMU.
        fmu: String,
        /// How far it went.
        time_s: f64,
        /// Why.
        reason: String,
    },
    /// The process of the FMU is gone or hangs.
    #[error("the process of {fmu} {what}")]
    Process {
        /// Name of the FMU.
        fmu: String,
        /// `was ended by SIGSEGV in fmi2DoStep`, `gave no answer to … for 10 s`.
        what: String,
    },
}

impl InstanceError {
    /// There is nothing to load.
    pub(crate) fn load(fmu: &str, reason: impl Into<String>) -> Self {
        Self::Load { fmu: fmu.into(), reason: reason.into() }
    }

    /// The FMU hasn't what is asked for.
    pub(crate) fn unsupported(
        fmu: &str,
        what: impl Into<String>,
        reason: impl Into<String>,
    ) -> Self {
        Self::Unsupported { fmu: fmu.into(), what: what.into(), reason: reason.into() }
    }

    /// The values don't belong to the groups.
    pub(crate) fn numbers(fmu: &str, groups: &[Group], found: usize) -> Self {
        let expected: usize = groups.iter().map(|group| group.elements).sum();
        let kinds: Vec<String> = groups.iter().map(|group| format!("{:?}", group.kind)).collect();
        Self::unsupported(
            fmu,
            format!("exchange {found} values of {}", kinds.join(", ")),
            format!("its variables have {expected} elements"),
        )
    }
}
