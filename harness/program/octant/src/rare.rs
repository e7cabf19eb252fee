//! `octant rare`: the probability that a requirement fails, and protection levels.

use super::case_progress::CaseBar;
use super::progress::interruptible;
use crate::arguments::{ScenarioArguments, load};
use crate::failure::Failure;
use crate::terminal::{print, print_json, write};
use clap::Args;
use octant_base::control::Control;
use octant_base::failing::Failing;
use octant_base::pool::processors;
use octant_evidence::manifest::shell_path;
use octant_rare::estimators::estimate::RarePlan;
use octant_rare::runs::error::RareError;
use octant_rare::runs::failure::{failure, requirement};
use octant_rare::runs::journal::{RARE_JOURNAL_SCHEMA, RareIdentity};
use octant_rare::runs::many::{RareRuns, SeverityOf};
use octant_rare::runs::outcome::RareSubject;
use octant_rare::runs::protection::{RISK, parameters, protection};
use octant_scenario::Scenario;
use octant_score::numerics::NUMERICS;
use octant_verdict::Verdict;
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    scenario: ScenarioArguments,
    /// Id of the requirement; by default the only one.
    #[arg(long, value_name = "ID", conflicts_with = "protection")]
    requirement: Option<String>,
    /// Probability to be shown: the exit status is 0 if the interval is at or below it, 1 if it is above, else 3.
    #[arg(long, value_name = "P", value_parser = probability, conflicts_with = "protection")]
    below: Option<f64>,
    /// Count runs that refuse their calibration, or end without the measure, as failures.
    #[arg(long, conflicts_with = "protection")]
    count_refused: bool,
    #[arg(long, value_name = "RISK", value_parser = probability, num_args = 0..=1, default_missing_value = RISK, help = format!(
        "Find the error of each published parameter that is exceeded unnoticed with this probability; by default {RISK}"
    ))]
    protection: Option<f64>,
    /// Parameters of --protection, separated by commas; by default all that are estimated.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "protection")]
    parameters: Vec<String>,
    /// Runs at most; of --protection for each parameter.
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u32).range(100..=10_000_000))]
    runs: u32,
    /// Standard error, as a share of the probability, at which it is enough.
    #[arg(long, value_name = "SHARE", default_value_t = 0.05, value_parser = share)]
    error: f64,
    /// Confidence of the interval, two-sided.
    #[arg(long, value_name = "SHARE", default_value_t = 0.95, value_parser = confidence)]
    confidence: f64,
    /// Seed of the estimate.
    #[arg(long, value_name = "N", default_value = "1", value_parser = crate::arguments::seed, allow_negative_numbers = true)]
    seed: u64,
    /// Number of parallel runs; by default the number of processors.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    jobs: Option<u16>,
    /// Folder for rare.json, failing.toml and the journal with which an interrupted estimate goes on; by default
    /// nothing is written.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print rare.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
}

fn probability(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|p| *p > 0.0 && *p < 1.0);
    number.ok_or_else(|| "expected a probability above 0 and below 1, such as 1e-6".to_owned())
}

fn share(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|share| *share > 0.0 && *share < 1.0);
    number.ok_or_else(|| "expected a number above 0 and below 1".to_owned())
}

/// A lower confidence would answer anything.
fn confidence(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|share| (0.5..1.0).contains(share));
    number.ok_or_else(|| "expected a number from 0.5 to below 1".to_owned())
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let scenario = load(&arguments.scenario, &[])?;
    interruptible(|control| estimated(arguments, &scenario, control))
}

fn estimated(
    arguments: &Arguments,
    scenario: &Scenario,
    control: &Control,
) -> Result<Verdict, Failure> {
    let Arguments {
        // The caller has read it.
        scenario: _,
        requirement: id,
        below,
        count_refused,
        protection: risk,
        parameters: names,
        runs,
        error,
        confidence,
        seed,
        jobs,
        out,
        json,
    } = arguments;
    let plan = RarePlan {
        error: *error,
        confidence: *confidence,
        seed: *seed,
        ..RarePlan::of_runs(*runs as usize)
    };
    let jobs = jobs.map_or_else(processors, usize::from);
    let names = parameters(names).map_err(of_error)?;
    let of = match risk {
        None => Some(requirement(scenario, id.as_deref()).map_err(of_error)?),
        Some(_) => None,
    };
    let subject = match of {
        Some(of) => RareSubject::Requirement(of.check.id.clone()),
        None => RareSubject::Calibration,
    };
    let severity = SeverityOf::Margin(*count_refused);
    let total = plan.runs * if of.is_some() { 1 } else { names.len() };
    let bar = CaseBar::new("rare", total, jobs, true);
    let tell = || bar.ended(None, false);
    let mut runs = RareRuns::new(scenario, subject.clone(), severity, jobs, control, &tell)
        .map_err(of_error)?;
    if let Some(folder) = out {
        std::fs::create_dir_all(folder).map_err(|error| {
            Failure::bench(format!("failed to create {}: {error}", folder.display()))
        })?;
        let identity = identity(scenario, &subject, &plan)?;
        runs.resume(&folder.join("rare.jsonl"), &identity).map_err(of_error)?;
    }
    let name = |_: usize| String::new();
    match (of, *risk) {
        (Some(of), _) => {
            let asked = (*below, *count_refused);
            let work = || failure(&mut runs, scenario, of, &plan, asked);
            let (found, failing) = bar.during(&name, work).map_err(of_error)?;
            tell_result((out.as_deref(), *json), &found, &found.text())?;
            let (Some(folder), Some(text), Some(run)) = (out, failing, &found.most_probable) else {
                return Ok(found.verdict);
            };
            let file = folder.join("failing.toml");
            let seed = run.seed;
            write(&file, text)?;
            if !json {
                print(&format!("octant run {} --seed {seed}\n", shell_path(&file)))?;
            }
            Ok(found.verdict)
        }
        (None, risk) => {
            let risk = risk.map_or_else(|| probability(RISK), Ok).map_err(Failure::input)?;
            let work = || protection(&mut runs, scenario, &names, risk, &plan);
            let found = bar.during(&name, work).map_err(of_error)?;
            tell_result((out.as_deref(), *json), &found, &found.text())?;
            Ok(found.verdict)
        }
    }
}

fn tell_result(
    (out, json): (Option<&Path>, bool),
    found: &impl Serialize,
    text: &str,
) -> Result<(), Failure> {
    if let Some(folder) = out {
        let text = serde_json::to_string_pretty(found)
            .map_err(|error| Failure::bench(format!("failed to write rare.json: {error}")))?;
        write(&folder.join("rare.json"), text + "\n")?;
    }
    if json { print_json(found) } else { print(text) }
}

fn identity(
    scenario: &Scenario,
    subject: &RareSubject,
    plan: &RarePlan,
) -> Result<RareIdentity, Failure> {
    let text = scenario.to_toml_with(&[], &[]).map_err(|problem| {
        Failure::input(format!("failed to write the scenario: {}", problem.message))
    })?;
    Ok(RareIdentity {
        schema: RARE_JOURNAL_SCHEMA,
        octant: env!("CARGO_PKG_VERSION").to_owned(),
        numerics: NUMERICS,
        scenario_blake3: blake3::hash(text.as_bytes()).to_hex().to_string(),
        subject: match subject {
            RareSubject::Requirement(id) => format!("requirement {id}"),
            RareSubject::Calibration => "calibration".to_owned(),
        },
        plan: format!("seed {}", plan.seed),
    })
}

fn of_error(error: RareError) -> Failure {
    Failure::of_kind(error.kind(), format!("failed to estimate: {error}"))
}
