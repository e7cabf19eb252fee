//! The one owner of a run: source, faults, endpoint, recorder and observers.
//!
//! A [`Bench`] is opened from a [`Plan`], which names each policy once. It takes steps; whoever holds it says only
//! *when*: to the end, until something is reached, one at a time, by the clock. `branch` makes a second run that
//! goes on from here. [`Bench::close`] ends it. [`steps`] has the loop, `records` what is kept.

pub(crate) mod attended;
pub mod closed;
pub mod ended;
pub mod error;
pub mod faulted;
pub mod host;
pub mod interfere;
pub mod plan;
pub mod recording;
pub(crate) mod records;
pub(crate) mod set_up;
pub mod steps;
pub mod unit;
mod wire_account;

pub use records::Records;

use self::attended::Attended;
use self::ended::{Ended, RunError};
use self::error::SetupError;
use self::faulted::Faulted;
use self::plan::{Looks, Plan, Ready};
use self::recording::recorder_options;
use self::set_up::{Line, SetUp};
use self::steps::{Injects, Keeps, NoFaults, Steps};
use crate::observers::Observers;
use crate::observers::done::PlannedWork;
use crate::observers::session::SessionTrack;
use ended::TimeKeeping;
use octant_base::control::Control;
use octant_endpoint::{Endpoint, InProcess};
use octant_recorder::{Recorder, RecorderError, RecorderOptions};
use octant_sample::{Epoch, Output};
use octant_scenario::Scenario;
use octant_source::{PlantSource, Source};

/// A run under way. Its type parameters are source, endpoint and what keeps its results, so that each combination is
/// compiled for itself.
#[derive(Debug)]
pub struct Bench<S, E, K = Records<'static>> {
    /// Source of samples.
    pub source: S,
    /// Endpoint with the core.
    pub endpoint: E,
    /// Faults of the run itself.
    pub faulted: Option<Faulted>,
    pub(crate) steps: Steps,
    /// Keeper of the results.
    pub keeper: K,
    /// How the run ended; `None`: it goes on.
    pub ended: Option<Result<Ended, RunError>>,
    /// Time keeping of a run by the clock.
    pub kept: Option<TimeKeeping>,
}

impl<S: Source, E: Endpoint, K: Keeps<S, E>> Bench<S, E, K> {
    /// Creates a run of parts that are there.
    pub(crate) fn with(source: S, endpoint: E, faulted: Option<Faulted>, keeper: K) -> Self {
        let total = source.samples_total().filter(|_| faulted.is_some());
        let steps = Steps::new(total);
        Self { source, endpoint, faulted, steps, keeper, ended: None, kept: None }
    }

    /// Lets the run end with the source's last sample, before the source is asked for one more.
    pub(crate) fn end_with_source(&mut self) {
        if let Some(total) = self.source.samples_total() {
            self.steps.last(total);
        }
    }

    /// Takes one step; false if the run is over, after a failure too.
    pub fn step(&mut self) -> bool {
        let Self { source, endpoint, faulted, steps, keeper, ended, .. } = self;
        if ended.is_some() {
            return false;
        }
        let stepped = match faulted {
            None => steps.step(source, &mut NoFaults, endpoint, keeper),
            Some(faulted) => steps.step(source, faulted, endpoint, keeper),
        };
        noted(stepped, ended)
    }

    /// Takes one step with something else than the run's own faults between source and endpoint.
    pub(crate) fn step_through<F: Injects<S, E>>(&mut self, faults: &mut F) -> bool {
        let Self { source, endpoint, steps, keeper, ended, .. } = self;
        ended.is_none() && noted(steps.step(source, faults, endpoint, keeper), ended)
    }

    /// Takes steps until this is reached before one of them, or the run is over.
    pub(crate) fn run_until(&mut self, mut is_reached: impl FnMut(&mut Self) -> bool) {
        while self.ended.is_none() && !is_reached(self) {
            self.step();
        }
    }

    /// Takes steps until the run is over.
    pub fn run(&mut self) {
        let Self { source, endpoint, faulted, steps, keeper, ended, .. } = self;
        if ended.is_none() {
            *ended = Some(match faulted {
                None => steps.go_on(source, &mut NoFaults, endpoint, keeper),
                Some(faulted) => steps.go_on(source, faulted, endpoint, keeper),
            });
        }
    }

    /// Takes steps as [`Self::run`], with something else than the run's own faults between source and endpoint.
    pub(crate) fn run_through<F: Injects<S, E>>(&mut self, faults: &mut F) {
        let Self { source, endpoint, steps, keeper, ended, .. } = self;
        if ended.is_none() {
            *ended = Some(steps.go_on(source, faults, endpoint, keeper));
        }
    }

    /// Ends a run of which nothing is recorded.
    ///
    /// # Errors
    /// If the run failed.
    pub(crate) fn end(self) -> Result<(Ended, S, E, K), RunError> {
        let ended = self.ended.unwrap_or(Ok(Ended::Cancelled))?;
        Ok((ended, self.source, self.endpoint, self.keeper))
    }

    /// Epoch that the source delivered in the last step.
    pub fn epoch(&self) -> &Epoch {
        self.steps.epoch()
    }

    /// Last answer of the endpoint.
    pub fn output(&self) -> &Output {
        self.steps.output()
    }
}

/// Notes the end of a run in a step; true if it goes on.
pub(crate) fn noted(
    stepped: Result<Option<Ended>, RunError>,
    ended: &mut Option<Result<Ended, RunError>>,
) -> bool {
    *ended = stepped.transpose();
    ended.is_none()
}

impl<'a, S: Source, E: Endpoint> Bench<S, E, Records<'a>> {
    /// Creates a run of parts that are there, with its recorder and observers.
    pub fn of_parts(
        source: S,
        endpoint: E,
        faulted: Option<Faulted>,
        records: Records<'a>,
    ) -> Self {
        let mut bench = Self::with(source, endpoint, faulted, records);
        bench.keeper.name(bench.faulted.as_ref());
        bench
    }

    /// Opens a run: its faults are set up, then source and endpoint are opened by `line`, then the recorder starts.
    pub(crate) fn open(
        plan: &Plan<'a>,
        ready: Ready,
        mut set_up: SetUp,
        line: impl FnOnce(&mut SetUp, &Scenario) -> Result<Line<S, E>, SetupError>,
    ) -> Result<Self, SetupError> {
        let Plan { scenario, method, seed, control, recording, .. } = *plan;
        let Ready { faulted, trouble } = ready;
        let Line { source, endpoint, recorded } = line(&mut set_up, scenario)?;
        let SetUp { core, draws, .. } = set_up;
        let tells = endpoint.tells();
        let knows = source.has_true_parameters();
        let options = recorder_options(scenario, method, seed, &draws, knows, tells);
        let recorder = recording.start(&RecorderOptions { trouble, ..options })?;
        let work = PlannedWork::of(scenario, method, &core, tells, recorded);
        let mut observers = Observers::new(work);
        observers.trace = plan.trace.then(octant_score::trace::RunTrace::new);
        observers.session =
            plan.session.map(|session| Box::new(SessionTrack::of(session, tells.attitude)));
        observers.charts = plan.drawn();
        observers.read_headings_of(scenario);
        let mut bench =
            Self::of_parts(source, endpoint, faulted, Records::new(recorder, observers, control));
        bench.steps.switch(scenario.power_cycles());
        let records = &mut bench.keeper;
        records.truth = knows.then_some(draws);
        records.attended = Attended::of(scenario, method, control);
        let always = plan.looks == Looks::Always || bench.source.is_live();
        if always || records.attended.is_some() {
            records.look_every = 1;
        }
        Ok(bench)
    }

    /// Hands the run over to a host program, which ends it by not going on.
    pub(crate) fn under_nobody(self) -> Bench<S, E> {
        let Self { source, endpoint, faulted, steps, keeper, ended, kept } = self;
        let keeper = keeper.under_nobody();
        Bench { source, endpoint, faulted, steps, keeper, ended, kept }
    }
}

impl Bench<PlantSource, InProcess, Records<'_>> {
    /// Makes a second run that goes on from here with other faults, or none. It writes no file.
    ///
    /// # Errors
    /// If the recorder failed.
    pub(crate) fn branch<'b>(
        &mut self,
        faulted: Option<Faulted>,
        control: &'b Control,
    ) -> Result<Bench<PlantSource, InProcess, Records<'b>>, RecorderError> {
        let recorder = self.keeper.recorder.branch()?;
        Ok(self.copy(recorder, faulted, control))
    }

    /// Copies the run, with a recorder that goes on from here. One that failed isn't copied.
    pub(crate) fn copy<'b>(
        &self,
        recorder: Recorder,
        faulted: Option<Faulted>,
        control: &'b Control,
    ) -> Bench<PlantSource, InProcess, Records<'b>> {
        let mut copy = Bench {
            source: self.source.clone(),
            endpoint: self.endpoint.clone(),
            steps: self.steps.clone(),
            keeper: self.keeper.copy(recorder, control),
            faulted,
            ended: self.ended.as_ref().and_then(|ended| ended.as_ref().ok()).map(|e| Ok(*e)),
            kept: None,
        };
        copy.keeper.name(copy.faulted.as_ref());
        copy
    }

    /// Returns whether a fault sets in at the next step; by hand too.
    pub(crate) fn is_fault_due(&self, faulted: &Faulted) -> bool {
        let next = self.steps.number() + 1;
        faulted.fires.iter().any(|(at, _)| *at == next)
            || faulted.station.sets_in_next(self.steps.output(), || self.source.truth())
    }
}
