//! Many scenarios, each with its twin, judged: what they have in common at their beginning runs once.

use super::branches::{first_alike, run_branches};
use crate::bench::error::MethodError;
use crate::bench::plan::Plan;
use crate::bench::recording::StreamKeeping;
use crate::results::assemble::{Run, assemble};
use crate::results::method::MethodRun;
use octant_base::control::Control;
use octant_scenario::{Method, Scenario};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Reasons why a scenario has no verdict.
#[derive(Debug, thiserror::Error)]
pub enum ManyError {
    /// A method gave no result.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// A twin gave no result; its own words.
    #[error("run without the faults: {0}")]
    Twin(String),
    /// The summary can't be written.
    #[error("write the summary: {0}")]
    Json(#[from] serde_json::Error),
}

type Slots<T> = Mutex<Vec<Option<T>>>;

fn slots<T>(count: usize) -> Slots<T> {
    Mutex::new((0..count).map(|_| None).collect())
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs scenarios with their own seeds, and the runs without their faults; `jobs` at a time. Each is judged as
/// `octant run` does, and told in any order. No file is written.
pub fn judge_many(
    scenarios: &[Scenario],
    jobs: usize,
    control: &Control,
    told: &(dyn Fn(usize, Result<Run, ManyError>) + Sync),
) {
    let clean: Vec<Scenario> = scenarios.iter().map(Scenario::without_faults).collect();
    let runs: Vec<(usize, Method)> = (scenarios.iter().enumerate())
        .flat_map(|(index, scenario)| scenario.methods().map(move |method| (index, method)))
        .collect();
    // Twins first: a run is compared with its own as soon as it ends, and only the verdict is kept.
    let twin_plans = plans(&clean, &runs, control);
    let first = first_alike(&twin_plans);
    let needed = |place: usize| {
        let same = first.iter().zip(&runs).filter(|(first, _)| **first == place);
        same.map(|(_, (index, _))| *index).any(|index| !scenarios[index].faults.is_empty())
    };
    let places: Vec<usize> = (0..runs.len()).filter(|place| needed(*place)).collect();
    let these: Vec<Plan<'_>> = places.iter().map(|place| twin_plans[*place]).collect();
    let twins: Slots<Result<Arc<MethodRun>, String>> = slots(runs.len());
    run_branches(&these, jobs, &|index, run| {
        let run = run.map(Arc::new).map_err(|error| error.to_string());
        lock(&twins)[places[index]] = Some(run);
    });
    let twins = twins.into_inner().unwrap_or_else(PoisonError::into_inner);
    let with_twin = |place: usize, run: Result<MethodRun, MethodError>| {
        let mut run = run?;
        let (index, _) = runs[place];
        if !scenarios[index].faults.is_empty() {
            run.twin = match &twins[first[place]] {
                Some(Ok(twin)) => Some(Arc::clone(twin)),
                Some(Err(error)) => return Err(ManyError::Twin(error.clone())),
                None => return Err(ManyError::Twin("it was not run".to_owned())),
            };
        }
        Ok::<_, ManyError>(run)
    };
    let done: Slots<Result<MethodRun, ManyError>> = slots(runs.len());
    run_branches(&plans(scenarios, &runs, control), jobs, &|place, run| {
        let run = with_twin(place, run);
        let (index, _) = runs[place];
        let mut done = lock(&done);
        done[place] = Some(run);
        let mut places = (0..runs.len()).filter(|place| runs[*place].0 == index);
        if places.clone().any(|place| done[place].is_none()) {
            return;
        }
        let mut take = || places.next().and_then(|place| done[place].take());
        let (primary, baseline) = (take(), take());
        drop(done);
        if let Some(primary) = primary {
            told(index, judged(&scenarios[index], primary, baseline));
        }
    });
}

fn plans<'a>(
    scenarios: &'a [Scenario],
    runs: &[(usize, Method)],
    control: &'a Control,
) -> Vec<Plan<'a>> {
    let plan = |(index, method): &(usize, Method)| {
        let scenario = &scenarios[*index];
        Plan::of(scenario, *method, scenario.seed, StreamKeeping::Hash, control)
    };
    runs.iter().map(plan).collect()
}

fn judged(
    scenario: &Scenario,
    primary: Result<MethodRun, ManyError>,
    baseline: Option<Result<MethodRun, ManyError>>,
) -> Result<Run, ManyError> {
    Ok(assemble(scenario, scenario.seed, primary?, baseline.transpose()?)?)
}
