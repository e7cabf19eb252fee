//! The beginning of a run with faults, kept for runs with some of its faults.

use super::beginning::{BranchPlan, Parts, beginning, until_due};
use super::branch::Branch;
use super::drive::{Books, Steps};
use super::faulted::Faulted;
use super::host::RunHost;
use super::in_time::{CONTROL_EPOCHS, InTime};
use super::method::{self, MethodError, MethodRun, SetupError};
use super::watch::Watcher;
use octant_base::control::Control;
use octant_endpoint::InProcess;
use octant_recorder::Recorder;
use octant_scenario::resolve::DrawnValues;
use octant_score::trace::RunTrace;
use octant_source::{PlantSource, Source};

/// A run up to the epoch before its first fault sets in; nothing is recorded.
#[derive(Debug)]
pub struct Stem {
    parts: Parts,
    faulted: Faulted,
    draws: DrawnValues,
}

impl Stem {
    /// Runs up to the first fault; `None` for a run without faults, and for one that can't be divided.
    ///
    /// # Errors
    /// If the run can't be set up, or fails before.
    pub fn of(plan: &BranchPlan<'_>) -> Result<Option<Self>, MethodError> {
        let Some((begun, draws)) = beginning(plan) else { return Ok(None) };
        let Some(mut faulted) = method::faulted(plan.scenario, plan.seed)? else { return Ok(None) };
        let mut source =
            PlantSource::new(&begun.plant, begun.samples).map_err(SetupError::Plant)?;
        let mut endpoint = InProcess::new(&begun.core).map_err(SetupError::Core)?;
        let (mut recorder, mut watcher) = (Recorder::none(), Watcher::new(begun.work));
        watcher.trace = Some(RunTrace::new());
        let books = Books::new(&mut recorder, &mut watcher, Some(&faulted));
        let control = plan.control;
        let mut keeper =
            InTime { books, control, look_every: CONTROL_EPOCHS, revision: 0, attended: None };
        let mut steps = Steps::new(source.samples_total());
        let going = (&mut source, &mut endpoint, &mut keeper, &mut steps);
        let ended = until_due(going, &mut faulted, &Control::default())?;
        let revision = keeper.revision;
        let parts = Parts { source, endpoint, steps, watcher, revision, ended };
        Ok(Some(Self { parts, faulted, draws }))
    }

    /// Runs on with some of the faults, selected by their numbers from 0; the plan's scenario has the same ones.
    ///
    /// # Errors
    /// As for an undivided run.
    pub fn run(
        &self,
        plan: &BranchPlan<'_>,
        keep: impl Fn(usize) -> bool,
    ) -> Result<MethodRun, MethodError> {
        let station = self.faulted.station.with_only(keep);
        let fires = self.faulted.fires.clone();
        let faulted = Some(Faulted { station, fires, host: RunHost::default() });
        let recorder = Recorder::none();
        let (parts, draws) = (self.parts.clone(), self.draws.clone());
        Branch { index: 0, faulted, parts, recorder, draws }.finish(plan).and_then(method::whole)
    }
}
