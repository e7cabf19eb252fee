//! Runs that share their beginning: a run with faults is the run without them until the first one sets in.
//!
//! Runs that are the same but for their faults have one trunk, the run without faults. Beside it go the
//! stations of the runs with faults. Before the epoch in which a fault sets in, its run branches off: source,
//! endpoint, recorder and observations are copied in memory and go on with the station. No step is estimated
//! or left out, and every run is the undivided one, bit for bit.

use super::done::PlannedWork;
use super::drive::{Books, Ended, Injects, NoFaults, RunError, Steps};
use super::faulted::Faulted;
use super::host::RunHost;
use super::in_time::{CONTROL_EPOCHS, InTime};
use super::method::{
    self, MethodError, MethodRun, SetupError, StreamKeeping, recorder_options, run_method,
};
use super::watch::Watcher;
use octant_base::control::Control;
use octant_base::pool::{Waiting, with_added};
use octant_calibration::config::CoreConfig;
use octant_endpoint::{Endpoint, InProcess, Tells};
use octant_faults::catalogue::Acts;
use octant_faults::station::{Delivered, World};
use octant_plant::config::PlantConfig;
use octant_recorder::{Recorder, RecorderTrouble};
use octant_sample::disturbance::Disturbed;
use octant_sample::{GimbalCommand, Output, Truth};
use octant_scenario::resolve::DrawnValues;
use octant_scenario::{EndpointSpec, Method, Scenario};
use octant_score::trace::RunTrace;
use octant_source::configure::configurations;
use octant_source::{Epoch, PlantSource, Source};

/// One of the runs.
#[derive(Clone, Copy, Debug)]
pub struct BranchPlan<'a> {
    /// Its scenario.
    pub scenario: &'a Scenario,
    /// Method.
    pub method: Method,
    /// Seed.
    pub seed: u64,
    /// Progress, and the request to end it.
    pub control: &'a Control,
}

/// Takes the result of a run, by its place among the plans.
pub type RunTold<'a> = dyn Fn(usize, Result<MethodRun, MethodError>) + Sync + 'a;

/// Everything that decides a run but its faults: equal beginnings give equal runs.
#[derive(Debug, PartialEq)]
pub(super) struct Beginning {
    pub(super) plant: PlantConfig,
    pub(super) core: CoreConfig,
    pub(super) samples: u64,
    pub(super) work: PlannedWork,
}

/// Runs that begin alike.
struct Group {
    beginning: Beginning,
    draws: DrawnValues,
    runs: Vec<usize>,
}

enum Task {
    Alone(usize),
    Trunk(Box<Group>),
    Branch(Box<Branch>),
}

/// Runs all plans, `jobs` at a time, and tells each result as it comes, in any order. What runs have in common
/// at their beginning is done once; runs with a device, an FMU, a recording, a clock, or faults of host or wire
/// are undivided.
///
/// `keeping` is that of all of them; with a file none is divided.
pub fn run_branches(
    plans: &[BranchPlan<'_>],
    keeping: StreamKeeping<'_>,
    jobs: usize,
    told: &RunTold<'_>,
) {
    let alone = |index: usize| {
        let BranchPlan { scenario, method, seed, control } = plans[index];
        told(index, run_method(scenario, method, seed, keeping, control));
    };
    with_added(jobs, tasks(plans, keeping), |task, waiting| match task {
        Task::Alone(index) => alone(index),
        Task::Branch(branch) => branch.run(plans, told),
        Task::Trunk(group) => {
            let trunk = Trunk { plans, group: &group, keeping, told, waiting };
            // Whatever stopped the trunk stops these runs too, and they have words for it.
            trunk.run().into_iter().for_each(alone);
        }
    });
}

/// Returns for each plan the place of the first one whose run without faults is the same: its own where there
/// is none.
#[must_use]
pub fn first_alike(plans: &[BranchPlan<'_>]) -> Vec<usize> {
    let found: Vec<_> = plans.iter().map(beginning).collect();
    let same = |a: usize, b: usize| {
        let of = |place: usize| found[place].as_ref().map(|(beginning, _)| beginning);
        (plans[a].method, plans[a].seed) == (plans[b].method, plans[b].seed)
            && of(a).is_some_and(|a| of(b) == Some(a))
    };
    (0..plans.len()).map(|b| (0..b).find(|a| same(*a, b)).unwrap_or(b)).collect()
}

/// Puts runs that begin alike together.
fn tasks(plans: &[BranchPlan<'_>], keeping: StreamKeeping<'_>) -> Vec<Task> {
    let mut groups: Vec<(Method, u64, Group)> = Vec::new();
    let mut tasks = Vec::new();
    for (index, plan) in plans.iter().enumerate() {
        let found = match keeping {
            StreamKeeping::File(_) => None,
            _ => beginning(plan),
        };
        let Some((beginning, draws)) = found else {
            tasks.push(Task::Alone(index));
            continue;
        };
        let (method, seed) = (plan.method, plan.seed);
        let same = groups.iter_mut().find(|(of, with, group)| {
            (*of, *with) == (method, seed) && group.beginning == beginning
        });
        match same {
            Some((_, _, group)) => group.runs.push(index),
            None => groups.push((method, seed, Group { beginning, draws, runs: vec![index] })),
        }
    }
    tasks.extend(groups.into_iter().map(|(_, _, group)| match group.runs.as_slice() {
        [one] => Task::Alone(*one),
        _ => Task::Trunk(Box::new(group)),
    }));
    tasks
}

/// Returns what decides a run but its faults; `None` if it can't be divided.
pub(super) fn beginning(plan: &BranchPlan<'_>) -> Option<(Beginning, DrawnValues)> {
    let BranchPlan { scenario, method, seed, .. } = plan;
    let elsewhere = |acts| matches!(acts, Acts::Host | Acts::Wire);
    let divisible = scenario.source.is_plant_alone()
        && matches!(scenario.endpoint, EndpointSpec::InProcess)
        && !scenario.realtime.by_clock
        && !scenario.faults.iter().any(|fault| elsewhere(fault.spec.kind.acts));
    if !divisible {
        return None;
    }
    // What can't be set up says so when it runs alone.
    let (plant, core, draws) = configurations(scenario, *method, *seed).ok()?;
    let samples = scenario.samples()?;
    let work = PlannedWork::of(scenario, *method, &core, Tells::ALL, None);
    Some((Beginning { plant, core, samples, work }, draws))
}

/// State of a run after a step.
#[derive(Clone, Debug)]
pub(super) struct Parts {
    pub(super) source: PlantSource,
    pub(super) endpoint: InProcess,
    pub(super) steps: Steps,
    pub(super) watcher: Watcher,
    pub(super) revision: u32,
    /// How the trunk ended; `None`: it goes on.
    pub(super) ended: Option<Ended>,
}

/// A run that goes on alone from where it branches off.
pub(super) struct Branch {
    pub(super) index: usize,
    pub(super) faulted: Option<Faulted>,
    pub(super) parts: Parts,
    pub(super) recorder: Recorder,
    pub(super) draws: DrawnValues,
}

impl Branch {
    fn run(self, plans: &[BranchPlan<'_>], told: &RunTold<'_>) {
        let index = self.index;
        told(index, self.finish(&plans[index]).and_then(method::whole));
    }

    pub(super) fn finish(self, plan: &BranchPlan<'_>) -> Result<MethodRun, MethodError> {
        let Self { mut faulted, parts, mut recorder, draws, .. } = self;
        let Parts { mut source, mut endpoint, mut steps, mut watcher, revision, ended } = parts;
        let books = Books::new(&mut recorder, &mut watcher, faulted.as_ref());
        let look_every = CONTROL_EPOCHS;
        let mut keeper = InTime { books, control: plan.control, look_every, revision };
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
        let truth = Some(draws.parameters);
        let run = method::finish(plan.scenario, plan.method, closed, recorder, watcher, truth)?;
        let receipts = faulted.map_or_else(Vec::new, |faulted| faulted.station.receipts());
        Ok(MethodRun { receipts, ..run })
    }
}

/// The run without faults, from which others branch off.
struct Trunk<'a, 'b> {
    plans: &'b [BranchPlan<'a>],
    group: &'b Group,
    keeping: StreamKeeping<'b>,
    told: &'b RunTold<'b>,
    waiting: &'b Waiting<Task>,
}

impl Trunk<'_, '_> {
    /// Runs it as far as a run needs it; returns the runs that couldn't branch off.
    fn run(&self) -> Vec<usize> {
        let mut waits = Waits::default();
        for index in &self.group.runs {
            match self.faulted(*index) {
                Ok(faulted) => waits.runs.push((*index, faulted)),
                Err(_) => waits.alone.push(*index),
            }
        }
        // A failure takes those that wait to their own runs.
        _ = self.drive(&mut waits);
        waits.alone.extend(waits.runs.into_iter().map(|(index, _)| index));
        waits.alone
    }

    fn faulted(&self, index: usize) -> Result<Option<Faulted>, SetupError> {
        let BranchPlan { scenario, seed, .. } = self.plans[index];
        let mut faulted = method::faulted(scenario, seed)?;
        if let Some(faulted) = &mut faulted {
            faulted.host = RunHost::new(scenario, &self.keeping, &RecorderTrouble::default())?;
        }
        Ok(faulted)
    }

    fn drive(&self, waits: &mut Waits) -> Result<(), MethodError> {
        let Beginning { plant, core, samples, work } = &self.group.beginning;
        let mut source = PlantSource::new(plant, *samples).map_err(SetupError::Plant)?;
        let mut endpoint = InProcess::new(core).map_err(SetupError::Core)?;
        let mut recorder = self.recorder()?;
        let mut watcher = Watcher::new(work.clone());
        watcher.trace = match self.keeping {
            StreamKeeping::HashAlone => None,
            StreamKeeping::Hash | StreamKeeping::None | StreamKeeping::File(_) => {
                Some(RunTrace::new())
            }
        };
        let mut steps = Steps::new(source.samples_total());
        // The controls are looked at here: each has its own run.
        let control = Control::default();
        let books = Books::new(&mut recorder, &mut watcher, None);
        let mut keeper =
            InTime { books, control: &control, look_every: CONTROL_EPOCHS, revision: 0 };
        let mut ended = None;
        while ended.is_none() && !waits.runs.is_empty() {
            let number = steps.number();
            if number.is_multiple_of(CONTROL_EPOCHS) && self.is_cancelled(waits, number) {
                ended = Some(Ended::Cancelled);
                break;
            }
            while let Some((index, faulted)) = waits.due(&steps, &source) {
                let parts = (&source, &endpoint, &steps, &mut keeper);
                self.branch(waits, (index, Some(faulted)), parts, None);
            }
            ended = steps.step(&mut source, waits, &mut endpoint, &mut keeper)?;
        }
        for waiting in std::mem::take(&mut waits.runs) {
            let parts = (&source, &endpoint, &steps, &mut keeper);
            self.branch(waits, waiting, parts, ended);
        }
        Ok(())
    }

    fn recorder(&self) -> Result<Recorder, SetupError> {
        let Some(first) = self.group.runs.first().map(|index| &self.plans[*index]) else {
            return Ok(Recorder::none());
        };
        let draws = &self.group.draws;
        let told = (true, Tells::ALL);
        let options = recorder_options(first.scenario, first.seed, draws, first.method, told);
        self.keeping.start(&options).map_err(SetupError::Recorder)
    }

    /// Tells the runs that wait how far they are; true if the end of one was asked for.
    fn is_cancelled(&self, waits: &Waits, epochs: u64) -> bool {
        let look = |(index, _): &&(usize, _)| self.plans[*index].control.look(epochs);
        waits.runs.iter().filter(look).count() > 0
    }

    /// Lets a run go on alone: on another thread, or here where none has time.
    fn branch(
        &self,
        waits: &mut Waits,
        (index, faulted): (usize, Option<Faulted>),
        (source, endpoint, steps, keeper): (&PlantSource, &InProcess, &Steps, &mut InTime<'_>),
        ended: Option<Ended>,
    ) {
        let Ok(recorder) = keeper.books.recorder.branch() else {
            waits.alone.push(index);
            return;
        };
        let mut watcher = keeper.books.watcher.clone();
        if faulted.is_none() && matches!(self.keeping, StreamKeeping::None) {
            watcher.trace = None;
        }
        let (source, endpoint, steps) = (source.clone(), endpoint.clone(), steps.clone());
        let revision = keeper.revision;
        let parts = Parts { source, endpoint, steps, watcher, revision, ended };
        let draws = self.group.draws.clone();
        let branch = Box::new(Branch { index, faulted, parts, recorder, draws });
        if let Some(Task::Branch(branch)) = self.waiting.add(Task::Branch(branch)) {
            branch.run(self.plans, self.told);
        }
    }
}

/// Returns whether a fault sets in at the next step; by hand too.
pub(super) fn is_due(faulted: &Faulted, steps: &Steps, source: &PlantSource) -> bool {
    let next = steps.number() + 1;
    faulted.fires.iter().any(|(at, _)| *at == next)
        || faulted.station.sets_in_next(steps.output(), || source.truth())
}

/// A run on its way.
pub(super) type Going<'a, 'b> =
    (&'a mut PlantSource, &'a mut InProcess, &'a mut InTime<'b>, &'a mut Steps);

/// Takes steps until a fault sets in at the next one; returns the end, where the run ends before.
pub(super) fn until_due(
    (source, endpoint, keeper, steps): Going<'_, '_>,
    faulted: &mut Faulted,
    other: &Control,
) -> Result<Option<Ended>, RunError> {
    loop {
        if is_due(faulted, steps, source) {
            return Ok(None);
        }
        if steps.number().is_multiple_of(CONTROL_EPOCHS) {
            // The end of the other one is asked for together with that of this one.
            _ = other.look(steps.number());
        }
        if let Some(ended) = steps.step(source, faulted, endpoint, keeper)? {
            return Ok(Some(ended));
        }
    }
}

/// Runs that haven't branched off. Their stations see what goes by and change nothing.
#[derive(Default)]
struct Waits {
    /// Their places, with the faults of those that have some.
    runs: Vec<(usize, Option<Faulted>)>,
    /// Runs that have to be undivided.
    alone: Vec<usize>,
}

impl Waits {
    /// Takes out a run of which a fault sets in at the next step.
    fn due(&mut self, steps: &Steps, source: &PlantSource) -> Option<(usize, Faulted)> {
        let is_due = |faulted: &Faulted| is_due(faulted, steps, source);
        let at = self.runs.iter().position(|(_, faulted)| faulted.as_ref().is_some_and(is_due))?;
        let (index, faulted) = self.runs.remove(at);
        Some((index, faulted?))
    }

    fn stations(&mut self) -> impl Iterator<Item = &mut Faulted> {
        self.runs.iter_mut().filter_map(|(_, faulted)| faulted.as_mut())
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

    fn after(&mut self, epoch: &Epoch, output: &Output) -> Delivered<'_> {
        for faulted in self.stations() {
            faulted.station.after(epoch, output);
        }
        Delivered::Untouched
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
