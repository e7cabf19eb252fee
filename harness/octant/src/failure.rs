//! Failures of commands, with the exit status of each.

use octant_requirements::Verdict;

/// Reason why a command ended without a verdict.
#[derive(Debug)]
pub struct Failure {
    pub(crate) status: u8,
    pub(crate) message: String,
}

impl Failure {
    /// Exit status: 2 bad input or usage, 3 inconclusive, 4 error of the bench.
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
    /// Creates a failure by bad input or usage.
    pub(crate) fn input(error: impl std::fmt::Display) -> Self {
        Self { status: 2, message: error.to_string() }
    }

    /// Creates a failure of the bench.
    pub fn bench(error: impl std::fmt::Display) -> Self {
        Self { status: Verdict::Error.exit_code(), message: error.to_string() }
    }
}

impl Failure {
    /// Puts "failed to" before the message.
    pub(crate) fn failed(self) -> Self {
        Self { message: format!("failed to {}", self.message), ..self }
    }
}

impl From<octant_run::method::MethodError> for Failure {
    fn from(error: octant_run::method::MethodError) -> Self {
        use octant_endpoint::EndpointOpenError;
        use octant_link::harness::SessionError;
        use octant_mapping::stepper::UseError;
        use octant_run::RunError;
        use octant_run::method::{MethodError, SetupError};
        use octant_source::SourceError;
        match &error {
            MethodError::Setup(
                SetupError::Recorder(_)
                | SetupError::Source(
                    SourceError::Use(UseError::Gone { .. })
                    | SourceError::Gone { .. }
                    | SourceError::TableStopped { .. },
                )
                | SetupError::Endpoint(
                    EndpointOpenError::Use(UseError::Gone { .. })
                    | EndpointOpenError::Power(_)
                    | EndpointOpenError::Live(
                        SessionError::Port(_)
                        | SessionError::NoAnswer { .. }
                        | SessionError::Bye { .. }
                        | SessionError::StartedAnew { .. },
                    ),
                ),
            ) => Self::bench(error),
            MethodError::Setup(SetupError::Source(SourceError::Table(table)))
                if !matches!(table, octant_turntable::Error::Dialect { .. }) =>
            {
                Self::bench(error)
            }
            // A file that can't be read to its end is bad input, not a failure of the bench.
            MethodError::Setup(_)
            | MethodError::Run(RunError::Source(SourceError::Read { .. })) => Self::input(error),
            MethodError::Run(_) => Self::bench(error),
        }
    }
}

impl From<octant_run::paired::PairedError> for Failure {
    fn from(error: octant_run::paired::PairedError) -> Self {
        use octant_run::paired::PairedError;
        let message = format!("failed to {error}");
        match error {
            PairedError::Method(error) => Self::from(error).failed(),
            PairedError::NoNavigation | PairedError::NotSimulated => Self::input(message),
            PairedError::Cancelled => Self { status: Verdict::Inconclusive.exit_code(), message },
        }
    }
}
