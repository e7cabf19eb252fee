//! Reasons why a run of several FMUs can't go on.

use super::solve::SolveError;
use octant_base::failing::{Failing, FailureKind};
use octant_fmu_host::instance::InstanceError;

/// Reasons why a system can't go on. Rows recorded before are kept.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MasterError {
    /// An FMU failed.
    #[error("{node} failed at {time_s} s: {error}")]
    Instance {
        /// Name in the system.
        node: String,
        /// Time of the system, s.
        time_s: f64,
        /// Error of the FMU.
        error: InstanceError,
    },
    /// A connection can't carry a value.
    #[error("the connection {source_name} -> {target} can't carry {value} at {time_s} s: {reason}")]
    Value {
        /// The output.
        source_name: String,
        /// The input.
        target: String,
        /// The value of the output.
        value: String,
        /// Time of the system, s.
        time_s: f64,
        /// Reason.
        reason: String,
    },
    /// An FMU refused a value that no fault has altered.
    #[error("{target} refused {value} at {time_s} s{said}")]
    Refused {
        /// The input.
        target: String,
        /// The value.
        value: String,
        /// Time of the system, s.
        time_s: f64,
        /// Message that the FMU logged, after a colon; else empty.
        said: String,
    },
    /// More outputs than allowed were no numbers and went into inputs.
    #[error(
        "{source_name} isn't a number, first at {since_s} s, and goes into {target}: found {found} such values on all \
         connections, expected {max} at most (--nan-limit)"
    )]
    NoNumber {
        /// The output.
        source_name: String,
        /// The input.
        target: String,
        /// First time at which the output was no number, s.
        since_s: f64,
        /// Number of such values on all connections.
        found: u64,
        /// Number allowed.
        max: u64,
    },
    /// An FMU refused parameters that were to change.
    #[error("{node} refused {values} at {time_s} s{said}")]
    Tuned {
        /// Name in the system.
        node: String,
        /// The parameters with their values.
        values: String,
        /// Time of the system, s.
        time_s: f64,
        /// Message that the FMU logged, after a colon; else empty.
        said: String,
    },
    /// Values depend on themselves, and no solution was found.
    #[error(
        "the initial values of {} depend on each other, and {reason}: start values nearer to the \
         solution, or an FMU between them that doesn't answer at once, may help",
        .variables.join(" -> ")
    )]
    Loop {
        /// Variables of the loop, in its order.
        variables: Vec<String>,
        /// Result of the iteration.
        reason: String,
    },
    /// An FMU discarded a step, and the step can't be divided.
    #[error("{node} discarded the step from {time_s} s to {end_s} s{said}; {reason}")]
    Discarded {
        /// The FMU that refused.
        node: String,
        /// Start of the step, s.
        time_s: f64,
        /// End, s.
        end_s: f64,
        /// Message that the FMU logged, after a colon; else empty.
        said: String,
        /// Reason why no smaller step is made.
        reason: String,
    },
}

impl Failing for MasterError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Value { .. }
            | Self::Refused { .. }
            | Self::NoNumber { .. }
            | Self::Tuned { .. }
            | Self::Loop { .. }
            | Self::Discarded { .. } => FailureKind::Input,
            Self::Instance { .. } => FailureKind::Bench,
        }
    }
}

impl MasterError {
    /// Converts the result of a failed iteration.
    pub(super) fn of_loop(variables: Vec<String>, error: SolveError<Self>) -> Self {
        let reason = match error {
            SolveError::Failed(error) => return error,
            SolveError::NotSettled(residual) if residual.is_finite() => {
                format!("after all iterations they still change by {residual:.1e} of their size")
            }
            SolveError::NotSettled(_) | SolveError::NotFinite => {
                "the iteration leads to a value that is not finite".to_owned()
            }
            SolveError::Singular => "they have no single solution".to_owned(),
        };
        Self::Loop { variables, reason }
    }
}

/// Returns whether a set function discarded a value, the only error treated as a refusal.
pub(super) fn is_refusal(error: &InstanceError) -> bool {
    matches!(
        error,
        InstanceError::Failed { function, status, .. }
            if status == "discard" && (function.starts_with("fmi2Set") || function.starts_with("fmi3Set"))
    )
}
