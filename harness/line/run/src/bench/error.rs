//! Reasons why a method gave no result.

use super::ended::RunError;
use octant_base::failing::{Failing, FailureKind};
use octant_calibration::state_machine::CoreConfigError;
use octant_recorder::RecorderError;
use octant_source::SourceError;
use octant_source::configure::ConfigurationError;

/// Reasons why a method could not be set up.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The plant's configuration contradicts itself.
    #[error("set up the plant: {0}")]
    Plant(#[from] octant_plant::PlantConfigError),
    /// The core's configuration contradicts itself.
    #[error("set up the core: {}", core_problem(.0))]
    Core(#[from] CoreConfigError),
    /// A source could not be opened.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// An endpoint could not be opened.
    #[error(transparent)]
    Endpoint(octant_endpoint::EndpointOpenError),
    /// A fault can't be injected.
    #[error("inject fault {id:?}: {reason}")]
    Fault {
        /// Id.
        id: String,
        /// Reason.
        reason: String,
    },
    /// The scenario has no second method.
    #[error("run the baseline: the scenario has no [baseline]")]
    NoBaseline,
    /// The scenario has steps of a person, and nobody can be asked.
    #[error(
        "do step {id:?} of [[operator]]: nobody is asked here; expected `octant run`, or a scenario without [[operator]]"
    )]
    Unattended {
        /// The first step.
        id: String,
    },
    /// The recorder could not be set up.
    #[error(transparent)]
    Recorder(#[from] RecorderError),
}

impl Failing for SetupError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Source(error) => error.kind(),
            Self::Endpoint(error) => error.kind(),
            Self::Plant(_)
            | Self::Core(_)
            | Self::Fault { .. }
            | Self::NoBaseline
            | Self::Unattended { .. } => FailureKind::Input,
            Self::Recorder(_) => FailureKind::Bench,
        }
    }
}

impl From<ConfigurationError> for SetupError {
    fn from(error: ConfigurationError) -> Self {
        match error {
            ConfigurationError::Plant(error) => Self::Plant(error),
            ConfigurationError::Source(error) => Self::Source(error),
            ConfigurationError::NoBaseline => Self::NoBaseline,
        }
    }
}

impl From<octant_endpoint::EndpointOpenError> for SetupError {
    fn from(error: octant_endpoint::EndpointOpenError) -> Self {
        match error {
            octant_endpoint::EndpointOpenError::Core(error) => Self::Core(error),
            other => Self::Endpoint(other),
        }
    }
}

/// Describes why a core can't be set up, in terms of the scenario.
fn core_problem(error: &CoreConfigError) -> String {
    use octant_base::number::plain;
    match error {
        CoreConfigError::Alignment { alignment_s, dwell_s } if alignment_s <= dwell_s => {
            "coarse alignment needs the first stop at azimuth 0 and roll 0, where the gimbals start"
                .to_owned()
        }
        CoreConfigError::Alignment { alignment_s, dwell_s } => format!(
            "procedure.alignment.duration is {} s, and the first stop is held for {} s only",
            plain(*alignment_s, 5),
            plain(*dwell_s, 5)
        ),
        _ => error.to_string(),
    }
}

/// Reasons why a method gave no result.
#[derive(Debug, thiserror::Error)]
pub enum MethodError {
    /// The method could not be set up: the input isn't valid.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The run was aborted: the bench failed.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl Failing for MethodError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Setup(error) => error.kind(),
            Self::Run(error) => error.kind(),
        }
    }
}
