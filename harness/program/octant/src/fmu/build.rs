//! `octant fmu build`.

use crate::failure::Failure;
use crate::terminal::{print, print_json};
use clap::Args;
use octant_fmu_build::{BuildError, Options, build};
use octant_scenario::Scenario;
use octant_verdict::Verdict;
use serde::Serialize;
use std::path::PathBuf;

/// Build the FMUs of the calibration core and the plant, and the system of both.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder for the files.
    #[arg(long, value_name = "DIR", default_value = "fmus")]
    out: PathBuf,
    /// Scenario whose parameters go into octant.ssp, and into files .ssv and .csv; without it
    /// octant.ssp has a built-in scenario of ten minutes.
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
    /// Change one key of that scenario.
    #[arg(long, value_name = "KEY=VALUE", requires = "scenario")]
    set: Vec<String>,
    /// Further platform of the FMUs, such as aarch64-unknown-linux-gnu: cargo builds the library for
    /// it from the source.
    #[arg(long, value_name = "TRIPLE")]
    target: Vec<String>,
    /// Shared library to include, each for another platform, instead of the one that was built with
    /// the program.
    #[arg(long, value_name = "FILE")]
    library: Vec<PathBuf>,
    /// Leave out the inputs and outputs to check a tool with, a quarter of each file and more.
    #[arg(long)]
    without_reference: bool,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Built {
    files: Vec<PathBuf>,
}

impl From<BuildError> for Failure {
    fn from(error: BuildError) -> Self {
        Self::of(&error)
    }
}

/// Runs the command.
pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { out, scenario, set, target, library, without_reference, json } = arguments;
    let scenario = match scenario {
        Some(path) => {
            let loaded = Scenario::load(path, set).map_err(Failure::input)?;
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            Some((name, loaded))
        }
        None => None,
    };
    let files = build(&Options {
        out: out.clone(),
        libraries: library.clone(),
        targets: target.clone(),
        scenario,
        without_reference: *without_reference,
    })?;
    if *json {
        print_json(&Built { files })?;
    } else {
        let lines: String = files.iter().map(|file| format!("{}\n", file.display())).collect();
        print(&lines)?;
    }
    Ok(Verdict::Pass)
}
