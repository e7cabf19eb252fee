//! The station between source and endpoint: an ordered pipeline of faults.
//!
//! An epoch passes the station in two steps. [`Station::before`] is called before the source makes
//! the epoch: triggers are evaluated, and faults of plant and set point act. [`Station::after`] is
//! called with the epoch that the source has made: faults of samples and delivery act on it, in the
//! order of the scenario. The effect of an active fault is found by comparing before and after; that of a fault inside
//! the plant by comparing with a plant without it.

mod onsets;
mod passage;
mod stage;
mod state;

use super::rule::Hosted;
use crate::catalogue::{Acts, FaultKind, Lasts};
use crate::receipt::{Ledger, Receipt};
use crate::rule::{FaultRule, SetPoints, UnitEvent};
use crate::setup::{FaultBuildError, Setup};
use crate::trigger::{Clock, News, Scene, Schedule, Trigger};
use crate::values::Values;
use crate::wire::Wired;
use alloc::collections::VecDeque;
use alloc::string::String;
use alloc::vec::Vec;
use octant_random::stream::Phase;
use octant_sample::disturbance::Disturbed;
use octant_sample::{Epoch, GimbalCommand, Output, Truth};
use octant_state::StateError;

use stage::{Shared, Stage};

pub use state::FORMAT as STATE_FORMAT;

/// One fault of a scenario.
#[derive(Clone, Debug)]
pub struct FaultSpec {
    /// Id, unique in the run.
    pub id: String,
    /// Kind of the fault.
    pub kind: &'static FaultKind,
    /// Values of every parameter of the kind.
    pub values: Values,
    /// Time of the fault.
    pub schedule: Schedule,
}

/// Environment on which a station acts beside samples.
pub trait World {
    /// The plant, if the source is one.
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed>;
    /// The wire to the unit under test, if there is one.
    fn wired(&mut self) -> Option<&mut dyn Wired> {
        None
    }
    /// The host of the harness, if faults can act on it.
    fn host(&mut self) -> Option<&mut dyn Hosted> {
        None
    }
    /// Truth at the last epoch, if the source knows it.
    fn truth(&self) -> Option<Truth>;
}

/// Result of the pipeline for an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Delivered<'a> {
    /// No fault is active: the epoch is passed on unchanged.
    Untouched,
    /// These epochs are passed on instead: none, one or several.
    These(&'a [Epoch]),
}

/// Result of the pipeline for an epoch, with what it would have been.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passed<'a> {
    /// What is delivered.
    pub delivered: Delivered<'a>,
    /// The epoch as the plant would have delivered it without faults inside it, to the same set points; `None` if no
    /// fault inside it has an effect.
    pub undisturbed: Option<&'a Epoch>,
}

/// Onset or end of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Occurrence {
    /// Epoch of the source.
    pub epoch: u64,
    /// Number of the fault in the scenario, from 0.
    pub fault: usize,
    /// True at an onset, false at an end.
    pub begins: bool,
}

/// Progress of a fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// True while the fault lasts or fades, and, inside the plant, until its effect is over.
    pub active: bool,
    /// Number of onsets.
    pub firings: u32,
    /// Epochs altered; see [`Receipt::samples_altered`].
    pub samples_altered: u64,
}

/// Largest number of epochs that one delivery fault can hold back.
pub const FLIGHT_MAX: usize = 4096;
/// Largest number of epochs that all faults together can deliver in one step of the source.
pub const BURST_MAX: usize = 16 * FLIGHT_MAX;
/// Largest number of occurrences kept until the harness reads them.
const OCCURRENCES_MAX: usize = 256;

/// The pipeline of one run.
#[derive(Debug)]
pub struct Station {
    stages: Vec<Stage>,
    dt_s: f64,
    calibration_samples: u64,
    /// Number of epochs so far.
    epoch: u64,
    /// The next epoch at which time alone changes something.
    wake: u64,
    /// The scene of the epoch before; 0: none yet.
    seen: u32,
    scene: Option<Scene>,
    /// True if a stage is engaged, or has a condition to be evaluated in every epoch.
    busy: bool,
    /// True if a fault has disturbed the plant, so that epochs are compared.
    compares: bool,
    conditions: bool,
    truth: bool,
    /// First epoch from which epochs are remembered.
    remember: u64,
    /// True if faults act on set points; they need the earlier ones.
    commands: bool,
    set_points: SetPoints,
    last: Epoch,
    /// The present epoch as the plant would have delivered it without faults inside it, if there are any.
    undisturbed: Epoch,
    flight: Vec<Epoch>,
    landed: Vec<Epoch>,
    /// Capacity of both buffers, epochs.
    burst: usize,
    occurrences: Vec<Occurrence>,
    events: Vec<UnitEvent>,
    without_power: bool,
}

/// Reserves as much room as the original has, so that the clone doesn't allocate either.
impl Clone for Station {
    fn clone(&self) -> Self {
        let room = |of: &Vec<Epoch>| {
            let mut epochs = Vec::with_capacity(of.capacity());
            epochs.extend_from_slice(of);
            epochs
        };
        let mut occurrences = Vec::with_capacity(self.occurrences.capacity());
        occurrences.extend_from_slice(&self.occurrences);
        let mut events = Vec::with_capacity(self.events.capacity());
        events.extend_from_slice(&self.events);
        Self {
            stages: self.stages.clone(),
            flight: room(&self.flight),
            landed: room(&self.landed),
            occurrences,
            events,
            ..*self
        }
    }
}

impl Station {
    /// Makes a station with the faults in the order in which they act.
    ///
    /// # Errors
    /// If a fault's values contradict each other, an id is given twice, or a fault waits for one
    /// that isn't there.
    pub fn new(specs: &[FaultSpec], setup: &Setup) -> Result<Self, (String, FaultBuildError)> {
        let mut stages: Vec<Stage> = Vec::with_capacity(specs.len());
        for spec in specs {
            let stage = Self::stage(spec, specs, &stages, setup);
            stages.push(stage.map_err(|error| (spec.id.clone(), error))?);
        }
        let burst = burst(&stages)?;
        let mut station = Self {
            stages,
            dt_s: setup.dt_s(),
            calibration_samples: setup.calibration_samples,
            epoch: 0,
            wake: 0,
            seen: 0,
            scene: None,
            busy: false,
            compares: false,
            conditions: false,
            truth: false,
            remember: u64::MAX,
            commands: false,
            set_points: SetPoints::default(),
            last: Epoch::default(),
            undisturbed: Epoch::default(),
            flight: Vec::with_capacity(burst),
            landed: Vec::with_capacity(burst),
            burst,
            occurrences: Vec::with_capacity(OCCURRENCES_MAX),
            events: Vec::with_capacity(specs.len() + 1),
            without_power: false,
        };
        station.survey();
        Ok(station)
    }

    /// Makes the station with some of its faults, selected by their numbers from 0, at the same epoch. No fault has set in
    /// so far.
    #[must_use]
    pub fn with_only(&self, keep: impl Fn(usize) -> bool) -> Self {
        let mut some = self.clone();
        let mut numbers = 0..;
        some.stages.retain(|_| numbers.next().is_some_and(&keep));
        some.survey();
        some
    }

    /// Notes what the faults of the station need.
    fn survey(&mut self) {
        self.conditions = self.stages.iter().any(|stage| stage.clock.has_condition());
        self.truth = self.stages.iter().any(|stage| stage.clock.needs_truth());
        self.commands = self.stages.iter().any(|stage| matches!(stage.rule, FaultRule::Command(_)));
        self.plan();
    }

    fn stage(
        spec: &FaultSpec,
        specs: &[FaultSpec],
        before: &[Stage],
        setup: &Setup,
    ) -> Result<Stage, FaultBuildError> {
        if before.iter().any(|stage| stage.id == spec.id) {
            return Err(FaultBuildError::DuplicateId(spec.id.clone()));
        }
        if let Trigger::After { fault, .. } = &spec.schedule.trigger
            && !specs.iter().any(|other| other.id == *fault && other.id != spec.id)
        {
            return Err(FaultBuildError::NoSuchFault { id: spec.id.clone(), after: fault.clone() });
        }
        let mut schedule = spec.schedule.clone();
        match spec.kind.lasts {
            Lasts::Fading => {}
            Lasts::Span if schedule.recovery > 0 => {
                let problem = "this kind doesn't fade: it is there or it isn't";
                return Err(FaultBuildError::value("recovery", problem));
            }
            Lasts::Span => {}
            Lasts::Instant => (schedule.duration, schedule.recovery) = (Some(1), 0),
        }
        if schedule.duration == Some(0) {
            return Err(FaultBuildError::value(
                "duration",
                "less than a sample, at least one is expected",
            ));
        }
        let setup = Setup { id: spec.id.clone(), ..setup.clone() };
        let rule = (spec.kind.build)(&spec.values, &setup)?;
        let clock = Clock::new(schedule, setup.stream("trigger").key(Phase::Calibration));
        Ok(Stage {
            id: spec.id.clone(),
            kind: spec.kind,
            rule,
            clock,
            ledger: Ledger::default(),
            fresh: false,
            compares: false,
            goes_on: false,
        })
    }

    /// Determines the next epochs at which the station has work.
    fn plan(&mut self) {
        self.wake = self.stages.iter().map(|stage| stage.clock.wake()).min().unwrap_or(u64::MAX);
        self.remember = self.stages.iter().map(Stage::looks_back_from).min().unwrap_or(u64::MAX);
        self.busy = self.conditions || self.stages.iter().any(Stage::engaged);
        self.compares = self.stages.iter().any(|stage| stage.compares);
    }

    /// Prepares the source's next epoch: `command` is the set point from the core for the source,
    /// `output` the core's last output.
    ///
    /// Equivalent to [`Self::begin`], then [`Self::command`]. A caller that gets the command later,
    /// but before the source does, calls these one by one.
    #[inline]
    pub fn before(&mut self, command: &mut GimbalCommand, output: &Output, world: &mut dyn World) {
        self.begin(output, world);
        self.command(command, output);
    }

    /// Begins the next epoch: onsets and ends of faults, and the faults of the plant and of the
    /// unit under test.
    #[inline]
    pub fn begin(&mut self, output: &Output, world: &mut dyn World) {
        // 64 bits of epochs don't overflow, and a state with so many isn't loaded.
        self.epoch = self.epoch.wrapping_add(1);
        if self.epoch >= self.wake || self.busy || Scene::of(output).packed() != self.seen {
            self.look(output, world);
        }
    }

    /// Returns whether a fault sets in at the next epoch, after this output of the core. What the station has
    /// seen so far has to be untouched by faults; a fault that is fired by hand isn't known in advance.
    ///
    /// A run with faults is its twin up to the epoch before: the station changes nothing until then.
    #[inline]
    #[must_use]
    pub fn sets_in_next(&self, output: &Output, truth: impl FnOnce() -> Option<Truth>) -> bool {
        let epoch = self.epoch + 1;
        if epoch < self.wake && !self.busy && Scene::of(output).packed() == self.seen {
            return false;
        }
        let truth = if self.truth { truth() } else { None };
        let (before, scene) = (self.scene, Scene::of(output));
        let news = News { epoch, before, scene, output, truth: truth.as_ref() };
        self.stages.iter().any(|stage| stage.clock.sets_in(&news))
    }

    /// Lets faults act on the set point of the present epoch.
    #[inline]
    pub fn command(&mut self, command: &mut GimbalCommand, output: &Output) {
        if self.commands && (self.busy || *command != self.set_points.last) {
            self.act_on(command, output);
        }
    }

    /// Returns whether the station has nothing to do with the epoch that the source has made.
    #[inline]
    #[must_use]
    pub fn is_idle(&self) -> bool {
        !self.busy && !self.compares && self.epoch < self.remember
    }

    /// Compares the epoch that the source has made with those of plants without faults, and lets faults act on it on
    /// its way to the core.
    #[inline]
    pub fn after(&mut self, epoch: &Epoch, output: &Output, world: &mut dyn World) -> Passed<'_> {
        let compared = self.compares && self.compare(epoch, world);
        let mut touched = false;
        if self.busy {
            touched = self.pass(epoch, output);
        } else if self.epoch >= self.remember {
            self.last = *epoch;
        }
        Passed {
            delivered: if touched { Delivered::These(&self.flight) } else { Delivered::Untouched },
            undisturbed: compared.then_some(&self.undisturbed),
        }
    }

    fn shared(&self) -> Shared {
        let index = self.epoch - 1;
        let (phase, counter) = if index < self.calibration_samples {
            (Phase::Calibration, index)
        } else {
            (Phase::Navigation, index - self.calibration_samples)
        };
        let set_points = self.set_points;
        Shared { epoch: self.epoch, phase, counter, dt_s: self.dt_s, set_points }
    }

    /// Enters the frames that faults of the wire altered during the exchange of the present epoch
    /// into their receipts.
    pub fn exchanged(&mut self, wire: &mut dyn Wired) {
        let epoch = self.epoch;
        for (handle, stage) in self.stages.iter_mut().enumerate() {
            if matches!(stage.rule, FaultRule::Wire(_)) {
                stage.ledger.frames(epoch, &wire.altered(handle as u32));
            }
        }
    }

    /// Events of the unit under test in this epoch, to happen before the unit gets the epoch.
    /// Almost always empty.
    #[inline]
    #[must_use]
    pub fn unit_events(&self) -> &[UnitEvent] {
        &self.events
    }

    /// Onsets and ends since the last call of [`Self::told`].
    #[inline]
    #[must_use]
    pub fn occurrences(&self) -> &[Occurrence] {
        &self.occurrences
    }

    /// Clears the unit events and occurrences once they are handled.
    pub fn told(&mut self) {
        self.events.clear();
        self.occurrences.clear();
    }

    /// Lets a fault with a manual trigger set in at the next epoch. Returns false if no fault of
    /// that id waits.
    pub fn fire(&mut self, id: &str) -> bool {
        let next = self.epoch + 1;
        let fired = self
            .stages
            .iter_mut()
            .find(|stage| stage.id == id && *stage.clock.trigger() == Trigger::Manual)
            .is_some_and(|stage| stage.clock.fire(next));
        self.plan();
        fired
    }

    /// Ends a fault with a manual trigger at the next epoch, as at the end of its duration; a fault
    /// that would set in at that epoch doesn't. Returns false if no fault of that id lasts.
    pub fn end(&mut self, id: &str) -> bool {
        let next = self.epoch + 1;
        let ended = self
            .stages
            .iter_mut()
            .find(|stage| stage.id == id && *stage.clock.trigger() == Trigger::Manual)
            .is_some_and(|stage| stage.clock.cut(next));
        self.plan();
        ended
    }

    /// Progress of a fault, by its number in the scenario from 0.
    #[must_use]
    pub fn progress(&self, fault: usize) -> Option<Progress> {
        self.stages.get(fault).map(|stage| Progress {
            active: stage.acting() || stage.goes_on,
            firings: stage.clock.firings,
            samples_altered: stage.ledger.altered(),
        })
    }

    /// Largest number of epochs that can be delivered in one step of the source.
    #[must_use]
    pub fn most_delivered(&self) -> usize {
        self.burst
    }

    /// Returns whether any fault acts at a place.
    #[must_use]
    pub fn acts_on(&self, place: Acts) -> bool {
        self.stages.iter().any(|stage| stage.kind.acts == place)
    }

    /// Ids of the faults, in order.
    pub fn ids(&self) -> impl Iterator<Item = &str> {
        self.stages.iter().map(|stage| stage.id.as_str())
    }

    /// Ids and kinds of the faults, in order.
    pub fn names(&self) -> impl Iterator<Item = (&str, &'static str)> {
        self.stages.iter().map(|stage| (stage.id.as_str(), stage.kind.name))
    }

    /// Receipts of all faults, in order.
    #[must_use]
    pub fn receipts(&self) -> Vec<Receipt> {
        self.stages
            .iter()
            .map(|stage| {
                let firings = stage.clock.firings;
                stage.ledger.receipt(&stage.id, stage.kind.name, firings)
            })
            .collect()
    }
}

/// Largest number of epochs that can leave the last stage in one step of the source.
fn burst(stages: &[Stage]) -> Result<usize, (String, FaultBuildError)> {
    let mut most = 1;
    for stage in stages {
        let FaultRule::Delivery(rule) = &stage.rule else { continue };
        most = rule.most_out(most);
        if most > BURST_MAX {
            let problem = alloc::format!(
                "with the faults before it, up to {most} epochs could be delivered in one step, at \
                 most {BURST_MAX} are possible"
            );
            return Err((stage.id.clone(), FaultBuildError::value("kind", problem)));
        }
    }
    Ok(most)
}

/// Checks that a loaded queue is not longer than can be held back, and reserves room for as much.
pub(super) fn check_queue<T>(queue: &mut VecDeque<T>) -> Result<(), StateError> {
    octant_state::check_below("queue", queue.len() as u64, FLIGHT_MAX as u64)?;
    queue.reserve_exact(FLIGHT_MAX - queue.len());
    Ok(())
}
