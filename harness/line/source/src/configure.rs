//! Configurations of plant and core: from the scenario, the seed's draws, and the source's own truth.

use super::{AnySource, Source, SourceError};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use octant_calibration::config as core;
use octant_fmu_bind::OpenedFmus;
use octant_plant::{Plant, config as plant};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Method, Scenario, SourceSpec as SourceKind};

/// Why a method of a scenario has no configuration.
#[derive(Debug, thiserror::Error)]
pub enum ConfigurationError {
    /// The plant's configuration contradicts itself.
    #[error("set up the plant: {0}")]
    Plant(#[from] octant_plant::PlantConfigError),
    /// A source that knows the truth at the start could not be asked for it.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The scenario has no second method.
    #[error("run the baseline: the scenario has no [baseline]")]
    NoBaseline,
}

/// Configurations of plant and core of one method, and what was opened to know them.
pub struct Configured {
    /// Configuration of the plant.
    pub plant: plant::PlantConfig,
    /// Configuration of the core.
    pub core: core::CoreConfig,
    /// Values that the seed draws.
    pub draws: DrawnValues,
    /// The source at its start, where it had to be opened and asked for the truth: an FMU that moves the case.
    pub source: Option<AnySource>,
}

/// Configurations of plant and core of one method of a scenario.
///
/// # Errors
/// If they contradict themselves.
pub fn configurations(
    scenario: &Scenario,
    method: Method,
    seed: u64,
) -> Result<(plant::PlantConfig, core::CoreConfig, DrawnValues), ConfigurationError> {
    let Configured { plant, core, draws, source: _ } =
        configured(scenario, method, seed, &OpenedFmus::default())?;
    Ok((plant, core, draws))
}

/// Configures as [`configurations`], with FMUs that are opened or get opened.
///
/// # Errors
/// As [`configurations`].
pub fn configured(
    scenario: &Scenario,
    method: Method,
    seed: u64,
    fmus: &OpenedFmus,
) -> Result<Configured, ConfigurationError> {
    let draws = DrawnValues::of(scenario, &Seeded(seed));
    let plant = scenario.plant(seed, &draws);
    let mut source = None;
    // On a ship the attitude at the start depends on the phases that were drawn, or on the ship.
    let truth = match &scenario.source {
        SourceKind::Plant => Some(Plant::new(&plant)?.truth()),
        SourceKind::Fmu(fmu) if fmu.is_motion() => {
            source = crate::open_with(scenario, &plant, fmus)?;
            source.as_ref().and_then(AnySource::truth)
        }
        SourceKind::Fmu(fmu) => crate::fmu::truth_at_start(scenario, fmu, &plant, fmus)?,
        SourceKind::Replay { .. }
        | SourceKind::Text(_)
        | SourceKind::Log(_)
        | SourceKind::Live(_)
        | SourceKind::Solution(_) => None,
    };
    let (q_nb, velocity) = match truth {
        Some(truth) => {
            let [w, x, y, z] = truth.q_nb;
            let q_nb = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
            (q_nb, Vector3::from(truth.velocity_mps))
        }
        None => (scenario.mean_attitude(), Vector3::zeros()),
    };
    let core =
        scenario.core(method, &draws, &q_nb, &velocity).ok_or(ConfigurationError::NoBaseline)?;
    Ok(Configured { plant, core, draws, source })
}
