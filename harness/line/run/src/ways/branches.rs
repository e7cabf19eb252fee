//! Runs that share their beginning: a run with faults is the run without them until the first one sets in, and
//! the plan of a navigation counts for nothing before the calibration ends.
//!
//! Runs that are the same but for their faults have one trunk, the run without faults. Beside it go the
//! stations of the runs with faults. Before the epoch in which a fault sets in, its run branches off: source,
//! endpoint, recorder and observations are copied in memory and go on with the station. Before the epoch that
//! ends the calibration the trunk divides, one for each navigation. No step is estimated
//! or left out, and every run is the undivided one, bit for bit.

pub use super::trunk::RunTold;

use super::beginning::{Ahead, beginning};
use super::once::as_far_as_it_goes;
use super::trunk::{Group, Task, Trunk, go_on_alone};
use crate::bench::plan::Plan;
use crate::bench::recording::StreamKeeping;
use crate::results::method::MethodRun;
use octant_base::pool::with_added;
use octant_scenario::Method;
use std::sync::Arc;

/// Runs all plans, `jobs` at a time, and tells each result as it comes, in any order. What runs have in common
/// at their beginning is done once; runs with a device, an FMU, a recording, a clock, or faults of host or wire
/// are undivided.
///
/// All plans keep the same of their streams; where that is a file none is divided.
pub fn run_branches(plans: &[Plan<'_>], jobs: usize, told: &RunTold<'_>) {
    let alone = |index: usize| {
        told(index, as_far_as_it_goes(&plans[index]).and_then(MethodRun::whole));
    };
    with_added(jobs, tasks(plans), |task, waiting| match task {
        Task::Alone(index) => alone(index),
        Task::Branch(index, bench) => go_on_alone(index, *bench, plans, told),
        Task::Trunk(group) => {
            let trunk = Trunk { plans, group: &group, told, waiting };
            // Whatever stopped the trunk stops these runs too, and they have words for it.
            trunk.run().into_iter().for_each(alone);
        }
        Task::Limb(limb) => {
            let group = Arc::clone(&limb.group);
            let trunk = Trunk { plans, group: &group, told, waiting };
            trunk.go_on(*limb).into_iter().for_each(alone);
        }
    });
}

/// Returns for each plan the place of the first one whose run without faults is the same: its own where there
/// is none.
#[must_use]
pub fn first_alike(plans: &[Plan<'_>]) -> Vec<usize> {
    let found: Vec<_> = plans.iter().map(beginning).collect();
    let same = |a: usize, b: usize| {
        let of = |place: usize| found[place].as_ref().map(|(beginning, _)| beginning);
        (plans[a].method, plans[a].seed) == (plans[b].method, plans[b].seed)
            && of(a).is_some_and(|a| of(b) == Some(a))
    };
    (0..plans.len()).map(|b| (0..b).find(|a| same(*a, b)).unwrap_or(b)).collect()
}

/// Puts runs that begin alike together.
fn tasks<'a>(plans: &[Plan<'a>]) -> Vec<Task<'a>> {
    let mut groups: Vec<(Method, u64, Group)> = Vec::new();
    let mut tasks = Vec::new();
    for (index, plan) in plans.iter().enumerate() {
        let found = match plan.recording {
            StreamKeeping::File(_) => None,
            _ => beginning(plan),
        };
        let Some((beginning, draws)) = found else {
            tasks.push(Task::Alone(index));
            continue;
        };
        let (method, seed) = (plan.method, plan.seed);
        let same = groups.iter_mut().find(|(of, with, group)| {
            (*of, *with) == (method, seed) && group.beginning.calibrates_as(&beginning)
        });
        let run = (index, Ahead::of(&beginning));
        match same {
            Some((_, _, group)) => group.runs.push(run),
            None => groups.push((method, seed, Group { beginning, draws, runs: vec![run] })),
        }
    }
    tasks.extend(groups.into_iter().map(|(_, _, group)| match group.runs.as_slice() {
        [(one, _)] => Task::Alone(*one),
        _ => Task::Trunk(Arc::new(group)),
    }));
    tasks
}
