//! `octant fmu build`.

use super::super::{Failure, print, print_json};
use crate::fmu::build::{BuildError, Options, build};
use clap::Args;
use octant_requirements::Verdict;
use octant_scenario::Scenario;
use serde::Serialize;
use std::path::PathBuf;

/// Make the FMUs of the calibration core and the plant, and the system of both.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder that the files go into.
    #[arg(long, value_name = "DIR", default_value = "fmus")]
    out: PathBuf,
    /// The scenario whose parameters octant.ssp has, and which are written as .ssv and .csv;
    /// without it octant.ssp has ten minutes that are built in.
    #[arg(long, value_name = "FILE")]
    scenario: Option<PathBuf>,
    /// Change one key of that scenario.
    #[arg(long, value_name = "KEY=VALUE", requires = "scenario")]
    set: Vec<String>,
    /// A platform that the FMUs run on too, such as aarch64-unknown-linux-gnu: cargo builds the
    /// library for it from the source.
    #[arg(long, value_name = "TRIPLE")]
    target: Vec<String>,
    /// A shared library to put in, each for another platform, instead of the one that was built
    /// with the program.
    #[arg(long, value_name = "FILE")]
    library: Vec<PathBuf>,
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
        match error {
            BuildError::Write { .. } | BuildError::Program { .. } | BuildError::Model { .. } => {
                Self::bench(error)
            }
            _ => Self::input(error),
        }
    }
}

/// Runs the command.
pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { out, scenario, set, target, library, json } = arguments;
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
    })?;
    if *json {
        print_json(&Built { files })?;
    } else {
        let lines: String = files.iter().map(|file| format!("{}\n", file.display())).collect();
        print(&lines)?;
    }
    Ok(Verdict::Pass)
}
