//! `octant fmu check`.

use crate::failure::Failure;
use crate::terminal::{print, print_json};
use clap::Args;
use octant_fmu_check::load::load;
use octant_fmu_check::rules::Severity;
use octant_fmu_check::{Report, check, show};
use octant_fmu_host::archive::ArchiveError;
use octant_fmu_host::instance::OpenOptions;
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Check an FMU of any tool: its archive, its description, its libraries.
///
/// Exit status: 0 no error, 1 errors, 2 a file can't be read.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// FMUs: files, or folders of unpacked ones.
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// Print one JSON object, nothing else.
    #[arg(long)]
    json: bool,
    /// Load the library for this machine and make an instance, in a process of its own. This is
    /// the default; it runs the FMU's code.
    #[arg(long, overrides_with = "no_load")]
    load: bool,
    /// Run no code of the FMU.
    #[arg(long, overrides_with = "load")]
    no_load: bool,
    /// Initialize the instance with the start values, and do a first step.
    #[arg(long, conflicts_with = "no_load")]
    step: bool,
    /// Load also an FMU that needs the tool that made it.
    #[arg(long, conflicts_with = "no_load")]
    allow_tool: bool,
    /// Longest time for loading and initializing, and for any other call, s.
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0, conflicts_with = "no_load")]
    time_limit: f64,
}

/// Runs the command.
pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    // --load overrides an earlier --no-load: that is all it does.
    let Arguments { files, json: as_json, load: _, no_load, step, allow_tool, time_limit } =
        arguments;
    let limit = Duration::try_from_secs_f64(*time_limit)
        .ok()
        .filter(|limit| !limit.is_zero())
        .ok_or_else(|| {
            Failure::input(format!(
                "--time-limit: found {time_limit}, expected a positive number of seconds"
            ))
        })?;
    let options = OpenOptions {
        allow_tool: *allow_tool,
        start_limit: limit,
        time_limit: limit,
        ..OpenOptions::default()
    };
    let mut results = Vec::new();
    for file in files {
        results.push((file, one(file, (!no_load).then_some(*step), &options)));
    }
    if *as_json {
        print_json(&json(&results))?;
    } else {
        for (_, result) in &results {
            if let Ok(report) = result {
                print(&show::text(report))?;
            }
        }
    }
    let unreadable: Vec<String> =
        results.iter().filter_map(|(_, result)| Some(result.as_ref().err()?.to_string())).collect();
    if !unreadable.is_empty() {
        return Err(Failure::input(unreadable.join("\n")));
    }
    let errors = results
        .iter()
        .flat_map(|(_, result)| result)
        .any(|report| report.count(Severity::Error) > 0);
    Ok(if errors { Verdict::Fail } else { Verdict::Pass })
}

/// Checks one file; `loaded`: with the library loaded, and with a first step or without.
fn one(file: &Path, loaded: Option<bool>, options: &OpenOptions) -> Result<Report, ArchiveError> {
    let mut checked = check(file)?;
    if let Some(with_step) = loaded.filter(|_| checked.can_be_loaded()) {
        load(&mut checked, options, with_step);
    }
    Ok(checked.report())
}

/// Collects all reports, and the number of their findings.
fn json(results: &[(&PathBuf, Result<Report, ArchiveError>)]) -> serde_json::Value {
    let count = |severity| -> usize {
        results.iter().flat_map(|(_, result)| result).map(|report| report.count(severity)).sum()
    };
    let files: Vec<serde_json::Value> = results
        .iter()
        .map(|(file, result)| match result {
            Ok(report) => serde_json::json!(report),
            Err(error) => serde_json::json!({
                "file": file.display().to_string(),
                "unreadable": error.to_string(),
            }),
        })
        .collect();
    serde_json::json!({
        "files": files,
        "errors": count(Severity::Error),
        "warnings": count(Severity::Warning),
        "notes": count(Severity::Note),
    })
}
