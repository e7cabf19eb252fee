//! Opens the source of a scenario.

use super::{LiveSource, Replay, Source, SourceError, TextSource};
use octant_plant::config::Config;
use octant_scenario::recorded::{TextFiles, TextMapping};
use octant_scenario::{self as scenario, FileName, Scenario};
use std::path::PathBuf;

/// Opens the source of a scenario; `None` where it is the plant alone, which is built from the
/// seed's draws: see [`super::PlantSource`]. `plant` is the configuration of that plant, needed for
/// a ship under it and for our Plant FMU.
///
/// # Errors
/// If a file name can't be expanded, or a file can't be read.
pub fn open(scenario: &Scenario, plant: &Config) -> Result<Option<Box<dyn Source>>, SourceError> {
    let path = |name: &FileName| name.path(&scenario.folder).map_err(SourceError::FileName);
    match &scenario.source {
        scenario::Source::Plant => Ok(None),
        scenario::Source::Replay { file, mapping } => {
            Ok(Some(Box::new(Replay::open(&path(file)?, mapping.as_ref())?)))
        }
        scenario::Source::Text(mapping) => {
            let path = |written: &PathBuf| path(&FileName(written.display().to_string()));
            let files = match &mapping.files {
                TextFiles::One(file) => TextFiles::One(path(file)?),
                TextFiles::Split { gyro, accelerometer } => {
                    TextFiles::Split { gyro: path(gyro)?, accelerometer: path(accelerometer)? }
                }
            };
            let mapping = TextMapping { files, ..mapping.clone() };
            Ok(Some(Box::new(TextSource::open(&mapping)?)))
        }
        scenario::Source::Live(instrument) => {
            Ok(Some(Box::new(LiveSource::of(scenario, instrument)?)))
        }
        scenario::Source::Fmu(fmu) => Ok(Some(super::fmu::open(scenario, fmu, plant)?)),
    }
}
