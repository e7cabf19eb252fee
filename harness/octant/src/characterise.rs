//! `octant characterise`: the noise of an instrument from a recording at rest.

use crate::failure::Failure;
use crate::terminal::{print, print_json, write};
use clap::Args;
use octant_characterise::recording::RestingRecording;
use octant_characterise::result::characterise;
use octant_characterise::{page, text};
use octant_requirements::Verdict;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
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
    #[arg(long, value_name = "SEED", default_value = "1", value_parser = crate::arguments::seed)]
    seed: u64,
    /// Simulate no twin.
    #[arg(long)]
    no_twin: bool,
    /// Replace existing files.
    #[arg(long)]
    force: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let files: Vec<&Path> =
        [&arguments.imu, &arguments.html].into_iter().flatten().map(PathBuf::as_path).collect();
    if let Some(file) = files.iter().find(|file| file.exists() && !arguments.force) {
        return Err(Failure::input(format!(
            "failed to write {}: it exists; --force replaces it",
            file.display()
        )));
    }
    let path = match arguments.recording.is_dir() {
        true => crate::run_folder::recording_of(&arguments.recording)?,
        false => arguments.recording.clone(),
    };
    let recording = RestingRecording::of(&path, arguments.scenario.as_deref(), &arguments.set)
        .map_err(Failure::input)?;
    let seed = (!arguments.no_twin).then_some(arguments.seed);
    let result = characterise(&recording, seed).map_err(Failure::input)?;
    if let Some(file) = &arguments.imu {
        write(file, &result.imu)?;
    }
    if let Some(file) = &arguments.html {
        let words: Vec<String> = std::env::args().skip(1).collect();
        write(file, page::render(&result, &format!("octant {}", words.join(" "))))?;
    }
    if arguments.json {
        print_json(&result)?;
    } else {
        print(&text::of(&result))?;
    }
    Ok(Verdict::Pass)
}
