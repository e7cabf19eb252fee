//! One run, and what it says.

use octant_base::control::Control;
use octant_run::Ended;
use octant_run::assemble::assemble;
use octant_run::many::judge_many;
use octant_run::{MethodRun, StreamKeeping, run_method};
use octant_sample::Health;
use octant_scenario::{Method, Scenario};
use octant_score::health::name;
use octant_score::judge::unfired;
use octant_score::summary::Summary;
use octant_verdict::Verdict;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// The part of a run that an estimate is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RareSubject {
    /// A requirement, by its id.
    Requirement(String),
    /// The published parameters of the calibration.
    Calibration,
}

/// Result of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RareOutcome {
    /// The requirement was judged: the margin to its limit, negative beyond it, and whether it is kept.
    Judged(f64, bool),
    /// A calibration was published, and nothing was reported: error and σ of each estimated parameter.
    Published(BTreeMap<String, [f64; 2]>),
    /// A calibration was published, and the core had reported something.
    Noticed(String),
    /// The core refused its calibration; the reason.
    Refused(String),
    /// The run came to its end without the measure; the reason.
    Unpublished(String),
    /// The run didn't come to its end, or its measure isn't a number; the reason.
    Broken(String),
}

/// Runs a scenario; `None` if the end was asked for.
#[must_use]
pub fn outcome(
    scenario: &Scenario,
    subject: &RareSubject,
    control: &Control,
) -> Option<RareOutcome> {
    match subject {
        RareSubject::Requirement(id) => of_requirement(scenario, id, control),
        RareSubject::Calibration => of_calibration(scenario, control),
    }
}

fn of_calibration(scenario: &Scenario, control: &Control) -> Option<RareOutcome> {
    let run =
        run_method(scenario, Method::Primary, scenario.seed, StreamKeeping::HashAlone, control);
    let run = match run {
        Ok(run) if run.ended == Ended::Cancelled => return None,
        Ok(run) => run,
        Err(error) => return Some(RareOutcome::Broken(error.to_string())),
    };
    Some(published(&run))
}

fn published(run: &MethodRun) -> RareOutcome {
    if let Some(reason) = broken(run) {
        return RareOutcome::Broken(reason);
    }
    let Some(score) = &run.calibration else {
        return RareOutcome::Unpublished("no calibration was published".to_owned());
    };
    if let Some(reason) = &score.refused {
        return RareOutcome::Refused(reason.clone());
    }
    // A measurement beyond the gate now and then is routine.
    let mut reports = run.observed.measurements.health.episodes().iter();
    if let Some(report) = reports.find(|report| report.cause != Health::INNOVATION_REJECTED) {
        return RareOutcome::Noticed(name(report.cause).to_owned());
    }
    let mut parameters = BTreeMap::new();
    for (name, parameter) in &score.parameters {
        let Some(sigma) = parameter.sigma else { continue };
        match parameter.error {
            Some(error) if error.is_finite() && sigma.is_finite() => {
                parameters.insert(name.clone(), [error, sigma]);
            }
            _ => return RareOutcome::Broken(format!("the error of {name} is not a number")),
        }
    }
    RareOutcome::Published(parameters)
}

/// A run whose faults don't all act shows nothing of the hypothesis.
fn broken(run: &MethodRun) -> Option<String> {
    let cut = run.bench.cut_short.as_ref().map(|cut| format!("the run ended early: {cut}"));
    let failed = run.bench.broken.as_ref().map(ToString::to_string);
    let misbehaved = matches!(run.ended, Ended::Misbehaved | Ended::Broken)
        .then(|| "the unit misbehaved, or the bench failed".to_owned());
    let unfired = run.receipts.iter().find(|receipt| !receipt.fired());
    let unfired = unfired.map(|receipt| format!("fault {} never fired", receipt.id));
    failed.or(cut).or(misbehaved).or(unfired)
}

fn of_requirement(scenario: &Scenario, id: &str, control: &Control) -> Option<RareOutcome> {
    if !scenario.faults.is_empty() {
        let told = Mutex::new(None);
        judge_many(std::slice::from_ref(scenario), 1, control, &|_, run| {
            let outcome = match run {
                Ok(run) => judged(&run.summary, id, None),
                Err(error) => RareOutcome::Broken(error.to_string()),
            };
            if let Ok(mut told) = told.lock() {
                *told = Some(outcome);
            }
        });
        let is_cancelled = control.cancel.load(std::sync::atomic::Ordering::Relaxed);
        let told = told.into_inner().ok().flatten().filter(|_| !is_cancelled);
        let silent = || RareOutcome::Broken("the run gave no result".to_owned());
        return if is_cancelled { None } else { Some(told.unwrap_or_else(silent)) };
    }
    let run =
        |method| run_method(scenario, method, scenario.seed, StreamKeeping::HashAlone, control);
    let primary = match run(Method::Primary) {
        Ok(run) if run.ended == Ended::Cancelled => return None,
        Ok(run) => run,
        Err(error) => return Some(RareOutcome::Broken(error.to_string())),
    };
    let baseline = match scenario.baseline.as_ref().map(|_| run(Method::Baseline)) {
        Some(Ok(run)) if run.ended == Ended::Cancelled => return None,
        Some(Err(error)) => return Some(RareOutcome::Broken(error.to_string())),
        Some(Ok(run)) => Some(run),
        None => None,
    };
    let cut = broken(&primary).or_else(|| baseline.as_ref().and_then(broken));
    Some(match assemble(scenario, scenario.seed, primary, baseline) {
        Ok(run) => judged(&run.summary, id, cut),
        Err(error) => RareOutcome::Broken(error.to_string()),
    })
}

fn judged(summary: &Summary, id: &str, cut: Option<String>) -> RareOutcome {
    if let Some(reason) = cut {
        return RareOutcome::Broken(reason);
    }
    if let Some((_, never)) = unfired(summary).next() {
        return RareOutcome::Broken(never);
    }
    let of_baseline = summary.baseline.as_ref().and_then(|baseline| baseline.calibration.as_ref());
    let scores = [summary.calibration.as_ref(), of_baseline];
    if let Some(reason) = scores.iter().flatten().find_map(|score| score.refused.clone()) {
        return RareOutcome::Refused(reason);
    }
    let Some(result) = summary.requirements.iter().find(|result| result.id == id) else {
        return RareOutcome::Unpublished(format!("the run has no result of {id}"));
    };
    let reason = || result.reason.clone().unwrap_or_else(|| "it was not judged".to_owned());
    let Some(value) = result.value else { return RareOutcome::Unpublished(reason()) };
    let margin = result.comparison.margin(value, result.limit);
    match result.verdict {
        Verdict::Pass | Verdict::Fail if margin.is_finite() => {
            RareOutcome::Judged(margin, result.verdict == Verdict::Pass)
        }
        Verdict::Pass | Verdict::Fail => {
            RareOutcome::Broken("the measure is not a number".to_owned())
        }
        _ => RareOutcome::Broken(format!("the run doesn't decide the requirement: {}", reason())),
    }
}
