//! `octant faults minimise`: finds the smallest set of a run's faults with which it still fails.

use super::progress::with_progress;
use crate::failure::Failure;
use crate::terminal::{print, print_json, write};
use clap::Args;
use octant_base::control::Control;
use octant_run::Ended;
use octant_run::Plan;
use octant_run::minimise::{SearchStep, SetOutcome, minimise};
use octant_run::stem::Stem;
use octant_run::{MethodRun, StreamKeeping, assemble, run_method};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Method, Scenario};
use octant_score::summary::Summary;
use octant_verdict::Verdict;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of the failed run: its scenario.toml and summary.json are read.
    #[arg(value_name = "RUN")]
    run: PathBuf,
    /// Id of the requirement that must fail; by default the first one that the run failed, or,
    /// without a failed requirement, the refusal of the calibration.
    #[arg(long, value_name = "ID")]
    requirement: Option<String>,
    /// Folder for minimised.toml and minimise.json; by default RUN itself.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print minimise.json on stdout, and nothing else.
    #[arg(long)]
    json: bool,
}

/// Failure that a set of faults must reproduce.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Broken {
    /// The requirement of this id fails.
    Requirement(String),
    /// The core refuses its calibration.
    Refused,
}

impl Broken {
    fn holds(&self, summary: &Summary) -> bool {
        match self {
            Self::Requirement(id) => {
                summary.requirements.iter().any(|r| r.id == *id && r.verdict == Verdict::Fail)
            }
            Self::Refused => summary.calibration.as_ref().is_some_and(|c| c.refused.is_some()),
        }
    }

    fn words(&self) -> String {
        match self {
            Self::Requirement(id) => format!("requirement {id} fails"),
            Self::Refused => "the calibration is refused".to_owned(),
        }
    }
}

/// Content of `minimise.json`.
#[derive(Debug, Serialize)]
struct Minimised {
    schema: u32,
    octant: &'static str,
    scenario: String,
    seed: u64,
    /// Failure to reproduce.
    broken: String,
    /// Ids of all faults of the scenario.
    faults: Vec<String>,
    /// Ids of the smallest set.
    minimal: Vec<String>,
    /// Every set that was tried, by numbers into `faults`, in order.
    trail: Vec<SearchStep>,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments { run: stored, requirement, out, json } = arguments;
    let path = stored.join("scenario.toml");
    let scenario = Scenario::load(&path, &[]).map_err(Failure::input)?;
    let summary = summary_of(stored)?;
    let ids: Vec<String> = scenario.faults.iter().map(|f| f.spec.id.clone()).collect();
    if ids.is_empty() {
        return Err(Failure::input(format!(
            "failed to minimise {}: its scenario has no faults",
            stored.display()
        )));
    }
    let broken = what_broke(stored, requirement.as_deref(), &summary)?;
    let seed = summary.seed;
    // At most two to the power of the number of faults can be tried; delta debugging needs far
    // fewer.
    let control = Control::default();
    let draws = DrawnValues::of(&scenario, &Seeded(seed));
    let sample_s = scenario.sample_period_ns as f64 * 1e-9;
    let (minimal, trail) = with_progress(std::slice::from_ref(&control), None, sample_s, || {
        let twins = twins(&scenario, seed, &control)?;
        let stems = stems(&scenario, seed, &control)?;
        let known = Known { twins, stems, broken: &broken };
        minimise(ids.len(), |set| outcome(&scenario, seed, set, &known, &control))
    })?;
    let Some(minimal) = minimal else {
        let whole = trail.first().is_some_and(|step| step.outcome == SetOutcome::Breaks);
        return Err(Failure::input(format!(
            "failed to minimise {}: {} {}",
            stored.display(),
            broken.words(),
            if whole {
                "without any fault too: no fault is the cause"
            } else {
                "in the stored run, and not when it runs again"
            }
        )));
    };
    let result = Minimised {
        schema: 1,
        octant: env!("CARGO_PKG_VERSION"),
        scenario: scenario.title.clone(),
        seed,
        broken: broken.words(),
        minimal: minimal.iter().map(|i| ids[*i].clone()).collect(),
        faults: ids,
        trail,
    };
    let folder = out.as_deref().unwrap_or(stored);
    let smallest = scenario.with_faults(|i| minimal.contains(&i));
    write_results(folder, &smallest.to_resolved_toml(seed, &draws), &result)?;
    if *json {
        print_json(&result)?
    } else {
        print(&text(&result, folder))?
    }
    Ok(Verdict::Pass)
}

/// Runs the twins without faults, with which requirements on the effects of faults are compared.
fn twins(
    scenario: &Scenario,
    seed: u64,
    control: &Control,
) -> Result<Vec<Arc<MethodRun>>, Failure> {
    let clean = scenario.without_faults();
    scenario
        .methods()
        .map(|method| Ok(Arc::new(run(&clean, method, seed, StreamKeeping::Hash, control)?)))
        .collect()
}

/// Runs up to the first fault, which all sets have in common; `None` where a run can't be divided.
fn stems(scenario: &Scenario, seed: u64, control: &Control) -> Result<Vec<Option<Stem>>, Failure> {
    let plan = |method| Plan::of(scenario, method, seed, StreamKeeping::None, control);
    scenario.methods().map(|method| Ok(Stem::of(&plan(method))?)).collect()
}

/// Results that the runs of all sets need.
struct Known<'a> {
    twins: Vec<Arc<MethodRun>>,
    stems: Vec<Option<Stem>>,
    broken: &'a Broken,
}

fn run(
    scenario: &Scenario,
    method: Method,
    seed: u64,
    recording: StreamKeeping<'_>,
    control: &Control,
) -> Result<MethodRun, Failure> {
    uncancelled(run_method(scenario, method, seed, recording, control)?)
}

fn uncancelled(run: MethodRun) -> Result<MethodRun, Failure> {
    if run.ended == Ended::Cancelled {
        return Err(Failure {
            status: Verdict::Inconclusive.exit_code(),
            message: "failed to minimise: interrupted".to_owned(),
        });
    }
    Ok(run)
}

/// Runs a set of faults.
fn outcome(
    scenario: &Scenario,
    seed: u64,
    set: &[usize],
    known: &Known<'_>,
    control: &Control,
) -> Result<SetOutcome, Failure> {
    let some = scenario.with_faults(|i| set.contains(&i));
    if some.station(seed).is_err() {
        return Ok(SetOutcome::Impossible);
    }
    let mut runs = Vec::with_capacity(known.twins.len());
    for ((method, twin), stem) in scenario.methods().zip(&known.twins).zip(&known.stems) {
        let plan = Plan::of(&some, method, seed, StreamKeeping::None, control);
        let mut run = match stem {
            Some(stem) if !set.is_empty() => uncancelled(stem.run(&plan, |i| set.contains(&i))?)?,
            _ => run(&some, method, seed, StreamKeeping::None, control)?,
        };
        run.twin = (!set.is_empty()).then(|| Arc::clone(twin));
        runs.push(run);
    }
    let mut runs = runs.into_iter();
    let Some(primary) = runs.next() else { return Ok(SetOutcome::Impossible) };
    let run = assemble(&some, seed, primary, runs.next())
        .map_err(|error| Failure::bench(format!("failed to judge a set of faults: {error}")))?;
    Ok(if known.broken.holds(&run.summary) { SetOutcome::Breaks } else { SetOutcome::Holds })
}

fn summary_of(run: &Path) -> Result<Summary, Failure> {
    let summary =
        octant_evidence::ended::summary(run).map_err(|error| Failure::input(error).failed())?;
    summary.ok_or_else(|| {
        Failure::input(format!(
            "found no manifest.json in {}, expected the folder of a run that has ended",
            run.display()
        ))
    })
}

fn what_broke(run: &Path, requirement: Option<&str>, summary: &Summary) -> Result<Broken, Failure> {
    let run = run.display();
    if let Some(id) = requirement {
        let broken = Broken::Requirement(id.to_owned());
        return match summary.requirements.iter().find(|r| r.id == id) {
            Some(_) if broken.holds(summary) => Ok(broken),
            Some(found) => Err(Failure::input(format!(
                "failed to minimise {run}: found requirement {id} with the verdict {}, expected fail",
                found.verdict.name()
            ))),
            None => Err(Failure::input(format!(
                "failed to minimise {run}: unknown requirement {id:?}, {}",
                octant_base::names::suggestion(
                    id,
                    summary.requirements.iter().map(|r| r.id.as_str()),
                    "requirements"
                )
            ))),
        };
    }
    let failed = summary.requirements.iter().find(|r| r.verdict == Verdict::Fail);
    match failed {
        Some(requirement) => Ok(Broken::Requirement(requirement.id.clone())),
        None if Broken::Refused.holds(summary) => Ok(Broken::Refused),
        None => Err(Failure::input(format!(
            "failed to minimise {run}: found the verdict {}, expected a failed requirement or a \
             refused calibration",
            summary.verdict.name()
        ))),
    }
}

fn write_results(folder: &Path, smallest: &str, result: &Minimised) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| {
        Failure::bench(format!("failed to create {}: {error}", folder.display()))
    })?;
    write(&folder.join("minimised.toml"), smallest)?;
    let json = serde_json::to_string_pretty(result)
        .map_err(|error| Failure::bench(format!("failed to write minimise.json: {error}")))?;
    write(&folder.join("minimise.json"), json + "\n")
}

fn text(result: &Minimised, folder: &Path) -> String {
    let mut out = format!("{}: {}\n", result.scenario, result.broken);
    for step in &result.trail {
        let ids: Vec<&str> = step.faults.iter().map(|i| result.faults[*i].as_str()).collect();
        let set = if ids.is_empty() { "no fault".to_owned() } else { ids.join(", ") };
        let came = match step.outcome {
            SetOutcome::Breaks => "breaks",
            SetOutcome::Holds => "holds",
            SetOutcome::Impossible => "can't be run: a fault waits for one that is not in the set",
        };
        out += &format!("  {came}: {set}\n");
    }
    out += &format!(
        "smallest set: {}\n{}\n",
        result.minimal.join(", "),
        folder.join("minimised.toml").display()
    );
    out
}
