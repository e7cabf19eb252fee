//! Cases that begin alike: cases of one scenario and seed that differ by their faults and their navigation alone.
//! Their common beginning, up to the first fault or the end of the calibration, is computed once.

use super::case::{CaseError, CaseResult, hash_of};
use crate::plan::{Case, PlannedScenario};
use octant_base::control::Control;
use octant_run::Plan;
use octant_run::assemble;
use octant_run::branches::run_branches;
use octant_run::{MethodError, MethodRun, StreamKeeping};
use octant_scenario::{Method, Scenario};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Most cases that are run together: what an interruption costs stays small, and the processors stay busy
/// to the end.
pub const MOST: usize = 8;

/// Keys that count after the beginning.
const LATER: [&str; 2] = ["faults.", "procedure.navigation."];

/// Puts cases that begin alike together, by their places in `cases`. The groups stand in the order of their
/// first cases, and none is larger than [`MOST`], or than leaves each of `jobs` two of them.
#[must_use]
pub fn groups(cases: &[&Case], jobs: usize) -> Vec<Vec<usize>> {
    let most = (cases.len() / jobs.max(1) / 2).clamp(1, MOST);
    // All cases of a seed stand together in a plan.
    let mut seed = None;
    let mut open: BTreeMap<(&str, Vec<&str>), usize> = BTreeMap::new();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (place, case) in cases.iter().enumerate() {
        if seed.replace(case.seed) != Some(case.seed) {
            open.clear();
        }
        let differs = |set: &&str| LATER.iter().any(|keys| set.starts_with(keys));
        let besides = case.set.iter().map(|set| &**set).filter(|set| !differs(set));
        let key = (&*case.scenario, besides.collect());
        match open.get(&key).map(|group| &mut groups[*group]) {
            Some(group) if group.len() < most => group.push(place),
            _ => {
                open.insert(key, groups.len());
                groups.push(vec![place]);
            }
        }
    }
    groups
}

/// Runs cases of a scenario that begin alike. Each result is that of the case run alone, bit for bit.
#[must_use]
pub fn run_alike(planned: &PlannedScenario, cases: &[&Case]) -> Vec<Result<CaseResult, CaseError>> {
    let scenarios: Vec<_> = cases.iter().map(|case| planned.scenario(case)).collect();
    let control = Control::default();
    let mut plans: Vec<Plan<'_>> = Vec::new();
    // Case and method of each run.
    let mut runs: Vec<(usize, Method)> = Vec::new();
    for (place, scenario) in scenarios.iter().enumerate() {
        let Ok(scenario) = scenario else { continue };
        for method in scenario.methods() {
            let seed = cases[place].seed;
            let keeping = StreamKeeping::HashAlone;
            plans.push(Plan::of(scenario, method, seed, keeping, &control));
            runs.push((place, method));
        }
    }
    let done: Mutex<BTreeMap<(usize, bool), Result<MethodRun, MethodError>>> = Mutex::default();
    run_branches(&plans, 1, &|index, run| {
        let (place, method) = runs[index];
        let key = (place, method == Method::Primary);
        done.lock().unwrap_or_else(PoisonError::into_inner).insert(key, run);
    });
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut outcome = |place: usize, scenario: &Scenario| {
        let case = cases[place];
        let Some(primary) = done.remove(&(place, true)) else {
            return super::case::run(planned, case, &control);
        };
        let primary = primary?;
        let baseline = done.remove(&(place, false)).transpose()?;
        let summary = assemble(scenario, case.seed, primary, baseline)?.summary;
        Ok(CaseResult::of(&case.id, Some(hash_of(planned, case)), summary)?)
    };
    (scenarios.into_iter().enumerate())
        .map(|(place, scenario)| outcome(place, &scenario?))
        .collect()
}
