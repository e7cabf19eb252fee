//! The run without faults, from which others branch off.

use super::beginning::{Ahead, Beginning, BranchPlan, Parts, ends_calibration_next, is_due};
use super::branch::{Branch, RunTold};
use super::drive::{Books, Ended, Injects, Steps};
use super::faulted::Faulted;
use super::host::RunHost;
use super::in_time::{CONTROL_EPOCHS, InTime};
use super::method::{self, MethodError, SetupError, StreamKeeping};
use super::recording::recorder_options;
use super::watch::Watcher;
use octant_base::control::Control;
use octant_base::pool::Waiting;
use octant_endpoint::{Endpoint, InProcess, Tells};
use octant_faults::station::{Delivered, Passed, World};
use octant_recorder::{Recorder, RecorderTrouble};
use octant_sample::disturbance::Disturbed;
use octant_sample::{GimbalCommand, Output, Truth};
use octant_scenario::resolve::DrawnValues;
use octant_score::trace::RunTrace;
use octant_source::{Epoch, PlantSource, Source};
use std::sync::Arc;

/// Runs that begin alike.
pub(super) struct Group {
    pub(super) beginning: Beginning,
    pub(super) draws: DrawnValues,
    pub(super) runs: Vec<(usize, Ahead)>,
}

/// A trunk on its way, and the runs that have to branch off.
pub(super) struct Begun {
    pub(super) group: Arc<Group>,
    /// Where it goes itself.
    ahead: Ahead,
    parts: Parts,
    recorder: Recorder,
    waits: Waits,
}

/// Something to do.
pub(super) enum Task {
    Alone(usize),
    Trunk(Arc<Group>),
    /// The trunk of one of the navigations after a common calibration.
    Limb(Box<Begun>),
    Branch(Box<Branch>),
}

/// The run without faults, from which others branch off.
pub(super) struct Trunk<'a, 'b> {
    pub(super) plans: &'b [BranchPlan<'a>],
    pub(super) group: &'b Arc<Group>,
    pub(super) keeping: StreamKeeping<'b>,
    pub(super) told: &'b RunTold<'b>,
    pub(super) waiting: &'b Waiting<Task>,
}

/// What a run of the trunk is made of, between two steps.
type UnderWay<'b, 'c> = (&'b PlantSource, &'b InProcess, &'b Steps, &'b mut InTime<'c>);

impl Trunk<'_, '_> {
    /// Runs it as far as a run needs it; returns the runs that couldn't branch off.
    pub(super) fn run(&self) -> Vec<usize> {
        let mut waits = Waits::default();
        for (index, ahead) in &self.group.runs {
            match self.faulted(*index) {
                Ok(faulted) => {
                    waits.runs.push(Wait { index: *index, faulted, ahead: ahead.clone() });
                }
                Err(_) => waits.alone.push(*index),
            }
        }
        match self.begin() {
            Ok((parts, recorder)) => {
                let (group, ahead) = (Arc::clone(self.group), Ahead::of(&self.group.beginning));
                self.go_on(Begun { group, ahead, parts, recorder, waits })
            }
            Err(_) => waits.all(),
        }
    }

    fn faulted(&self, index: usize) -> Result<Option<Faulted>, SetupError> {
        let BranchPlan { scenario, seed, .. } = self.plans[index];
        let mut faulted = method::faulted(scenario, seed)?;
        if let Some(faulted) = &mut faulted {
            faulted.host = RunHost::new(scenario, &self.keeping, &RecorderTrouble::default())?;
        }
        Ok(faulted)
    }

    fn begin(&self) -> Result<(Parts, Recorder), SetupError> {
        let Beginning { plant, core, samples, work } = &self.group.beginning;
        let source = PlantSource::new(plant, *samples).map_err(SetupError::Plant)?;
        let endpoint = InProcess::new(core).map_err(SetupError::Core)?;
        let mut watcher = Watcher::new(work.clone());
        watcher.trace = match self.keeping {
            StreamKeeping::HashAlone => None,
            StreamKeeping::Hash | StreamKeeping::None | StreamKeeping::File(_) => {
                Some(RunTrace::new())
            }
        };
        let steps = Steps::new(source.samples_total());
        let parts = Parts { source, endpoint, steps, watcher, revision: 0, ended: None };
        Ok((parts, self.recorder()?))
    }

    fn recorder(&self) -> Result<Recorder, SetupError> {
        let Some(first) = self.group.runs.first().map(|(index, _)| &self.plans[*index]) else {
            return Ok(Recorder::none());
        };
        let draws = &self.group.draws;
        let told = (true, Tells::ALL);
        let options = recorder_options(first.scenario, first.seed, draws, first.method, told);
        self.keeping.start(&options).map_err(SetupError::Recorder)
    }

    /// Runs on as far as a run needs it; returns the runs that couldn't branch off.
    pub(super) fn go_on(&self, begun: Begun) -> Vec<usize> {
        let Begun { ahead, parts, mut recorder, mut waits, .. } = begun;
        // A failure takes those that wait to their own runs.
        _ = self.drive(&ahead, parts, &mut recorder, &mut waits);
        waits.all()
    }

    fn drive(
        &self,
        ahead: &Ahead,
        parts: Parts,
        recorder: &mut Recorder,
        waits: &mut Waits,
    ) -> Result<(), MethodError> {
        let Parts { mut source, mut endpoint, mut steps, mut watcher, revision, mut ended } = parts;
        // The controls are looked at here: each has its own run.
        let control = Control::default();
        let books = Books::new(recorder, &mut watcher, None);
        let mut keeper = InTime {
            books,
            control: &control,
            look_every: CONTROL_EPOCHS,
            revision,
            attended: None,
        };
        while ended.is_none() && !waits.runs.is_empty() {
            let number = steps.number();
            if number.is_multiple_of(CONTROL_EPOCHS) && self.is_cancelled(waits, number) {
                ended = Some(Ended::Cancelled);
                break;
            }
            while let Some(wait) = waits.due(&steps, &source) {
                let going = (&source, &endpoint, &steps, &mut keeper);
                self.branch(waits, wait, ahead, going, None);
            }
            if ends_calibration_next(&endpoint, &steps) {
                let going = (&source, &endpoint, &steps, &mut keeper);
                self.divide(waits, ahead, going);
            }
            ended = steps.step(&mut source, waits, &mut endpoint, &mut keeper)?;
        }
        for wait in std::mem::take(&mut waits.runs) {
            let going = (&source, &endpoint, &steps, &mut keeper);
            self.branch(waits, wait, ahead, going, ended);
        }
        Ok(())
    }

    /// Tells the runs that wait how far they are; true if the end of one was asked for.
    fn is_cancelled(&self, waits: &Waits, epochs: u64) -> bool {
        let look = |wait: &&Wait| self.plans[wait.index].control.look(epochs);
        waits.runs.iter().filter(look).count() > 0
    }

    /// Lets a run go on alone: on another thread, or here where none has time.
    fn branch(
        &self,
        waits: &mut Waits,
        wait: Wait,
        own: &Ahead,
        going: UnderWay<'_, '_>,
        ended: Option<Ended>,
    ) {
        let Wait { index, faulted, ahead } = wait;
        let Some((mut parts, recorder)) = self.copy((own, &ahead), going, ended) else {
            waits.alone.push(index);
            return;
        };
        if faulted.is_none() && matches!(self.keeping, StreamKeeping::None) {
            parts.watcher.trace = None;
        }
        let draws = self.group.draws.clone();
        let branch = Box::new(Branch { index, faulted, parts, recorder, draws });
        if let Some(Task::Branch(branch)) = self.waiting.add(Task::Branch(branch)) {
            branch.run(self.plans, self.told);
        }
    }

    /// Lets the runs that navigate otherwise than the trunk go on: those of one navigation together.
    fn divide(
        &self,
        waits: &mut Waits,
        own: &Ahead,
        (source, endpoint, steps, keeper): UnderWay<'_, '_>,
    ) {
        while let Some(ahead) =
            waits.runs.iter().map(|wait| &wait.ahead).find(|ahead| *ahead != own)
        {
            let ahead = ahead.clone();
            let (these, others): (Vec<Wait>, Vec<Wait>) =
                std::mem::take(&mut waits.runs).into_iter().partition(|wait| wait.ahead == ahead);
            waits.runs = others;
            let going = (source, endpoint, steps, &mut *keeper);
            if let [_] = these.as_slice() {
                for wait in these {
                    self.branch(waits, wait, own, (source, endpoint, steps, &mut *keeper), None);
                }
                continue;
            }
            let Some((parts, recorder)) = self.copy((own, &ahead), going, None) else {
                waits.alone.extend(these.into_iter().map(|wait| wait.index));
                continue;
            };
            let group = Arc::clone(self.group);
            let these = Waits { runs: these, alone: Vec::new() };
            let limb = Task::Limb(Box::new(Begun { group, ahead, parts, recorder, waits: these }));
            if let Some(Task::Limb(limb)) = self.waiting.add(limb) {
                waits.alone.extend(self.go_on(*limb));
            }
        }
    }

    /// Copies the trunk, for a run that may navigate otherwise; `None` if it can't be copied.
    fn copy(
        &self,
        (own, ahead): (&Ahead, &Ahead),
        (source, endpoint, steps, keeper): UnderWay<'_, '_>,
        ended: Option<Ended>,
    ) -> Option<(Parts, Recorder)> {
        let recorder = keeper.books.recorder.branch().ok()?;
        let watcher = keeper.books.watcher.clone();
        let (source, endpoint, steps) = (source.clone(), endpoint.clone(), steps.clone());
        let parts = Parts { source, endpoint, steps, watcher, revision: keeper.revision, ended };
        Some((if ahead == own { parts } else { parts.turn_to(ahead).ok()? }, recorder))
    }
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
    fn due(&mut self, steps: &Steps, source: &PlantSource) -> Option<Wait> {
        let is_due = |wait: &Wait| {
            wait.faulted.as_ref().is_some_and(|faulted| is_due(faulted, steps, source))
        };
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
    const INJECTS: bool = true;

    fn before(
        &mut self,
        _number: u64,
        command: &mut GimbalCommand,
        output: &Output,
        (source, _): (&mut S, &mut E),
    ) {
        for faulted in self.stations() {
            faulted.station.before(&mut command.clone(), output, &mut Onlooker(&*source));
        }
    }

    fn after(
        &mut self,
        epoch: &Epoch,
        output: &Output,
        (source, _): (&mut S, &mut E),
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
