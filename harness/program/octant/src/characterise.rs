//! `octant characterise`: the noise of an instrument from a recording at rest.

use crate::failure::Failure;
use crate::terminal::{print, print_json, tell_account, write};
use clap::{ArgGroup, Args};
use octant_characterise::recording::RestingRecording;
use octant_characterise::result::characterise;
use octant_characterise::{page, text};
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("written").args(["imu", "html"]).multiple(true)))]
pub(super) struct Arguments {
    /// Recording at rest: a folder of a run or its MCAP file, samples of octant export (.csv), a scenario (.toml) whose
    /// source is a recording, or with --scenario any text or MCAP file.
    #[arg(value_name = "RECORDING")]
    recording: PathBuf,
    /// Scenario with the columns or fields of the recording; its source.uri is not read.
    #[arg(long, value_name = "SCENARIO")]
    scenario: Option<PathBuf>,
    /// Change a key of the scenario, such as imu.rate="100 Hz".
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Write a scenario with the instrument's noise as its [imu].
    #[arg(long, value_name = "FILE")]
    imu: Option<PathBuf>,
    /// Write a page with plots.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
    /// Seed of the simulated twin.
    #[arg(long, value_name = "SEED", default_value = "1", value_parser = crate::arguments::seed, conflicts_with = "no_twin")]
    seed: u64,
    /// Simulate no twin.
    #[arg(long)]
    no_twin: bool,
    /// Replace existing files.
    #[arg(long, requires = "written")]
    force: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { recording, scenario, set, imu, html, seed, no_twin, force, json } = arguments;
    let files: Vec<&Path> = [imu, html].into_iter().flatten().map(PathBuf::as_path).collect();
    if let Some(file) = files.iter().find(|file| file.exists() && !force) {
        return Err(Failure::input(format!(
            "failed to write {}: it exists; --force replaces it",
            file.display()
        )));
    }
    let path = match recording.is_dir() {
        true => crate::run_folder::recording_of(recording)?,
        false => recording.clone(),
    };
    let recording =
        RestingRecording::of(&path, scenario.as_deref(), set).map_err(Failure::input)?;
    let seed = (!no_twin).then_some(*seed);
    let result = characterise(&recording, seed).map_err(Failure::input)?;
    result.inputs.iter().for_each(tell_account);
    if let Some(file) = imu {
        write(file, &result.imu)?;
    }
    if let Some(file) = html {
        let words: Vec<String> = std::env::args().skip(1).collect();
        write(file, page::render(&result, &format!("octant {}", words.join(" "))))?;
    }
    if *json {
        print_json(&result)?;
    } else {
        print(&text::of(&result))?;
    }
    Ok(Verdict::Pass)
}
