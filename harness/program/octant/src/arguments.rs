//! Arguments that several commands share.

use crate::failure::Failure;
use crate::terminal::note;
use clap::Args;
use octant_scenario::{FilePlaces, UnitDimension, quantity_of};
use std::path::{Path, PathBuf};

/// Arguments of every command that takes a scenario.
#[derive(Debug, Args)]
pub(crate) struct ScenarioArguments {
    /// The scenario, a TOML file.
    #[arg(value_name = "SCENARIO")]
    pub(crate) scenario: PathBuf,
    /// Change one key of the scenario, such as procedure.calibration.duration="12 h".
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Parses a time on the command line: a number of seconds, or a quantity.
pub(crate) fn seconds(name: &str, text: &str) -> Result<f64, Failure> {
    let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
    let quantity = || quantity_of(text).ok().filter(|quantity| quantity.is(UnitDimension::TIME));
    number.or_else(|| quantity().map(|quantity| quantity.si)).ok_or_else(|| {
        Failure::input(format!("{name}: found {text:?}, expected a time such as 10 or \"10 s\""))
    })
}

/// Parses a seed on the command line. The limits are those of a scenario's key, which takes it over.
pub(crate) fn seed(text: &str) -> Result<u64, String> {
    let number = text.trim().parse::<u64>().ok().filter(|seed| i64::try_from(*seed).is_ok());
    number.ok_or_else(|| format!("expected a whole number from 0 to {}", i64::MAX))
}

/// Reads a scenario with the changes of the command line.
pub(crate) fn load(
    arguments: &ScenarioArguments,
    more: &[String],
) -> Result<octant_scenario::Scenario, Failure> {
    let ScenarioArguments { scenario, set } = arguments;
    let set = [set, more].concat();
    read_scenario(scenario, &set, &[], &FilePlaces::default())
}

/// Reads a scenario with changes of its keys, with faults triggered by hand, and with files in other places.
/// Warnings go to stderr.
pub(crate) fn read_scenario(
    path: &Path,
    set: &[String],
    fires: &[String],
    places: &FilePlaces,
) -> Result<octant_scenario::Scenario, Failure> {
    let scenario =
        octant_scenario::Scenario::load_placed(path, set, fires, places).map_err(Failure::input)?;
    for warning in scenario.warnings() {
        note!("octant: {}: {warning}", path.display());
    }
    Ok(scenario)
}
