//! How long a system runs, and in what steps: from the command line, the structure, or the FMUs.

use super::flat::Flat;
use super::ssp::structure::Structure;
use octant_fmu_host::description::Description;

/// Steps of a run at most: beyond, a step is surely too short.
const STEPS_MAX: f64 = 1e12;

/// What the command line says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Said {
    /// Start, s.
    pub start_s: Option<f64>,
    /// End, s.
    pub stop_s: Option<f64>,
    /// Communication step, s.
    pub step_s: Option<f64>,
}

/// How long, and in what steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Experiment {
    /// Start, s.
    pub start_s: f64,
    /// Communication step, s.
    pub step_s: f64,
    /// Number of steps.
    pub steps: u64,
}

impl Experiment {
    /// Settles what several may say.
    ///
    /// # Errors
    /// If nobody says it, or what is said contradicts itself.
    pub fn of(
        said: &Said,
        structure: &Structure,
        flat: &Flat,
        descriptions: &[&Description],
    ) -> Result<Self, String> {
        let of_fmus = |what: &str, of: fn(&Description) -> Option<f64>| -> Result<_, String> {
            let mut found: Option<(f64, &str)> = None;
            for (description, component) in descriptions.iter().zip(&flat.components) {
                let Some(value) = of(description) else { continue };
                match found {
                    Some((other, name)) if other != value => {
                        return Err(format!(
                            "the FMUs want different {what}s, {name} {other} s and {} {value} s: \
                             say which with --{what}",
                            component.name
                        ));
                    }
                    _ => found = Some((value, &component.name)),
                }
            }
            Ok(found.map(|(value, _)| value))
        };
        let missing = |what: &str, example: &str| {
            format!(
                "neither the structure nor the FMUs say the {what}: say it with --{what} {example}"
            )
        };
        let start_s = said.start_s.or(structure.start_s).unwrap_or(0.0);
        let step_s = match said.step_s.or(structure.co_simulation.step_s).or(structure.osp_step_s) {
            Some(step_s) => step_s,
            None => of_fmus("step", step_of)?.ok_or_else(|| missing("step", "\"5 ms\""))?,
        };
        let stop_s = match said.stop_s.or(structure.stop_s) {
            Some(stop_s) => stop_s,
            None => of_fmus("stop", |description| description.default_experiment.stop_s)?
                .ok_or_else(|| missing("stop", "\"10 min\""))?,
        };
        if !(step_s.is_finite() && step_s > 0.0) {
            return Err(format!("the step is {step_s} s, expected a time above 0"));
        }
        if !(stop_s > start_s) {
            return Err(format!("the run ends at {stop_s} s, expected a time after {start_s} s"));
        }
        let exact = (stop_s - start_s) / step_s;
        let steps = exact.round();
        if exact > STEPS_MAX {
            return Err(format!("the step is {step_s} s, with which there are {exact:e} steps"));
        }
        if steps < 1.0 || (exact - steps).abs() > 1e-6 {
            return Err(format!(
                "from {start_s} s to {stop_s} s there are {exact} steps of {step_s} s, expected a \
                 whole number"
            ));
        }
        Ok(Self { start_s, step_s, steps: steps as u64 })
    }

    /// End of the run, s.
    #[must_use]
    pub fn stop_s(&self) -> f64 {
        self.start_s + self.steps as f64 * self.step_s
    }
}

/// The step that an FMU wants.
fn step_of(description: &Description) -> Option<f64> {
    let fixed = description.co_simulation.as_ref().and_then(|cs| cs.fixed_internal_step_s);
    description.default_experiment.step_s.or(fixed)
}
