//! Steps an FMU of a scenario in time: open, started, one exchange at a time.

use super::bind::{BindError, Bound};
use super::settings::Starts;
use octant_base::failing::{Failing, FailureKind};
use octant_fmu_host::FmuOpenError;
use octant_fmu_host::instance::{Instance, InstanceError, StepOutcome};
use octant_scenario::{FileProblems, Problem};

/// Reasons why an FMU of a scenario can't be used, or stopped working.
#[derive(Debug, thiserror::Error)]
pub enum UseError {
    /// The scenario's settings don't fit the FMU.
    #[error(transparent)]
    Mapping(#[from] FileProblems),
    /// The FMU can't be opened or started.
    #[error("open {uri}: {reason}")]
    Open {
        /// URI: `fmu:FILE`.
        uri: String,
        /// Reason.
        reason: String,
    },
    /// The process of the FMU crashed or hung before the start.
    #[error("open {uri}: {reason}")]
    Gone {
        /// URI: `fmu:FILE`.
        uri: String,
        /// Description of the failure.
        reason: String,
    },
}

impl Failing for UseError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Mapping(_) | Self::Open { .. } => FailureKind::Input,
            Self::Gone { .. } => FailureKind::Bench,
        }
    }
}

impl UseError {
    /// Wraps problems with a scenario's settings.
    pub fn problems(file: &str, problems: Vec<Problem>) -> Self {
        Self::Mapping(FileProblems { file: file.to_owned(), problems })
    }

    /// Wraps the reason why an FMU can't be opened.
    pub(crate) fn open(uri: &str, error: FmuOpenError) -> Self {
        match error {
            FmuOpenError::Instance(error) => Self::instance(uri, &error),
            other => Self::Open { uri: uri.to_owned(), reason: other.to_string() },
        }
    }

    /// Wraps an instance's error from before the start.
    pub(crate) fn instance(uri: &str, error: &InstanceError) -> Self {
        let (uri, reason) = (uri.to_owned(), error.to_string());
        match error {
            InstanceError::Process { .. } => Self::Gone { uri, reason },
            _ => Self::Open { uri, reason },
        }
    }

    /// Wraps the reason why channels can't be bound.
    pub fn binding(file: &str, uri: &str, error: BindError) -> Self {
        match error {
            BindError::Mapping(problems) => Self::problems(file, problems),
            BindError::Instance(error) => Self::instance(uri, &error),
        }
    }
}

/// Reason why a started FMU can't go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The FMU failed while it was stepped or read.
    #[error("at {time_s} s {error}")]
    Failed {
        /// Time that was reached, s.
        time_s: f64,
        /// Error of the FMU.
        error: InstanceError,
    },
    /// The FMU refused a step.
    #[error("at {time_s} s it refused a step of {step_s} s{said}")]
    Refused {
        /// Time that was reached, s.
        time_s: f64,
        /// Step, s.
        step_s: f64,
        /// Message that the FMU logged, after a colon; else empty.
        said: String,
    },
    /// The FMU failed at its end or restart.
    #[error(transparent)]
    Instance(#[from] InstanceError),
}

/// Instance with its clock.
pub struct Stepper {
    instance: Box<dyn Instance>,
    uri: String,
    starts: Starts,
    tolerance: Option<f64>,
    step_ns: u64,
    time_ns: u64,
}

impl Stepper {
    /// Sets the start values and initializes.
    ///
    /// # Errors
    /// If the FMU fails.
    pub fn start(
        mut instance: Box<dyn Instance>,
        uri: &str,
        starts: Starts,
        tolerance: Option<f64>,
        step_ns: u64,
    ) -> Result<Self, UseError> {
        initialize(instance.as_mut(), &starts, tolerance)
            .map_err(|error| UseError::instance(uri, &error))?;
        Ok(Self { instance, uri: uri.to_owned(), starts, tolerance, step_ns, time_ns: 0 })
    }

    /// URI: `fmu:FILE`.
    #[must_use]
    pub fn uri(&self) -> &str {
        &self.uri
    }

    /// The instance.
    pub fn instance(&mut self) -> &mut dyn Instance {
        self.instance.as_mut()
    }

    /// Time that was reached, ns.
    #[must_use]
    pub fn time_ns(&self) -> u64 {
        self.time_ns
    }

    /// Sets inputs, makes a step and reads outputs; false if the FMU requests the end.
    ///
    /// # Errors
    /// If it fails or refuses the step.
    pub fn exchange(&mut self, inputs: &Bound, outputs: &mut Bound) -> Result<bool, StepError> {
        let (time_s, step_s) = (self.time_ns as f64 * 1e-9, self.step_ns as f64 * 1e-9);
        let stepped = self
            .instance
            .exchange(
                &inputs.plan.groups,
                &inputs.numbers,
                time_s,
                step_s,
                &outputs.plan.groups,
                &mut outputs.numbers,
            )
            .map_err(|error| StepError::Failed { time_s, error })?;
        if stepped.terminate {
            return Ok(false);
        }
        if stepped.outcome == StepOutcome::Discarded {
            let said = octant_fmu_host::instance::said(self.instance.as_mut());
            return Err(StepError::Refused { time_s, step_s, said });
        }
        self.time_ns += self.step_ns;
        Ok(true)
    }

    /// Reads outputs without a step.
    ///
    /// # Errors
    /// If it fails.
    pub fn get(&mut self, outputs: &mut Bound) -> Result<(), StepError> {
        let time_s = self.time_ns as f64 * 1e-9;
        let mut rest = outputs.numbers.as_mut_slice();
        for group in &outputs.plan.groups {
            let (these, others) = rest.split_at_mut(group.elements);
            self.instance.get(group, these).map_err(|error| StepError::Failed { time_s, error })?;
            rest = others;
        }
        Ok(())
    }

    /// Returns the values with which it was started.
    #[must_use]
    pub fn starts(&self) -> &Starts {
        &self.starts
    }

    /// Ends the simulation, and reads the outputs that the end has changed.
    ///
    /// # Errors
    /// If it fails.
    pub fn end(&mut self, outputs: &mut Bound) -> Result<(), StepError> {
        self.instance.terminate()?;
        self.get(outputs)
    }

    /// Frees the FMU and unloads its library. Nothing else may be called after it.
    ///
    /// # Errors
    /// If the FMU crashes or hangs on the way.
    pub fn finish(&mut self) -> Result<(), StepError> {
        Ok(self.instance.finish()?)
    }

    /// Restarts with other start values.
    ///
    /// # Errors
    /// If it fails.
    pub fn restart(&mut self, starts: Starts) -> Result<(), StepError> {
        self.starts = starts;
        self.time_ns = 0;
        let instance = self.instance.as_mut();
        instance.reset()?;
        Ok(initialize(instance, &self.starts, self.tolerance)?)
    }
}

fn initialize(
    instance: &mut dyn Instance,
    starts: &Starts,
    tolerance: Option<f64>,
) -> Result<(), InstanceError> {
    starts.apply(instance)?;
    let tolerance = tolerance.or(instance.description().default_experiment.tolerance);
    instance.enter_initialization(0.0, None, tolerance)?;
    if instance.exit_initialization()? {
        return Err(InstanceError::Unsupported {
            fmu: instance.name().to_owned(),
            what: "run".to_owned(),
            reason: "it wants the simulation to end as soon as it is initialized".to_owned(),
        });
    }
    Ok(())
}
