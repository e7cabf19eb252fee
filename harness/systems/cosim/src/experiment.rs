//! Determines duration and step of a run: from the command line, the structure, or the FMUs.

use super::flat::Flat;
use super::ssp::structure::SystemStructure;
use octant_fmu_host::description::Description;

/// Maximum number of steps of a run: with more, the step is surely too short.
const STEPS_MAX: f64 = 1e12;

/// Settings of the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GivenSettings {
    /// Start, s.
    pub start_s: Option<f64>,
    /// End, s.
    pub stop_s: Option<f64>,
    /// Communication step, s.
    pub step_s: Option<f64>,
}

/// Reason why a run has no duration or no step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExperimentError {
    /// The FMUs want different values.
    #[error(
        "the FMUs want different {what}s, {first} {first_s} s and {second} {second_s} s: say which \
         with --{what}"
    )]
    Different {
        /// `step` or `stop`.
        what: &'static str,
        /// Name of an FMU.
        first: String,
        /// Its value, s.
        first_s: f64,
        /// Name of another FMU.
        second: String,
        /// Its value, s.
        second_s: f64,
    },
    /// Nothing gives the value.
    #[error("neither the structure nor the FMUs say the {what}: say it with --{what} {example}")]
    Missing {
        /// `step` or `stop`.
        what: &'static str,
        /// Example of a value.
        example: &'static str,
    },
    /// The step is no length of time.
    #[error("the step is {step_s} s, expected a time above 0")]
    Step {
        /// Step found, s.
        step_s: f64,
    },
    /// The run ends before it starts.
    #[error("the run ends at {stop_s} s, expected a time after {start_s} s")]
    Stop {
        /// Start, s.
        start_s: f64,
        /// End found, s.
        stop_s: f64,
    },
    /// Too many steps.
    #[error("the step is {step_s} s, with which there are {steps:e} steps")]
    TooMany {
        /// Step found, s.
        step_s: f64,
        /// Number of steps.
        steps: f64,
    },
    /// The duration is no multiple of the step.
    #[error(
        "from {start_s} s to {stop_s} s there are {steps} steps of {step_s} s, expected a whole \
         number"
    )]
    Fraction {
        /// Start, s.
        start_s: f64,
        /// End, s.
        stop_s: f64,
        /// Step, s.
        step_s: f64,
        /// Number of steps found.
        steps: f64,
    },
}

/// Duration and step of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunExperiment {
    /// Start, s.
    pub start_s: f64,
    /// Communication step, s.
    pub step_s: f64,
    /// Number of steps.
    pub steps: u64,
}

impl RunExperiment {
    /// Chooses among the settings of command line, structure and FMUs.
    ///
    /// # Errors
    /// If none is given, or they contradict each other.
    pub fn of(
        said: &GivenSettings,
        structure: &SystemStructure,
        flat: &Flat,
        descriptions: &[&Description],
    ) -> Result<Self, ExperimentError> {
        let of_fmus = |what: &'static str,
                       of: fn(&Description) -> Option<f64>|
         -> Result<_, ExperimentError> {
            let mut found: Option<(f64, &str)> = None;
            for (description, component) in descriptions.iter().zip(&flat.components) {
                let Some(value) = of(description) else { continue };
                match found {
                    Some((other, name)) if other != value => {
                        return Err(ExperimentError::Different {
                            what,
                            first: name.to_owned(),
                            first_s: other,
                            second: component.name.clone(),
                            second_s: value,
                        });
                    }
                    _ => found = Some((value, &component.name)),
                }
            }
            Ok(found.map(|(value, _)| value))
        };
        let missing = |what, example| ExperimentError::Missing { what, example };
        let start_s = said.start_s.or(structure.start_s).unwrap_or(0.0);
        let step_s =
            match said.step_s.or(structure.co_simulation.step_s).or(structure.others_step_s) {
                Some(step_s) => step_s,
                None => of_fmus("step", step_of)?.ok_or_else(|| missing("step", "\"5 ms\""))?,
            };
        let stop_s = match said.stop_s.or(structure.stop_s) {
            Some(stop_s) => stop_s,
            None => of_fmus("stop", |description| description.default_experiment.stop_s)?
                .ok_or_else(|| missing("stop", "\"10 min\""))?,
        };
        if !(step_s.is_finite() && step_s > 0.0) {
            return Err(ExperimentError::Step { step_s });
        }
        if !(stop_s > start_s) {
            return Err(ExperimentError::Stop { start_s, stop_s });
        }
        let exact = (stop_s - start_s) / step_s;
        let steps = exact.round();
        if exact > STEPS_MAX {
            return Err(ExperimentError::TooMany { step_s, steps: exact });
        }
        if steps < 1.0 || (exact - steps).abs() > 1e-6 {
            return Err(ExperimentError::Fraction { start_s, stop_s, step_s, steps: exact });
        }
        Ok(Self { start_s, step_s, steps: steps as u64 })
    }

    /// End of the run, s.
    #[must_use]
    pub fn stop_s(&self) -> f64 {
        self.start_s + self.steps as f64 * self.step_s
    }
}

/// Returns the step that an FMU prefers.
fn step_of(description: &Description) -> Option<f64> {
    let fixed = description.co_simulation.as_ref().and_then(|cs| cs.fixed_internal_step_s);
    description.default_experiment.step_s.or(fixed)
}
