//! FMUs as a source: our own plant, another's instrument, or the ship under our plant.

mod instrument;

use instrument::{FmuSource, Instrument, Timing};

use super::{Source, SourceError};
use crate::fmu::mapping::open::{self, Kept};
use crate::fmu::mapping::stepper::{Stepper, UseError};
use crate::scenario::{Fmu, Scenario};
use octant_plant::config as plant;

/// Opens the FMU of a scenario's source. `plant` is what the scenario makes of its own plant:
/// our Plant FMU is set to be it.
///
/// # Errors
/// If the FMU can't be used, or what the scenario says about it doesn't fit.
pub(super) fn open(
    scenario: &Scenario,
    fmu: &Fmu,
    plant: &plant::Config,
) -> Result<Box<dyn Source>, SourceError> {
    of_instance(scenario, fmu, plant, open::instance(scenario, fmu)?)
}

fn of_instance(
    scenario: &Scenario,
    fmu: &Fmu,
    plant: &plant::Config,
    Kept { instance, uri }: Kept,
) -> Result<Box<dyn Source>, SourceError> {
    let description = instance.description().clone();
    let own = open::own_plant(&description, plant);
    let starts = open::starts(scenario, fmu, &uri, &description, own.as_deref())?;
    let instrument = Instrument::bind(&description, fmu)
        .map_err(|error| UseError::binding(&scenario.file, &uri, error))?;
    let stepper = Stepper::start(instance, &uri, starts, fmu.tolerance, fmu.step_ns)?;
    let timing = Timing {
        period_ns: scenario.sample_period_ns,
        samples: scenario.samples().unwrap_or(u64::MAX),
        calibration_samples: scenario.calibration_samples(),
        reference_samples: (scenario.aiding.period_ns / scenario.sample_period_ns).max(1),
        position: matches!(scenario.aiding.kind, plant::AidingKind::DockPosition { .. }),
    };
    Ok(Box::new(FmuSource::new(stepper, instrument, timing, fmu.step_ns, own.is_some())))
}

#[cfg(test)]
mod tests;
