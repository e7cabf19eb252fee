//! From what a scenario says about an FMU to one that can be started.

use super::settings::{Settings, Starts};
use super::stepper::UseError;
use octant_calibration::Config as CoreConfig;
use octant_fmu_host::OpenError;
use octant_fmu_host::archive::Archive;
use octant_fmu_host::description::{self, Description};
use octant_fmu_host::instance::{Instance, InterfaceKind, Options, Place};
use octant_plant::config::Config as PlantConfig;
use octant_scenario::{Fmu, InterfaceChoice, Problem, Process, Scenario};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// An instance and its URI, for messages.
pub struct Kept {
    /// The instance.
    pub instance: Box<dyn Instance>,
    /// `fmu:FILE`.
    pub uri: String,
}

/// Names and values of the variables of one of our own FMUs.
pub type Own = Vec<(&'static str, Vec<f64>)>;

/// Where the FMU of a scenario is.
///
/// # Errors
/// If its name can't be expanded.
pub fn path(scenario: &Scenario, fmu: &Fmu) -> Result<PathBuf, UseError> {
    let problem = |reason: String| UseError::problems(&scenario.file, vec![fmu.at.problem(reason)]);
    fmu.file.path(&scenario.folder).map_err(|reason| problem(format!("failed to {reason}")))
}

/// Opens the FMU of a scenario.
///
/// # Errors
/// If it can't be read, hasn't the interface, or can't be loaded.
pub fn instance(scenario: &Scenario, fmu: &Fmu) -> Result<Kept, UseError> {
    let path = path(scenario, fmu)?;
    let uri = format!("fmu:{}", path.display());
    // Ours give the same answers without event mode, in a third of the time.
    let own = describe(&path).is_ok_and(|description| is_made_here(&description));
    let options = Options { event_mode: !own, ..options(fmu) };
    let instance = octant_fmu_host::open(&path, &options).map_err(|error| match error {
        OpenError::Instance(error) => UseError::instance(&uri, &error),
        other => UseError::Open { uri: uri.clone(), reason: other.to_string() },
    })?;
    Ok(Kept { instance, uri })
}

/// The description of an FMU that isn't opened.
///
/// # Errors
/// If it can't be read, in words.
pub fn describe(path: &Path) -> Result<Description, String> {
    const NAME: &str = "modelDescription.xml";
    let mut archive = Archive::open(path).map_err(|error| error.to_string())?;
    let bytes = archive.read(NAME).map_err(|error| error.to_string())?;
    let file = format!("{}/{NAME}", archive.file());
    description::read_bytes(&bytes, &file).map_err(|error| error.to_string())
}

/// How a scenario wants an FMU to run.
#[must_use]
pub fn options(fmu: &Fmu) -> Options {
    let default = Options::default();
    Options {
        interface: match fmu.interface {
            InterfaceChoice::Auto => InterfaceKind::Any,
            InterfaceChoice::CoSimulation => InterfaceKind::CoSimulation,
            InterfaceChoice::ModelExchange => InterfaceKind::ModelExchange,
        },
        place: match fmu.process {
            Process::Own => Place::OwnProcess,
            Process::Shared => Place::ThisProcess,
        },
        time_limit: if fmu.time_limit_s.is_finite() {
            Duration::from_secs_f64(fmu.time_limit_s)
        } else {
            default.time_limit
        },
        ..default
    }
}

/// What is set before the start: that of our own FMU, then what the scenario says.
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
    let mut settings = Settings::new(description);
    for (name, numbers) in own.unwrap_or_default() {
        settings.own(name, numbers).map_err(open)?;
    }
    let mut problems: Vec<Problem> = Vec::new();
    for setting in &fmu.settings {
        if let Err(message) = settings.set(&setting.name, &setting.values) {
            problems.push(setting.at.problem(message));
        }
    }
    if !problems.is_empty() {
        return Err(UseError::problems(&scenario.file, problems));
    }
    settings.finish().map_err(|error| open(error.to_string()))
}

/// The start values of our Calibrator; `None` where the FMU is another's.
#[must_use]
pub fn own_calibrator(description: &Description, config: &CoreConfig) -> Option<Own> {
    let model = &octant_fmu::calibrator::table::MODEL;
    is_own(description, model.name).then(|| {
        let mut values = octant_fmu::calibrator::start_values(config);
        // Faults alter stamps, and epochs get lost on the way.
        values.push(("imu.external_stamps", vec![1.0]));
        values
    })
}

/// The start values of our Plant; `None` where the FMU is another's.
///
/// # Errors
/// If there is no room for something in the plant's parameters, in words.
pub fn own_plant(description: &Description, config: &PlantConfig) -> Result<Option<Own>, String> {
    if !is_own(description, octant_fmu::plant::table::MODEL.name) {
        return Ok(None);
    }
    let mut values = octant_fmu::plant::start_values(config, &[])?;
    values.push(("truth.enabled", vec![1.0]));
    Ok(Some(values))
}

/// Whether the file of an FMU holds our Plant; a file that can't be read doesn't.
#[must_use]
pub fn is_own_plant(scenario: &Scenario, fmu: &Fmu) -> bool {
    let description = path(scenario, fmu).ok().and_then(|path| describe(&path).ok());
    description.is_some_and(|of| is_own(&of, octant_fmu::plant::table::MODEL.name))
}

/// Whether an FMU is one of ours: made by this program, under this name.
fn is_own(description: &Description, name: &str) -> bool {
    description.model_name == name && is_made_here(description)
}

fn is_made_here(description: &Description) -> bool {
    description.generation_tool.starts_with("Octant ")
}
