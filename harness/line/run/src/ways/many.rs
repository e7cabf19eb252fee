//! Many scenarios, each with its twin, judged: what they have in common at their beginning runs once.

use super::branches::{first_alike, run_branches};
use super::once::as_far_as_it_goes;
use super::sessions::BothSessions;
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

/// A scenario among many.
#[derive(Clone, Copy, Debug)]
pub struct OneOfMany<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// Its seed.
    pub seed: u64,
    /// Parts of its stream that are kept.
    pub keeping: StreamKeeping<'static>,
    /// Whether it is compared with the run without its faults; without faults there is none.
    pub twin: bool,
}

impl<'a> OneOfMany<'a> {
    /// A scenario with its own seed and its twin, of which the hashes of altered streams are kept too.
    fn with_twin(scenario: &'a Scenario) -> Self {
        Self { scenario, seed: scenario.seed, keeping: StreamKeeping::Hash, twin: true }
    }
}

/// Whether runs share their beginnings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beginnings {
    /// The beginning that runs have in common is computed once.
    Shared,
    /// Each run is computed from its beginning.
    Undivided,
}

/// Runs scenarios with their own seeds, and the runs without their faults; `jobs` at a time. Each is judged as
/// `octant run` does, and told in any order. No file is written.
pub fn judge_many(
    scenarios: &[Scenario],
    jobs: usize,
    control: &Control,
    told: &(dyn Fn(usize, Result<Run, ManyError>) + Sync),
) {
    let all: Vec<OneOfMany<'_>> = scenarios.iter().map(OneOfMany::with_twin).collect();
    judge_each(&all, Beginnings::Shared, jobs, control, told);
}

/// Runs scenarios, each with its twin where it has one; `jobs` at a time. A twin is the run from which those with faults
/// branch off, and serves all runs that are the same without their faults. Each is judged as `octant run` does,
/// and told in any order. No file is written.
pub fn judge_each(
    all: &[OneOfMany<'_>],
    beginnings: Beginnings,
    jobs: usize,
    control: &Control,
    told: &(dyn Fn(usize, Result<Run, ManyError>) + Sync),
) {
    let has_twin = |one: &OneOfMany<'_>| one.twin && !one.scenario.faults.is_empty();
    let clean: Vec<Option<Scenario>> =
        all.iter().map(|one| has_twin(one).then(|| one.scenario.without_faults())).collect();
    let runs: Vec<(usize, Method)> = (all.iter().enumerate())
        .flat_map(|(index, one)| one.scenario.methods().map(move |method| (index, method)))
        .collect();
    let plan = |scenario, index: usize, method| {
        let OneOfMany { seed, keeping, .. } = all[index];
        let plan = Plan::of(scenario, method, seed, keeping, control);
        Plan { trace: plan.trace || clean[index].is_some(), ..plan }
    };
    let sessions: Vec<Option<BothSessions>> = (runs.iter())
        .map(|(index, method)| {
            let faulted = clean[*index].is_some().then_some(all[*index])?;
            BothSessions::of(faulted.scenario, *method, faulted.seed)
        })
        .collect();
    let faulted = runs.iter().zip(&sessions).map(|((index, method), sessions)| {
        let session = sessions.map(|both| both.faulted);
        Plan { session, ..plan(all[*index].scenario, *index, *method) }
    });
    let mut plans: Vec<Plan<'_>> = faulted.collect();
    let (with_twin, twins): (Vec<usize>, Vec<Plan<'_>>) = (runs.iter().enumerate())
        .filter_map(|(place, (index, method))| {
            let session = sessions[place].map(|both| both.twin);
            Some((place, Plan { session, ..plan(clean[*index].as_ref()?, *index, *method) }))
        })
        .unzip();
    let mut twin_of: Vec<Option<usize>> = vec![None; runs.len()];
    for ((place, twin), first) in with_twin.iter().zip(&twins).zip(first_alike(&twins)) {
        twin_of[*place] = twin_of[with_twin[first]].or(Some(plans.len()));
        if twin_of[*place] == Some(plans.len()) {
            plans.push(*twin);
        }
    }
    let ended = slots(plans.len());
    let awaited = Awaited { runs, twin_of, ended };
    let run_ended = |place: usize, run: Result<MethodRun, MethodError>| {
        for (index, primary, baseline) in awaited.put(place, run) {
            told(index, judged(&all[index], primary, baseline));
        }
    };
    // Sessions of twins that come first; all others in their order.
    let is_later = |place: &usize| {
        *place < awaited.runs.len() || !plans[*place].session.is_some_and(|twin| twin.is_first)
    };
    let mut order: Vec<usize> = (0..plans.len()).collect();
    order.sort_by_key(is_later);
    let plans: Vec<Plan<'_>> = order.iter().map(|place| plans[*place]).collect();
    match beginnings {
        Beginnings::Shared => {
            run_branches(&plans, jobs, &|index, run| run_ended(order[index], run));
        }
        Beginnings::Undivided => order.iter().zip(&plans).for_each(|(place, plan)| {
            run_ended(*place, as_far_as_it_goes(plan).and_then(MethodRun::whole));
        }),
    }
}

/// Runs of scenarios and their twins, which wait for each other.
struct Awaited {
    /// Scenario and method of each run, in the order of the plans; twins follow.
    runs: Vec<(usize, Method)>,
    /// Place of the twin of each run.
    twin_of: Vec<Option<usize>>,
    ended: Slots<Ended>,
}

/// A scenario whose runs have ended, by its place, with its methods.
type Complete = (usize, Result<MethodRun, ManyError>, Option<Result<MethodRun, ManyError>>);

impl Awaited {
    /// Puts a run that ended in its place; returns the scenarios that were waiting for nothing else.
    fn put(&self, place: usize, run: Result<MethodRun, MethodError>) -> Vec<Complete> {
        let is_run = place < self.runs.len();
        let run = if is_run { Ended::Run(Box::new(run)) } else { Ended::twin(run) };
        let mut ended = lock(&self.ended);
        ended[place] = Some(run);
        let waited = |run: &usize| *run == place || self.twin_of[*run] == Some(place);
        let mut indices: Vec<usize> =
            (0..self.runs.len()).filter(waited).map(|run| self.runs[run].0).collect();
        indices.dedup();
        indices.into_iter().filter_map(|index| self.take(&mut ended, index)).collect()
    }

    /// Takes the methods of a scenario, if they and their twins have ended.
    fn take(&self, ended: &mut [Option<Ended>], index: usize) -> Option<Complete> {
        let places = || (0..self.runs.len()).filter(|place| self.runs[*place].0 == index);
        let mut needed = places().flat_map(|place| [Some(place), self.twin_of[place]]).flatten();
        if needed.any(|place| ended[place].is_none()) {
            return None;
        }
        let mut methods = places().filter_map(|place| {
            let Some(Ended::Run(run)) = ended[place].take() else { return None };
            let twin = self.twin_of[place].and_then(|place| ended[place].as_ref());
            Some(run.map_err(ManyError::from).and_then(|run| with_twin(run, twin)))
        });
        let primary = methods.next()?;
        Some((index, primary, methods.next()))
    }
}

/// A run that ended.
enum Ended {
    Run(Box<Result<MethodRun, MethodError>>),
    /// A run without faults, or its own words where it has no result.
    Twin(Result<Arc<MethodRun>, String>),
}

impl Ended {
    fn twin(run: Result<MethodRun, MethodError>) -> Self {
        Self::Twin(run.map(Arc::new).map_err(|error| error.to_string()))
    }
}

/// Gives a run its twin, where it has one.
fn with_twin(run: MethodRun, twin: Option<&Ended>) -> Result<MethodRun, ManyError> {
    match twin {
        Some(Ended::Twin(Ok(twin))) => Ok(MethodRun { twin: Some(Arc::clone(twin)), ..run }),
        Some(Ended::Twin(Err(error))) => Err(ManyError::Twin(error.clone())),
        Some(Ended::Run(_)) | None => Ok(run),
    }
}

fn judged(
    one: &OneOfMany<'_>,
    primary: Result<MethodRun, ManyError>,
    baseline: Option<Result<MethodRun, ManyError>>,
) -> Result<Run, ManyError> {
    Ok(assemble(one.scenario, one.seed, primary?, baseline.transpose()?)?)
}
