//! Opens the source of a scenario.

use super::any::AddedReference;
use super::dither::Dither;
use super::known::KnownReference;
use super::measured::{MeasuredReference, ReferenceRows};
use super::reference_mcap::ReferenceMcap;
use super::reference_text::ReferenceText;
use super::{AnySource, LiveSource, LogSource, Replay, SolutionSource, SourceError, TextSource};
use octant_fmu_bind::OpenedFmus;
use octant_plant::config::PlantConfig;
use octant_scenario::recorded::{TextFiles, TextMapping};
use octant_scenario::reference::{ReferencePlace, ReferenceSpec};
use octant_scenario::{self as scenario, FileName, Scenario};
use std::path::{Path, PathBuf};

/// Checks a source without opening it, where it may be opened only once and not before the run: data that an
/// instrument sends in between would be lost. Returns whether it is such a source; any other is checked by
/// [`open_with`].
///
/// # Errors
/// As [`open`].
pub fn check_live(scenario: &Scenario) -> Result<bool, SourceError> {
    match scenario.source.instrument() {
        Some(instrument) => LiveSource::check(scenario, instrument).map(|()| true),
        None => Ok(false),
    }
}

/// Opens the source of a scenario; `None` where it is the plant alone, which is built from the
/// seed's draws: see [`super::PlantSource`]. `plant` is the configuration of that plant, needed for
/// a ship under it and for our Plant FMU.
///
/// # Errors
/// If a file name can't be expanded, or a file can't be read.
pub fn open(scenario: &Scenario, plant: &PlantConfig) -> Result<Option<AnySource>, SourceError> {
    open_with(scenario, plant, &OpenedFmus::default())
}

/// Opens as [`open`], with FMUs that are opened or get opened.
///
/// # Errors
/// As [`open`].
pub fn open_with(
    scenario: &Scenario,
    plant: &PlantConfig,
    fmus: &OpenedFmus,
) -> Result<Option<AnySource>, SourceError> {
    let Some(opened) = open_itself(scenario, plant, fmus)? else { return Ok(None) };
    let dither = Dither::of(scenario, plant.seed);
    Ok(Some(opened.with_reference(reference(scenario)?).with_dither(dither)))
}

/// Opens the reference of a scenario whose source brings none.
fn reference(scenario: &Scenario) -> Result<Option<AddedReference>, SourceError> {
    let period_ns = scenario.sample_period_ns;
    let path = |file: &Path| {
        let name = FileName(file.display().to_string());
        name.path(&scenario.folder).map_err(SourceError::FileName)
    };
    Ok(match &scenario.reference {
        None => None,
        Some(ReferenceSpec::Static(known)) => Some(AddedReference::Known(KnownReference::new(
            *known,
            scenario.aiding.period_ns,
            period_ns,
        ))),
        Some(ReferenceSpec::Recorded(recorded)) => {
            let rows = match &recorded.place {
                ReferencePlace::Text(columns) => {
                    let file = path(&columns.file)?;
                    let rows = ReferenceText::open(&file, columns, recorded.names)?;
                    ReferenceRows::Text(Box::new(rows))
                }
                ReferencePlace::Mcap(fields) => {
                    let rows = ReferenceMcap::open(&path(&fields.file)?, fields)?;
                    ReferenceRows::Mcap(Box::new(rows))
                }
            };
            let measured = MeasuredReference::new(rows, recorded, period_ns);
            Some(AddedReference::Measured(Box::new(measured)))
        }
    })
}

fn open_itself(
    scenario: &Scenario,
    plant: &PlantConfig,
    fmus: &OpenedFmus,
) -> Result<Option<AnySource>, SourceError> {
    let path = |name: &FileName| name.path(&scenario.folder).map_err(SourceError::FileName);
    match &scenario.source {
        scenario::SourceSpec::Plant => Ok(None),
        scenario::SourceSpec::Replay { file, mapping } => {
            Ok(Some(Replay::open(&path(file)?, mapping.as_ref())?.into()))
        }
        scenario::SourceSpec::Text(mapping) => {
            let path = |written: &PathBuf| path(&FileName(written.display().to_string()));
            let files = match &mapping.files {
                TextFiles::One(file) => TextFiles::One(path(file)?),
                TextFiles::Split { gyro, accelerometer } => {
                    TextFiles::Split { gyro: path(gyro)?, accelerometer: path(accelerometer)? }
                }
            };
            let mapping = TextMapping { files, ..mapping.clone() };
            Ok(Some(TextSource::open(&mapping)?.into()))
        }
        scenario::SourceSpec::Log(log) => {
            let (file, rate_hz) = (path(&log.file)?, scenario.sample_rate_hz);
            Ok(Some(LogSource::open(&file, log, &scenario.folder, rate_hz)?.into()))
        }
        scenario::SourceSpec::Solution(spec) => {
            Ok(Some(SolutionSource::open(scenario, spec)?.into()))
        }
        scenario::SourceSpec::Live(instrument) => {
            Ok(Some(LiveSource::of(scenario, instrument)?.into()))
        }
        scenario::SourceSpec::Fmu(fmu) => Ok(Some(super::fmu::open(scenario, fmu, plant, fmus)?)),
    }
}
