//! Cases that begin alike: cases of one scenario and seed that differ by their faults and their navigation alone.
//! Their common beginning, up to the first fault or the end of the calibration, is computed once.

use super::case::{CaseError, CaseResult, run_all};
use crate::plan::{Case, PlannedScenario};
use octant_base::control::Control;
use octant_run::many::Beginnings;
use std::collections::BTreeMap;

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

/// Runs cases of a scenario that begin alike, and the twins that their requirements ask for: cases of one navigation have
/// one twin. Each result is that of the case run alone, bit for bit.
#[must_use]
pub fn run_alike(planned: &PlannedScenario, cases: &[&Case]) -> Vec<Result<CaseResult, CaseError>> {
    run_all(planned, cases, Beginnings::Shared, &Control::default())
}
