//! Failures of commands, with the exit status of each.

use octant_base::failing::{Failing, FailureKind};
use octant_verdict::Verdict;

/// Exit status of bad input or usage, which has no verdict.
const INPUT: u8 = 2;

/// Reason why a command ended without a verdict.
#[derive(Debug)]
pub struct Failure {
    pub(crate) status: u8,
    pub(crate) message: String,
}

impl Failure {
    /// Exit status: 1 what is tested failed, 2 bad input or usage, 3 inconclusive, 4 error of the bench.
    #[must_use]
    pub fn status(&self) -> u8 {
        self.status
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}

impl Failure {
    /// Creates the failure of an error, which says of what kind it is.
    pub(crate) fn of(error: &(impl Failing + std::fmt::Display)) -> Self {
        Self::of_kind(error.kind(), error)
    }

    /// Creates a failure of a kind.
    pub(crate) fn of_kind(kind: FailureKind, message: impl std::fmt::Display) -> Self {
        let status = match kind {
            FailureKind::Input => INPUT,
            FailureKind::Bench => Verdict::Error.exit_code(),
            FailureKind::Inconclusive => Verdict::Inconclusive.exit_code(),
            FailureKind::Fail => Verdict::Fail.exit_code(),
        };
        Self { status, message: message.to_string() }
    }

    /// Creates a failure by bad input or usage.
    pub(crate) fn input(error: impl std::fmt::Display) -> Self {
        Self::of_kind(FailureKind::Input, error)
    }

    /// Creates a failure of the bench.
    pub fn bench(error: impl std::fmt::Display) -> Self {
        Self::of_kind(FailureKind::Bench, error)
    }

    /// Puts "failed to" before the message.
    pub(crate) fn failed(self) -> Self {
        Self { message: format!("failed to {}", self.message), ..self }
    }
}

impl From<octant_run::MethodError> for Failure {
    fn from(error: octant_run::MethodError) -> Self {
        Self::of(&error)
    }
}

impl From<octant_run::paired::PairedError> for Failure {
    fn from(error: octant_run::paired::PairedError) -> Self {
        Self::of(&error).failed()
    }
}
