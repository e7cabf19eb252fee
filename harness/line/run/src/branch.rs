//! A run that goes on alone from where it branched off.

use super::beginning::{BranchPlan, Parts};
use super::drive::{Books, NoFaults};
use super::faulted::Faulted;
use super::in_time::{CONTROL_EPOCHS, InTime};
use super::method::{self, MethodError, MethodRun};
use octant_recorder::Recorder;
use octant_scenario::resolve::DrawnValues;

/// Takes the result of a run, by its place among the plans.
pub type RunTold<'a> = dyn Fn(usize, Result<MethodRun, MethodError>) + Sync + 'a;

/// A run that goes on alone from where it branches off.
pub(super) struct Branch {
    pub(super) index: usize,
    pub(super) faulted: Option<Faulted>,
    pub(super) parts: Parts,
    pub(super) recorder: Recorder,
    pub(super) draws: DrawnValues,
}

impl Branch {
    pub(super) fn run(self, plans: &[BranchPlan<'_>], told: &RunTold<'_>) {
        let index = self.index;
        told(index, self.finish(&plans[index]).and_then(method::whole));
    }

    pub(super) fn finish(self, plan: &BranchPlan<'_>) -> Result<MethodRun, MethodError> {
        let Self { mut faulted, parts, mut recorder, draws, .. } = self;
        let Parts { mut source, mut endpoint, mut steps, mut watcher, revision, ended } = parts;
        let books = Books::new(&mut recorder, &mut watcher, faulted.as_ref());
        let look_every = CONTROL_EPOCHS;
        let mut keeper =
            InTime { books, control: plan.control, look_every, revision, attended: None };
        let driven = match (ended, &mut faulted) {
            (Some(ended), _) => Ok(ended),
            (None, Some(faulted)) => steps.go_on(&mut source, faulted, &mut endpoint, &mut keeper),
            (None, None) => steps.go_on(&mut source, &mut NoFaults, &mut endpoint, &mut keeper),
        };
        let words = faulted.iter().flat_map(Faulted::last_words);
        words.for_each(|event| keeper.books.recorder.event(event));
        let books = (&mut recorder, &mut watcher);
        let control = plan.control;
        let closed = method::close((driven, None), &mut source, &mut endpoint, books, control)?;
        let truth = Some(&draws);
        let run = method::finish(plan.scenario, plan.method, closed, recorder, watcher, truth)?;
        let receipts = faulted.map_or_else(Vec::new, |faulted| faulted.station.receipts());
        Ok(MethodRun { receipts, ..run })
    }
}
