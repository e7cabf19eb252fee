//! `octant fmu run --source`: a core in an FMU, with the samples of a scenario's source.

use super::super::progress::with_progress;
use super::arguments::{Interface, OpeningArguments, Process, SharedRunOptions, in_the_way};
use crate::failure::Failure;
use crate::terminal::{print, print_json, tell_account};
use octant_account::Account;
use octant_base::control::Control;
use octant_base::number::counted;
use octant_run::run_as_far_as_it_goes;
use octant_run::{Ended, StreamKeeping};
use octant_scenario::{Method, Scenario, setting_argument};
use octant_verdict::Verdict;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Summary of a run.
#[derive(Serialize)]
struct RunSummary {
    fmu: String,
    scenario: String,
    samples: u64,
    ended: &'static str,
    refused: Option<String>,
    nis_mean: Option<f64>,
    stream_hash: String,
    wall_s: f64,
    out: Option<PathBuf>,
    /// Accounts of what the source read.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    inputs: Vec<Account>,
}

/// Runs the command.
pub(super) fn command(kept: &SharedRunOptions<'_>, scenario: &Path) -> Result<Verdict, Failure> {
    let SharedRunOptions { fmu, set, opening, out, force, json } = *kept;
    let recording = match out {
        Some(path) if path.extension().is_none_or(|extension| extension != "mcap") => {
            return Err(Failure::input(format!(
                "failed to write {}: with --source the output is a recording, expected a name that \
                 ends in .mcap",
                path.display()
            )));
        }
        Some(path) => {
            in_the_way(out, force)?;
            if path.exists() {
                std::fs::remove_file(path).map_err(|error| {
                    Failure::input(format!("failed to replace {}: {error}", path.display()))
                })?;
            }
            StreamKeeping::File(path)
        }
        None => StreamKeeping::Hash,
    };
    let scenario =
        Scenario::load(scenario, &overrides(fmu, set, opening)?).map_err(Failure::input)?;
    let control = Control::default();
    let sample_s = scenario.sample_period_ns as f64 * 1e-9;
    let one = std::slice::from_ref(&control);
    let (run, wall_s) = with_progress(one, scenario.samples(), sample_s, || {
        let (method, seed) = (Method::Primary, scenario.seed);
        let began = Instant::now();
        let run = run_as_far_as_it_goes(&scenario, method, seed, recording, &control);
        (run, began.elapsed().as_secs_f64())
    });
    let run = run.map_err(|error| Failure::from(error).failed())?;
    let refused = run.calibration.as_ref().and_then(|calibration| calibration.refused.clone());
    let summary = RunSummary {
        fmu: fmu.display().to_string(),
        scenario: scenario.title.clone(),
        samples: run.recorder.epochs,
        ended: match run.ended {
            Ended::Done => "done",
            Ended::Refused => "refused",
            Ended::SourceEnded => "source ended",
            Ended::Cancelled => "interrupted",
            Ended::Lost => "bench lost",
            Ended::Misbehaved => "answered what no core may",
            Ended::Broken => "broken",
        },
        refused,
        nis_mean: run.calibration.as_ref().and_then(|calibration| calibration.nis_mean),
        stream_hash: run.recorder.stream_hash.clone(),
        wall_s,
        out: out.map(Path::to_owned),
        inputs: run.bench.accounts(),
    };
    summary.inputs.iter().for_each(tell_account);
    if json {
        print_json(&summary)?;
    } else {
        print(&text(&summary))?;
    }
    if let Some(error) = run.bench.broken {
        return Err(Failure::bench(format!("failed to run {}: {error}", summary.fmu)));
    }
    Ok(match run.ended {
        Ended::Refused | Ended::Misbehaved => Verdict::Fail,
        Ended::Cancelled | Ended::Lost => Verdict::Inconclusive,
        _ if summary.inputs.iter().any(|input| !input.doubts().is_empty()) => Verdict::Inconclusive,
        _ => Verdict::Pass,
    })
}

/// Returns the settings that make the FMU the scenario's endpoint.
fn overrides(
    fmu: &Path,
    set: &[String],
    opening: &OpeningArguments,
) -> Result<Vec<String>, Failure> {
    let OpeningArguments { interface, process, allow_tool, time_limit } = opening;
    let file = std::path::absolute(fmu)
        .map_err(|error| Failure::input(format!("failed to find {}: {error}", fmu.display())))?;
    let mut all = vec![format!("endpoint.uri=fmu:{}", file.display())];
    match process {
        Process::Own => {
            all.push("endpoint.fmu.process=own".to_owned());
            if let Some(limit) = time_limit {
                all.push(format!("endpoint.fmu.time_limit={limit}"));
            }
        }
        // The caller has refused a limit.
        Process::Shared => all.push("endpoint.fmu.process=shared".to_owned()),
    }
    if *allow_tool {
        all.push("endpoint.fmu.allow_tool=true".to_owned());
    }
    match interface {
        // The caller has refused scheduled execution.
        None | Some(Interface::ScheduledExecution) => {}
        Some(Interface::CoSimulation) => {
            all.push("endpoint.fmu.interface=co-simulation".to_owned());
        }
        Some(Interface::ModelExchange) => {
            all.push("endpoint.fmu.interface=model-exchange".to_owned());
        }
    }
    for argument in set {
        setting_argument(argument)
            .map_err(|problem| Failure::input(format!("--set {argument}: {}", problem.message)))?;
        all.push(format!("endpoint.fmu.parameters.{argument}"));
    }
    Ok(all)
}

fn text(summary: &RunSummary) -> String {
    let mut text = format!(
        "{} as the core of {}: {}, {}",
        summary.fmu,
        summary.scenario,
        counted(summary.samples, "sample", "samples"),
        summary.ended
    );
    if let Some(reason) = &summary.refused {
        text += &format!(" ({reason})");
    }
    if summary.samples > 0 {
        text += &format!(", {:.3} µs per sample", 1e6 * summary.wall_s / summary.samples as f64);
    }
    if let Some(nis) = summary.nis_mean {
        text += &format!("\nNIS {nis:.3}");
    }
    text += &format!("\nstream hash {}\n", summary.stream_hash);
    if let Some(out) = &summary.out {
        text += &format!("{}\n", out.display());
    }
    text
}
