//! Errors of a running FMU.

use octant_base::failing::FailureKind;
use serde::{Deserialize, Serialize};

/// Reason why an FMU could not continue. The error crosses processes, so that it holds text and no
/// sources.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
pub enum InstanceError {
    /// The FMU can't be loaded.
    #[error("load {fmu}: {reason}")]
    Load {
        /// Name of the FMU.
        fmu: String,
        /// State found and state expected.
        reason: String,
    },
    /// A function reported a failure.
    #[error("{function} of {fmu} answered {status}{said}")]
    Failed {
        /// Name of the FMU.
        fmu: String,
        /// Name of the function.
        function: String,
        /// `error`, `fatal`, `discard`.
        status: String,
        /// Messages of the FMU, after a colon; empty if there are none.
        said: String,
    },
    /// The FMU doesn't support the request.
    #[error("{fmu} can't {what}: {reason}")]
    Unsupported {
        /// Name of the FMU.
        fmu: String,
        /// Request.
        what: String,
        /// Reason.
        reason: String,
    },
    /// The standard forbids the request at this time.
    #[error("{fmu}: {what} isn't possible {when}")]
    Order {
        /// Name of the FMU.
        fmu: String,
        /// Request.
        what: String,
        /// `before the initialization`, `after it failed`.
        when: String,
    },
    /// A value doesn't fit the variable's type.
    #[error("{fmu}: {value} of {variable} can't be carried between {kind} and f64")]
    Value {
        /// Name of the FMU.
        fmu: String,
        /// Name of the variable.
        variable: String,
        /// Value.
        value: String,
        /// Type of the variable.
        kind: String,
    },
    /// A repetition doesn't end.
    #[error("{fmu}: {what}, and no end of them")]
    Endless {
        /// Name of the FMU.
        fmu: String,
        /// Repeated action, with its number.
        what: String,
    },
    /// A state that doesn't belong to this FMU.
    #[error("{fmu}: the state {reason}")]
    State {
        /// Name of the FMU.
        fmu: String,
        /// Problem of the state.
        reason: String,
    },
    /// The equations can't be integrated.
    #[error("{fmu} can't be integrated beyond {time_s} s: {reason}")]
    Integration {
        /// Name of the FMU.
        fmu: String,
        /// Time reached, s.
        time_s: f64,
        /// Reason.
        reason: String,
    },
    /// The process of the FMU has ended or hangs.
    #[error("the process of {fmu} {what}")]
    Process {
        /// Name of the FMU.
        fmu: String,
        /// `was ended by SIGSEGV in fmi2DoStep`, `gave no answer to … for 10 s`.
        what: String,
    },
}

impl InstanceError {
    /// Kind of a failure of an FMU that is opened: it may not fit what it is opened for.
    #[must_use]
    pub fn kind_of_opening(&self) -> FailureKind {
        match self {
            Self::Load { .. }
            | Self::Failed { .. }
            | Self::Unsupported { .. }
            | Self::Order { .. }
            | Self::Value { .. }
            | Self::Endless { .. }
            | Self::State { .. }
            | Self::Integration { .. } => FailureKind::Input,
            Self::Process { .. } => FailureKind::Bench,
        }
    }
}

impl InstanceError {
    /// Kind of a failure of an FMU that runs: a value may be one that its variable can't have.
    #[must_use]
    pub fn kind_of_running(&self) -> FailureKind {
        match self {
            Self::Value { .. } => FailureKind::Input,
            Self::Load { .. }
            | Self::Failed { .. }
            | Self::Unsupported { .. }
            | Self::Order { .. }
            | Self::Endless { .. }
            | Self::State { .. }
            | Self::Integration { .. }
            | Self::Process { .. } => FailureKind::Bench,
        }
    }
}

impl InstanceError {
    /// Makes [`InstanceError::Load`].
    pub(crate) fn load(fmu: &str, reason: impl Into<String>) -> Self {
        Self::Load { fmu: fmu.into(), reason: reason.into() }
    }

    /// Makes [`InstanceError::Unsupported`].
    pub(crate) fn unsupported(
        fmu: &str,
        what: impl Into<String>,
        reason: impl Into<String>,
    ) -> Self {
        Self::Unsupported { fmu: fmu.into(), what: what.into(), reason: reason.into() }
    }
}
