//! The run without faults, from which others branch off.

use super::beginning::{Ahead, Beginning, Simulated};
use crate::bench::Bench;
use crate::bench::ended::Ended;
use crate::bench::error::{MethodError, SetupError};
use crate::bench::faulted::Faulted;
use crate::bench::plan::Plan;
use crate::bench::records::{CONTROL_EPOCHS, nobody};
use crate::bench::set_up::SetUp;
use crate::bench::steps::Injects;
use crate::results::method::MethodRun;
use octant_base::pool::Waiting;
use octant_endpoint::Endpoint;
use octant_faults::station::{Delivered, Passed, World};
use octant_sample::disturbance::Disturbed;
use octant_sample::{GimbalCommand, Output, Truth};
use octant_scenario::resolve::DrawnValues;
use octant_source::{Epoch, Source};
use std::sync::Arc;

/// Takes the result of a run, by its place among the plans.
pub type RunTold<'a> = dyn Fn(usize, Result<MethodRun, MethodError>) + Sync + 'a;

/// Runs that begin alike.
pub(super) struct Group {
    pub(super) beginning: Beginning,
    pub(super) draws: DrawnValues,
    /// Places of the runs among the plans, with what comes after the calibration.
    pub(super) runs: Vec<(usize, Ahead)>,
}

/// Something to do.
pub(super) enum Task<'a> {
    /// A run that has nothing in common with others.
    Alone(usize),
    /// The run that others of a group branch off from.
    Trunk(Arc<Group>),
    /// The trunk of one of the navigations after a common calibration.
    Limb(Box<Limb>),
    /// A run that branched off, by its place.
    Branch(usize, Box<Simulated<'a>>),
}

/// A trunk on its way, and the runs that have to branch off.
pub(super) struct Limb {
    pub(super) group: Arc<Group>,
    /// Where it goes itself.
    ahead: Ahead,
    bench: Simulated<'static>,
    waits: Waits,
}

/// The run without faults, from which others branch off.
pub(super) struct Trunk<'a, 'b> {
    pub(super) plans: &'a [Plan<'a>],
    pub(super) group: &'b Arc<Group>,
    pub(super) told: &'b RunTold<'b>,
    pub(super) waiting: &'b Waiting<Task<'a>>,
}

/// Goes on alone from where a run branched off, and tells its result.
pub(super) fn go_on_alone(
    index: usize,
    mut bench: Simulated<'_>,
    plans: &[Plan<'_>],
    told: &RunTold<'_>,
) {
    let Plan { scenario, method, .. } = plans[index];
    bench.run();
    let closed = bench.close().map_err(MethodError::from);
    let run = closed.and_then(|closed| MethodRun::scored(scenario, method, closed));
    told(index, run.and_then(MethodRun::whole));
}

impl<'a> Trunk<'a, '_> {
    /// Runs it as far as a run needs it; returns the runs that couldn't branch off.
    pub(super) fn run(&self) -> Vec<usize> {
        let mut waits = Waits::default();
        for (index, ahead) in &self.group.runs {
            match self.plans[*index].ready() {
                Ok(ready) => {
                    let (faulted, ahead) = (ready.faulted, ahead.clone());
                    waits.runs.push(Wait { index: *index, faulted, ahead });
                }
                Err(_) => waits.alone.push(*index),
            }
        }
        match self.begin() {
            Ok(bench) => {
                let (group, ahead) = (Arc::clone(self.group), Ahead::of(&self.group.beginning));
                self.go_on(Limb { group, ahead, bench, waits })
            }
            Err(_) => waits.all(),
        }
    }

    /// Opens it as its first run, without the faults. The controls are looked at here: each run has its own.
    fn begin(&self) -> Result<Simulated<'static>, SetupError> {
        let Group { beginning, draws, runs } = &**self.group;
        let first = runs.first().map_or(0, |(index, _)| *index);
        let trace = runs.iter().any(|(index, _)| self.plans[*index].trace);
        let plan = Plan { faults: false, trace, control: nobody(), ..self.plans[first] };
        let mut bench =
            Bench::open(&plan, plan.ready()?, beginning.set_up(draws), SetUp::simulated)?;
        bench.end_with_source();
        Ok(bench.under_nobody())
    }

    /// Runs on as far as a run needs it; returns the runs that couldn't branch off.
    pub(super) fn go_on(&self, limb: Limb) -> Vec<usize> {
        let Limb { ahead, mut bench, mut waits, .. } = limb;
        while bench.ended.is_none() && !waits.runs.is_empty() {
            let number = bench.steps.number();
            if number.is_multiple_of(CONTROL_EPOCHS) && self.is_cancelled(&waits, number) {
                bench.ended = Some(Ok(Ended::Cancelled));
                break;
            }
            while let Some(wait) = waits.due(&bench) {
                self.branch(&mut waits, wait, &ahead, &mut bench);
            }
            if number + 1 == bench.endpoint.core().calibration_samples() {
                self.divide(&mut waits, &ahead, &mut bench);
            }
            bench.step_through(&mut waits);
        }
        // A failure takes those that wait to their own runs.
        if !matches!(bench.ended, Some(Err(_))) {
            for wait in std::mem::take(&mut waits.runs) {
                self.branch(&mut waits, wait, &ahead, &mut bench);
            }
        }
        waits.all()
    }

    /// Tells the runs that wait how far they are; true if the end of one was asked for.
    fn is_cancelled(&self, waits: &Waits, epochs: u64) -> bool {
        let look = |wait: &&Wait| self.plans[wait.index].control.look(epochs);
        waits.runs.iter().filter(look).count() > 0
    }

    /// Lets a run go on alone: on another thread, or here where none has time.
    fn branch(&self, waits: &mut Waits, wait: Wait, own: &Ahead, trunk: &mut Simulated<'static>) {
        let Wait { index, faulted, ahead } = wait;
        let plan = &self.plans[index];
        let branch = trunk.branch(faulted, plan.control).ok();
        let Some(mut bench) = branch.and_then(|bench| turned(bench, own, &ahead)) else {
            waits.alone.push(index);
            return;
        };
        if !plan.trace {
            bench.keeper.observers.trace = None;
        }
        if let Some(Task::Branch(index, bench)) =
            self.waiting.add(Task::Branch(index, Box::new(bench)))
        {
            go_on_alone(index, *bench, self.plans, self.told);
        }
    }

    /// Lets the runs that navigate otherwise than the trunk go on: those of one navigation together.
    fn divide(&self, waits: &mut Waits, own: &Ahead, trunk: &mut Simulated<'static>) {
        while let Some(ahead) =
            waits.runs.iter().map(|wait| &wait.ahead).find(|ahead| *ahead != own)
        {
            let ahead = ahead.clone();
            let (mut these, others): (Vec<Wait>, Vec<Wait>) =
                std::mem::take(&mut waits.runs).into_iter().partition(|wait| wait.ahead == ahead);
            waits.runs = others;
            if these.len() == 1 {
                these.drain(..).for_each(|wait| self.branch(waits, wait, own, trunk));
                continue;
            }
            let branch = trunk.branch(None, nobody()).ok();
            let Some(bench) = branch.and_then(|bench| turned(bench, own, &ahead)) else {
                waits.alone.extend(these.into_iter().map(|wait| wait.index));
                continue;
            };
            let group = Arc::clone(self.group);
            let these = Waits { runs: these, alone: Vec::new() };
            let limb = Task::Limb(Box::new(Limb { group, ahead, bench, waits: these }));
            if let Some(Task::Limb(limb)) = self.waiting.add(limb) {
                waits.alone.extend(self.go_on(*limb));
            }
        }
    }
}

/// Sets what comes after the calibration, where it isn't the trunk's own; `None` if that can't be.
fn turned<'a>(bench: Simulated<'a>, own: &Ahead, ahead: &Ahead) -> Option<Simulated<'a>> {
    if ahead == own { Some(bench) } else { ahead.turn(bench).ok() }
}

/// A run that hasn't branched off.
struct Wait {
    /// Its place.
    index: usize,
    faulted: Option<Faulted>,
    ahead: Ahead,
}

/// Runs that haven't branched off. Their stations see what goes by and change nothing.
#[derive(Default)]
struct Waits {
    runs: Vec<Wait>,
    /// Places of runs that have to be undivided.
    alone: Vec<usize>,
}

impl Waits {
    /// Takes out a run of which a fault sets in at the next step.
    fn due(&mut self, bench: &Simulated<'_>) -> Option<Wait> {
        let is_due =
            |wait: &Wait| wait.faulted.as_ref().is_some_and(|faulted| bench.is_fault_due(faulted));
        let at = self.runs.iter().position(is_due)?;
        Some(self.runs.remove(at))
    }

    /// Places of all of them.
    fn all(self) -> Vec<usize> {
        let Self { runs, mut alone } = self;
        alone.extend(runs.into_iter().map(|wait| wait.index));
        alone
    }

    fn stations(&mut self) -> impl Iterator<Item = &mut Faulted> {
        self.runs.iter_mut().filter_map(|wait| wait.faulted.as_mut())
    }
}

impl<S: Source + ?Sized, E: Endpoint + ?Sized> Injects<S, E> for Waits {
    fn before(
        &mut self,
        _number: u64,
        command: &mut GimbalCommand,
        output: &Output,
        source: &mut S,
        _endpoint: &mut E,
    ) {
        for faulted in self.stations() {
            faulted.station.before(&mut command.clone(), output, &mut Onlooker(&*source));
        }
    }

    fn after(
        &mut self,
        epoch: &Epoch,
        output: &Output,
        source: &mut S,
        _endpoint: &mut E,
    ) -> Passed<'_> {
        for faulted in self.stations() {
            faulted.station.after(epoch, output, &mut Onlooker(&*source));
        }
        Passed { delivered: Delivered::Untouched, undisturbed: None }
    }
}

/// A world in which nothing can be done.
struct Onlooker<'a, S: ?Sized>(&'a S);

impl<S: Source + ?Sized> World for Onlooker<'_, S> {
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed> {
        None
    }

    fn truth(&self) -> Option<Truth> {
        self.0.truth()
    }
}
