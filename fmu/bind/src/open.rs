//! Prepares the FMU of a scenario for its start.

use super::opened::OpenedFmus;
use super::settings::{Starts, ValueSettings};
use super::stepper::UseError;
use octant_calibration::CoreConfig;
use octant_fmu_host::description::Description;
use octant_fmu_host::instance::{Instance, InterfaceKind, OpenOptions, ProcessPlace};
use octant_plant::config::PlantConfig;
use octant_scenario::{Fmu, InterfaceChoice, Problem, Process, Scenario};
use std::time::Duration;

/// An instance and its URI, for messages.
pub struct NamedInstance {
    /// The instance.
    pub instance: Box<dyn Instance>,
    /// URI: `fmu:FILE`.
    pub uri: String,
}

/// Names and values of the variables of one of our own FMUs.
pub type OwnVariables = Vec<(&'static str, Vec<f64>)>;

/// Makes an instance of a scenario's FMU.
///
/// # Errors
/// If it can't be read, lacks the interface, or can't be loaded.
pub fn instance(
    scenario: &Scenario,
    fmu: &Fmu,
    fmus: &OpenedFmus,
) -> Result<NamedInstance, UseError> {
    let (opened, path) = fmus.of(scenario, fmu)?;
    let uri = format!("fmu:{}", path.display());
    // Our FMUs give the same answers without event mode, in a third of the time.
    let own = is_made_here(opened.description());
    let options = OpenOptions { event_mode: !own, ..options(fmu) };
    match opened.instance(&options) {
        Ok(instance) => Ok(NamedInstance { instance, uri }),
        Err(error) => Err(UseError::open(&uri, error)),
    }
}

/// Longest time for loading and initializing an FMU, in limits of one call: 1 min by default.
const START_CALLS: f64 = 6.0;

/// Returns the options with which a scenario runs an FMU.
#[must_use]
pub fn options(fmu: &Fmu) -> OpenOptions {
    let default = OpenOptions::default();
    let given = fmu.time_limit_s.is_finite();
    let limit = |s: f64, or: Duration| if given { Duration::from_secs_f64(s) } else { or };
    OpenOptions {
        interface: match fmu.interface {
            InterfaceChoice::Auto => InterfaceKind::Any,
            InterfaceChoice::CoSimulation => InterfaceKind::CoSimulation,
            InterfaceChoice::ModelExchange => InterfaceKind::ModelExchange,
        },
        place: match fmu.process {
            Process::Own => ProcessPlace::OwnProcess,
            Process::Shared => ProcessPlace::ThisProcess,
        },
        allow_tool: fmu.allow_tool,
        start_limit: limit(START_CALLS * fmu.time_limit_s, default.start_limit),
        time_limit: limit(fmu.time_limit_s, default.time_limit),
        ..default
    }
}

/// Collects the values that are set before the start: those of our own FMU, then those of the
/// scenario.
///
/// # Errors
/// If a name or a value doesn't fit.
pub fn starts(
    scenario: &Scenario,
    fmu: &Fmu,
    uri: &str,
    description: &Description,
    own: Option<&[(&'static str, Vec<f64>)]>,
) -> Result<Starts, UseError> {
    let open = |reason: String| UseError::Open { uri: uri.to_owned(), reason };
    let mut settings = ValueSettings::new(description);
    for (name, numbers) in own.unwrap_or_default() {
        settings.own(name, numbers).map_err(|error| open(error.to_string()))?;
    }
    let mut problems: Vec<Problem> = Vec::new();
    for setting in &fmu.settings {
        if let Err(error) = settings.set(&setting.name, &setting.values) {
            problems.push(setting.at.problem(error.to_string()));
        }
    }
    if !problems.is_empty() {
        return Err(UseError::problems(&scenario.file, problems));
    }
    settings.finish().map_err(|error| open(error.to_string()))
}

/// Returns the start values of our Calibrator; `None` for a foreign FMU.
#[must_use]
pub fn own_calibrator(description: &Description, config: &CoreConfig) -> Option<OwnVariables> {
    let model = &octant_fmu::calibrator::table::MODEL;
    is_own(description, model.name).then(|| {
        let mut values = octant_fmu::calibrator::start_values(config);
        // Faults alter stamps, and epochs get lost on the way.
        values.push(("imu.external_stamps", vec![1.0]));
        values
    })
}

/// A plant for which the parameters of our Plant have no room.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{found}")]
pub struct NoRoom {
    /// Part of the plant found, and what the parameters have room for.
    pub found: String,
}

/// Returns the start values of our Plant; `None` for a foreign FMU.
///
/// # Errors
/// If the plant's parameters have no room for something.
pub fn own_plant(
    description: &Description,
    config: &PlantConfig,
) -> Result<Option<OwnVariables>, NoRoom> {
    if !is_own(description, octant_fmu::plant::table::MODEL.name) {
        return Ok(None);
    }
    let mut values = octant_fmu::plant::start_values(config, &[])
        .map_err(|reason| NoRoom { found: reason.to_string() })?;
    values.push(("truth.enabled", vec![1.0]));
    Ok(Some(values))
}

/// Returns whether the file of an FMU holds our Plant; false if it can't be read.
#[must_use]
pub fn is_own_plant(scenario: &Scenario, fmu: &Fmu, fmus: &OpenedFmus) -> bool {
    let opened = fmus.of(scenario, fmu);
    opened.is_ok_and(|(fmu, _)| is_own(fmu.description(), octant_fmu::plant::table::MODEL.name))
}

/// Returns whether an FMU is one of ours: made by this program, under this name.
fn is_own(description: &Description, name: &str) -> bool {
    description.model_name == name && is_made_here(description)
}

fn is_made_here(description: &Description) -> bool {
    description.generation_tool.starts_with("Octant ")
}
