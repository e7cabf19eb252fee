//! `octant export`: a recording as files of other tools.

use crate::arguments::seconds;
use crate::failure::Failure;
use crate::score::{scenario_of, true_parameters};
use crate::terminal::{note, print};
use clap::Args;
use octant_export::{Choice, Format, Table, export};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_verdict::Verdict;
use octant_watch::place::RunPlace;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of a run, or its recording.
    #[arg(value_name = "RUN")]
    run: PathBuf,
    /// Format: csv, parquet, mat, kml or rosbag-mcap.
    #[arg(long, value_name = "FORMAT")]
    to: String,
    /// Tables of csv, parquet and mat: navigation, samples, aiding, parameters, innovations, faults,
    /// events; all of them by default.
    #[arg(long, value_name = "TABLE", value_delimiter = ',')]
    tables: Vec<String>,
    /// Coarser time step, such as "1 s": the first row at or after each multiple is kept, with its
    /// own time. Faults and events are all kept.
    #[arg(long, value_name = "TIME")]
    every: Option<String>,
    /// File, or for csv and parquet the folder, that is written; by default named after the run, in
    /// the current folder.
    #[arg(long, value_name = "PATH")]
    out: Option<PathBuf>,
    /// Replace existing files.
    #[arg(long)]
    force: bool,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { run, to, tables: names, every, out, force } = arguments;
    let format = format(to)?;
    let tables = tables(names, format)?;
    let every_ns = every.as_deref().map(period_ns).transpose()?;
    let failed = |error: &dyn std::fmt::Display| Failure::input(format!("failed to {error}"));
    let place = RunPlace::of(run).map_err(|error| failed(&error))?;
    let recording = place.recording().ok_or_else(|| {
        Failure::input(format!(
            "failed to export {}: its run is starting, there is no recording yet",
            run.display()
        ))
    })?;
    let out = out.clone().unwrap_or_else(|| default_out(&place, &recording, format));
    let choice = Choice { true_parameters: truth(&recording)?, recording, tables, every_ns };
    let exported =
        export(&choice, format, &out, *force).map_err(|error| Failure::of(&error).failed())?;
    for words in &exported.notes {
        note!("octant: {}: {words}", choice.recording.display());
    }
    let files = exported.files.iter().map(|file| format!("{}\n", file.display()));
    print(&files.collect::<String>())?;
    Ok(Verdict::Pass)
}

fn format(name: &str) -> Result<Format, Failure> {
    Format::from_name(name).ok_or_else(|| {
        let known = Format::ALL.iter().map(|format| format.name());
        let known = octant_base::names::suggestion(name, known, "formats");
        Failure::input(format!("--to: unknown format {name:?}, {known}"))
    })
}

/// Returns the chosen tables in their order; for formats without tables what they are made from.
fn tables(names: &[String], format: Format) -> Result<Vec<Table>, Failure> {
    if !format.has_tables() {
        if !names.is_empty() {
            return Err(Failure::input(format!(
                "--tables: {} has no tables, expected with --to csv, parquet or mat",
                format.name()
            )));
        }
        return Ok(vec![Table::Navigation]);
    }
    let mut chosen = Vec::new();
    for name in names {
        let name = name.trim();
        chosen.push(Table::from_name(name).ok_or_else(|| {
            let known = Table::ALL.iter().map(|table| table.name());
            let known = octant_base::names::suggestion(name, known, "tables");
            Failure::input(format!("--tables: unknown table {name:?}, {known}"))
        })?);
    }
    let is_chosen = |table: &Table| chosen.is_empty() || chosen.contains(table);
    Ok(Table::ALL.into_iter().filter(is_chosen).collect())
}

fn period_ns(text: &str) -> Result<u64, Failure> {
    let period_s = seconds("--every", text)?;
    let period_ns = (period_s * 1e9).round();
    if !(1.0..=9.0e18).contains(&period_ns) {
        return Err(Failure::input(format!("--every: found {text:?}, expected more than 0 s")));
    }
    Ok(period_ns as u64)
}

/// Names the output after the run: `runs/quick` becomes `quick-csv`, and its `baseline.mcap`
/// `quick-baseline-csv`.
fn default_out(place: &RunPlace, recording: &Path, format: Format) -> PathBuf {
    let folder = place.folder().canonicalize().unwrap_or_else(|_| place.folder().to_owned());
    let name = |path: &Path| path.file_stem().map(|name| name.to_string_lossy().into_owned());
    let run = name(&folder);
    let file = name(recording).filter(|file| file != "recording");
    let parts: Vec<String> = run.into_iter().chain(file).collect();
    PathBuf::from(format!("{}{}", parts.join("-"), format.suffix()))
}

/// Returns the true parameters of a recording's instrument, SI, where its scenario draws them. A
/// recording whose scenario can't be read is exported without them.
fn truth(
    recording: &Path,
) -> Result<Option<[f64; octant_sample::parameters::PARAMETER_COUNT]>, Failure> {
    let (scenario, _, seed) = match scenario_of(recording) {
        Ok(found) => found,
        Err(failure) => {
            note!("octant: true parameters are unknown: {}", failure.message);
            return Ok(None);
        }
    };
    let draws = || DrawnValues::of(&scenario, &Seeded(seed));
    Ok(true_parameters(recording, &scenario)?.then(|| draws().parameters.to_array()))
}
