//! `octant faults sweep`: a grid of one fault on all processors, and its heat map.

use super::progress::with_progress;
use crate::arguments::{ScenarioArguments, load};
use crate::failure::Failure;
use crate::terminal::{print, print_json, write};
use clap::Args;
use octant_base::control::Control;
use octant_campaign::sweep::{SweepAxis, SweepError, cells_of, indices, sweep};
use octant_campaign_pages::sweep as sweep_page;
use octant_evidence::manifest::shell_path;
use octant_scenario::Scenario;
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};

/// Maximum number of cells of a grid: each is a run.
const CELLS_MAX: usize = 100_000;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Key of the fault and its values, separated by commas, or by semicolons where a value contains
    /// commas: amplitude="1 deg/h, 10 deg/h". The first two keys span the map; every further key adds
    /// a map for each of its values.
    #[arg(long, value_name = "KEY=VALUES", required = true)]
    over: Vec<String>,
    /// Id of the fault; needed only if the scenario has several.
    #[arg(long, value_name = "ID")]
    fault: Option<String>,
    /// Seed of all runs, instead of the scenario's.
    #[arg(long, value_name = "N", value_parser = crate::arguments::seed, allow_negative_numbers = true)]
    seed: Option<u64>,
    /// Number of parallel runs; by default the number of processors.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Folder for sweep.json, sweep.csv, sweep.svg and sweep.html; by default nothing is written.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print sweep.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { scenario: of_scenario, over, fault, seed, jobs, out, json } = arguments;
    let base = load(of_scenario, &[])?;
    let fault = the_fault(&base, &of_scenario.scenario, fault.as_deref())?;
    let axes = over.iter().map(|text| axis(text)).collect::<Result<Vec<_>, _>>()?;
    let count = cells_of(&axes);
    if count > CELLS_MAX {
        return Err(Failure::input(format!(
            "failed to sweep: found a grid of {count} cells, expected at most {CELLS_MAX}"
        )));
    }
    // Every cell is checked before any is run.
    let scenarios = (0..count)
        .map(|cell| {
            let sets: Vec<String> = axes
                .iter()
                .zip(indices(&axes, cell))
                .map(|(axis, i)| format!("faults.{fault}.{}={}", axis.key, axis.values[i]))
                .collect();
            load(of_scenario, &sets)
        })
        .collect::<Result<Vec<_>, _>>()?;
    let seed = seed.unwrap_or(base.seed);
    let controls: Vec<Control> = (0..=count).map(|_| Control::default()).collect();
    let epochs = base.samples().map(|samples| samples * (count as u64 + 1));
    let sample_s = base.sample_period_ns as f64 * 1e-9;
    let result = with_progress(&controls, epochs, sample_s, || {
        sweep(&scenarios, &axes, &fault, seed, jobs.map(usize::from), &controls)
    })
    .map_err(failure)?;
    if let Some(folder) = out {
        std::fs::create_dir_all(folder).map_err(|error| {
            Failure::bench(format!("failed to create {}: {error}", folder.display()))
        })?;
        let json = serde_json::to_string_pretty(&result)
            .map_err(|error| Failure::bench(format!("failed to write sweep.json: {error}")))?;
        write(&folder.join("sweep.json"), json + "\n")?;
        write(&folder.join("sweep.csv"), sweep_page::csv(&result))?;
        write(&folder.join("sweep.svg"), sweep_page::figure(&result))?;
        write(&folder.join("sweep.html"), sweep_page::render(&result, &rerun(arguments, seed)))?;
    }
    if *json {
        print_json(&result)?;
    } else {
        print(&sweep_page::text(&result))?;
    }
    Ok(Verdict::Pass)
}

fn failure(error: SweepError) -> Failure {
    let failure = Failure::of(&error);
    // The words of a method stand alone.
    if matches!(error, SweepError::Method(_)) { failure } else { failure.failed() }
}

/// Returns the id of the fault that is swept.
fn the_fault(scenario: &Scenario, file: &Path, given: Option<&str>) -> Result<String, Failure> {
    let ids: Vec<&str> = scenario.faults.iter().map(|fault| fault.spec.id.as_str()).collect();
    let file = file.display();
    match (given, ids.as_slice()) {
        (_, []) => Err(Failure::input(format!(
            "failed to sweep {file}: found no [[faults]], expected one or more"
        ))),
        (None, [one]) => Ok((*one).to_owned()),
        (None, _) => Err(Failure::input(format!(
            "failed to sweep {file}: found several faults ({}), expected one of them with --fault",
            ids.join(", ")
        ))),
        (Some(id), _) if ids.contains(&id) => Ok(id.to_owned()),
        (Some(id), _) => Err(Failure::input(format!(
            "failed to sweep {file}: unknown fault {id:?}, {}",
            octant_base::names::suggestion(id, ids.iter().copied(), "faults")
        ))),
    }
}

/// Parses `KEY=V1,V2,...`.
fn axis(text: &str) -> Result<SweepAxis, Failure> {
    let wrong = || {
        Failure::input(format!(
            "failed to read --over {text:?}: expected KEY=VALUE,VALUE,... such as \
             amplitude=\"1 deg/h, 10 deg/h\""
        ))
    };
    let (key, values) = text.split_once('=').ok_or_else(wrong)?;
    let separator = if values.contains(';') { ';' } else { ',' };
    let values: Vec<String> =
        values.split(separator).map(|value| value.trim().to_owned()).collect();
    if key.trim().is_empty() || values.iter().any(String::is_empty) {
        return Err(wrong());
    }
    Ok(SweepAxis { key: key.trim().to_owned(), values })
}

/// Returns the command line that makes the sweep again.
fn rerun(arguments: &Arguments, used_seed: u64) -> String {
    // Where the results go makes no other sweep, nor do the parallel runs.
    let Arguments { scenario, over, fault, seed: _, jobs: _, out: _, json: _ } = arguments;
    let ScenarioArguments { scenario, set } = scenario;
    let mut line = format!("octant faults sweep {}", shell_path(scenario));
    for set in set {
        line += &format!(" --set '{set}'");
    }
    if let Some(fault) = fault {
        line += &format!(" --fault {fault}");
    }
    for over in over {
        line += &format!(" --over '{over}'");
    }
    line + &format!(" --seed {used_seed}")
}
