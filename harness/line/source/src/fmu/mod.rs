//! FMUs as a source: our own plant, a foreign instrument, or the ship under our plant.

mod ending;
pub(super) mod instrument;
pub(super) mod motion;

use instrument::{FmuSource, Instrument, Timing};
use motion::{MovedPlant, Moving};
use octant_plant::Truth;

use super::{AnySource, SourceError};
use octant_fmu_bind::OpenedFmus;
use octant_fmu_bind::open::{self, NamedInstance};
use octant_fmu_bind::stepper::{Stepper, UseError};
use octant_plant::config as plant;
use octant_scenario::{Fmu, Scenario};

/// Opens the FMU of a scenario's source. `plant` is the plant configuration of the scenario, which
/// our Plant FMU is set to.
///
/// # Errors
/// If the FMU can't be used, or the scenario's settings for it don't fit.
pub(super) fn open(
    scenario: &Scenario,
    fmu: &Fmu,
    plant: &plant::PlantConfig,
    fmus: &OpenedFmus,
) -> Result<AnySource, SourceError> {
    of_instance(scenario, fmu, plant, open::instance(scenario, fmu, fmus)?)
}

fn of_instance(
    scenario: &Scenario,
    fmu: &Fmu,
    plant: &plant::PlantConfig,
    NamedInstance { instance, uri }: NamedInstance,
) -> Result<AnySource, SourceError> {
    if fmu.is_motion() {
        let moving = moving(scenario, fmu, plant, NamedInstance { instance, uri })?;
        let samples = scenario.samples().unwrap_or(u64::MAX);
        let samples_a_piece = fmu.step_ns / scenario.sample_period_ns;
        return Ok(MovedPlant::new(moving, plant, samples, samples_a_piece)?.into());
    }
    let description = instance.description();
    let own = open::own_plant(description, plant)
        .map_err(|error| UseError::Open { uri: uri.clone(), reason: error.to_string() })?;
    let starts = open::starts(scenario, fmu, &uri, description, own.as_deref())?;
    let instrument = Instrument::bind(description, fmu)
        .map_err(|error| UseError::binding(&scenario.file, &uri, error))?;
    let stepper = Stepper::start(instance, &uri, starts, fmu.tolerance, fmu.step_ns)?;
    let timing = Timing {
        period_ns: scenario.sample_period_ns,
        samples: scenario.samples().unwrap_or(u64::MAX),
        calibration_samples: scenario.calibration_samples(),
        reference_samples: (scenario.aiding.period_ns / scenario.sample_period_ns).max(1),
        position: matches!(scenario.aiding.kind, plant::AidingKind::DockPosition { .. }),
    };
    Ok(FmuSource::new(stepper, instrument, timing, fmu.step_ns, own.is_some()).into())
}

/// Opens the case motion that an FMU outputs, at its start.
fn moving(
    scenario: &Scenario,
    fmu: &Fmu,
    plant: &plant::PlantConfig,
    NamedInstance { instance, uri }: NamedInstance,
) -> Result<Moving, SourceError> {
    let description = instance.description();
    let starts = open::starts(scenario, fmu, &uri, description, None)?;
    let bindings = motion::bind(description, fmu)
        .map_err(|error| UseError::binding(&scenario.file, &uri, error))?;
    let stepper = Stepper::start(instance, &uri, starts, fmu.tolerance, fmu.step_ns)?;
    Moving::new(stepper, bindings, plant, fmu.step_ns as f64 * 1e-9)
}

/// Returns truth at the start of a run with our Plant FMU; `None` for another one. An FMU of case motion is asked
/// itself: [`AnySource::truth`].
///
/// # Errors
/// If the FMU can't be used.
pub(crate) fn truth_at_start(
    scenario: &Scenario,
    fmu: &Fmu,
    plant: &plant::PlantConfig,
    fmus: &OpenedFmus,
) -> Result<Option<Truth>, SourceError> {
    if !open::is_own_plant(scenario, fmu, fmus) {
        return Ok(None);
    }
    let plant = octant_plant::Plant::new(plant).map_err(|error| UseError::Open {
        uri: format!("fmu:{}", fmu.file.0),
        reason: error.to_string(),
    })?;
    Ok(Some(plant.truth()))
}

#[cfg(test)]
mod tests;
