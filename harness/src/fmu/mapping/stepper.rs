//! An FMU of a scenario that is stepped in time: opened, started, and one exchange at a time.

use super::bind::{BindError, Bound};
use super::settings::Starts;
use octant_fmu_host::instance::{Instance, InstanceError, Outcome};
use octant_scenario::{Problem, ScenarioError};

/// Why an FMU of a scenario can't be used, or went away.
#[derive(Debug, thiserror::Error)]
pub enum UseError {
    /// What the scenario says about it doesn't fit it.
    #[error(transparent)]
    Mapping(#[from] ScenarioError),
    /// It can't be opened or started.
    #[error("open {uri}: {reason}")]
    Open {
        /// `fmu:FILE`.
        uri: String,
        /// Why.
        reason: String,
    },
    /// Its process crashed or hung before it was started.
    #[error("open {uri}: {reason}")]
    Gone {
        /// `fmu:FILE`.
        uri: String,
        /// What happened.
        reason: String,
    },
}

impl UseError {
    /// Problems with what a scenario's file says.
    pub(crate) fn problems(file: &str, problems: Vec<Problem>) -> Self {
        Self::Mapping(ScenarioError { file: file.to_owned(), problems })
    }

    /// What an instance answered before it was started.
    pub(crate) fn instance(uri: &str, error: &InstanceError) -> Self {
        let (uri, reason) = (uri.to_owned(), error.to_string());
        match error {
            InstanceError::Process { .. } => Self::Gone { uri, reason },
            _ => Self::Open { uri, reason },
        }
    }

    /// What keeps channels from being bound.
    pub(crate) fn binding(file: &str, uri: &str, error: BindError) -> Self {
        match error {
            BindError::Mapping(problems) => Self::problems(file, problems),
            BindError::Instance(error) => Self::instance(uri, &error),
        }
    }
}

/// An instance with its clock.
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

    /// `fmu:FILE`.
    #[must_use]
    pub fn uri(&self) -> &str {
        &self.uri
    }

    /// The instance.
    pub fn instance(&mut self) -> &mut dyn Instance {
        self.instance.as_mut()
    }

    /// Time that it has reached, ns.
    #[must_use]
    pub fn time_ns(&self) -> u64 {
        self.time_ns
    }

    /// Sets, steps and gets; false: the FMU wants it to end.
    ///
    /// # Errors
    /// If it fails or refuses the step, in words.
    pub fn exchange(&mut self, inputs: &Bound, outputs: &mut Bound) -> Result<bool, String> {
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
            .map_err(|error| format!("at {time_s} s {error}"))?;
        if stepped.terminate {
            return Ok(false);
        }
        if stepped.outcome == Outcome::Discarded {
            let said = crate::fmu::run::said(self.instance.as_mut());
            return Err(format!("at {time_s} s it refused a step of {step_s} s{said}"));
        }
        self.time_ns += self.step_ns;
        Ok(true)
    }

    /// Gets, without a step.
    ///
    /// # Errors
    /// If it fails, in words.
    pub fn get(&mut self, outputs: &mut Bound) -> Result<(), String> {
        let mut rest = outputs.numbers.as_mut_slice();
        for group in &outputs.plan.groups {
            let (these, others) = rest.split_at_mut(group.elements);
            self.instance
                .get(group, these)
                .map_err(|error| format!("at {} s {error}", self.time_ns as f64 * 1e-9))?;
            rest = others;
        }
        Ok(())
    }

    /// What it was started with.
    #[must_use]
    pub fn starts(&self) -> &Starts {
        &self.starts
    }

    /// Ends the simulation, and gets what the end has changed.
    ///
    /// # Errors
    /// If it fails, in words.
    pub fn end(&mut self, outputs: &mut Bound) -> Result<(), String> {
        self.instance.terminate().map_err(|error| error.to_string())?;
        self.get(outputs)
    }

    /// Starts anew with other start values.
    ///
    /// # Errors
    /// If it fails, in words.
    pub fn restart(&mut self, starts: Starts) -> Result<(), String> {
        self.starts = starts;
        self.time_ns = 0;
        let instance = self.instance.as_mut();
        instance.reset().map_err(|error| error.to_string())?;
        initialize(instance, &self.starts, self.tolerance).map_err(|error| error.to_string())
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
