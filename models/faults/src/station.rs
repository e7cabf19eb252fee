//! The station between source and endpoint: an ordered pipeline of faults.
//!
//! An epoch passes it in two steps. [`Station::before`] is called before the source makes the
//! epoch: triggers are looked at, faults of plant and set point act. [`Station::after`] is called
//! with the epoch that the source has made: faults of samples and delivery act on it, in the order
//! of the scenario. What an active fault altered is found by comparing before and after it.

mod stage;
mod state;

use crate::catalogue::{Acts, Kind, Lasts};
use crate::disturbance::Disturbed;
use crate::host::Hosted;
use crate::receipt::{Ledger, Receipt};
use crate::rule::{Context, Rule, SetPoints, UnitEvent};
use crate::setup::{BuildError, Setup};
use crate::trigger::{Clock, News, Scene, Schedule, Trigger};
use crate::values::Values;
use crate::wire::Wired;
use alloc::string::String;
use alloc::vec::Vec;
use octant_random::stream::Phase;
use octant_sample::{Epoch, GimbalCommand, Output, Truth};

use stage::{Shared, Stage};

pub use state::FORMAT as STATE_FORMAT;

/// One fault of a scenario.
#[derive(Clone, Debug)]
pub struct Spec {
    /// Its id, one of its own.
    pub id: String,
    /// Its kind.
    pub kind: &'static Kind,
    /// Values of every parameter of the kind.
    pub values: Values,
    /// When.
    pub schedule: Schedule,
}

/// The world that a station acts on beside samples.
pub trait World {
    /// The plant, where the source is one.
    fn disturbed(&mut self) -> Option<&mut dyn Disturbed>;
    /// The wire to the unit under test, where there is one.
    fn wired(&mut self) -> Option<&mut dyn Wired> {
        None
    }
    /// The host of the harness, where something can happen to it.
    fn host(&mut self) -> Option<&mut dyn Hosted> {
        None
    }
    /// Truth at the last epoch, where the source knows it.
    fn truth(&self) -> Option<Truth>;
}

/// What became of an epoch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Delivered<'a> {
    /// No fault is active: the epoch goes on as it is.
    Untouched,
    /// These go on instead of it: none, one or several.
    These(&'a [Epoch]),
}

/// Something to tell about a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Occurrence {
    /// Epoch of the source.
    pub epoch: u64,
    /// Number of the fault in the scenario, from 0.
    pub fault: usize,
    /// It sets in, or it ends.
    pub begins: bool,
}

/// How a fault does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// It lasts, or fades.
    pub active: bool,
    /// How often it has set in.
    pub firings: u32,
    /// Epochs that it has altered; see [`Receipt::samples_altered`].
    pub samples_altered: u64,
}

/// Epochs that one delivery fault can hold back at most.
pub const FLIGHT_MAX: usize = 4096;
/// Epochs that can be delivered in one step of the source at most, by all faults together.
pub const BURST_MAX: usize = 16 * FLIGHT_MAX;
/// Occurrences kept between two looks of the harness.
const OCCURRENCES_MAX: usize = 256;

/// The pipeline of one run.
#[derive(Debug)]
pub struct Station {
    stages: Vec<Stage>,
    dt_s: f64,
    calibration_samples: u64,
    /// Epochs so far.
    epoch: u64,
    /// The next epoch at which time alone changes something.
    wake: u64,
    /// The scene of the epoch before; 0: none yet.
    seen: u32,
    scene: Option<Scene>,
    /// A stage is engaged, or has a condition that has to be looked at in every epoch.
    busy: bool,
    conditions: bool,
    truth: bool,
    /// Epochs from this one on are remembered.
    remember: u64,
    /// Faults act on set points, and want to know those before.
    commands: bool,
    set_points: SetPoints,
    last: Epoch,
    flight: Vec<Epoch>,
    landed: Vec<Epoch>,
    /// What both have room for.
    burst: usize,
    occurrences: Vec<Occurrence>,
    events: Vec<UnitEvent>,
    without_power: bool,
}

/// A clone has room for as much as the original: it doesn't allocate either.
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
    /// A station with the faults in the order in which they act.
    ///
    /// # Errors
    /// If a fault's values contradict each other, an id is given twice, or a fault waits for one
    /// that isn't there.
    pub fn new(specs: &[Spec], setup: &Setup) -> Result<Self, (String, BuildError)> {
        let mut stages: Vec<Stage> = Vec::with_capacity(specs.len());
        for spec in specs {
            let stage = Self::stage(spec, specs, &stages, setup);
            stages.push(stage.map_err(|error| (spec.id.clone(), error))?);
        }
        let conditions = stages.iter().any(|stage| stage.clock.has_condition());
        let truth = stages.iter().any(|stage| stage.clock.needs_truth());
        let commands = stages.iter().any(|stage| matches!(stage.rule, Rule::Command(_)));
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
            conditions,
            truth,
            remember: u64::MAX,
            commands,
            set_points: SetPoints::default(),
            last: Epoch::default(),
            flight: Vec::with_capacity(burst),
            landed: Vec::with_capacity(burst),
            burst,
            occurrences: Vec::with_capacity(OCCURRENCES_MAX),
            events: Vec::with_capacity(specs.len() + 1),
            without_power: false,
        };
        station.plan();
        Ok(station)
    }

    fn stage(
        spec: &Spec,
        specs: &[Spec],
        before: &[Stage],
        setup: &Setup,
    ) -> Result<Stage, BuildError> {
        if before.iter().any(|stage| stage.id == spec.id) {
            return Err(BuildError::DuplicateId(spec.id.clone()));
        }
        if let Trigger::After { fault, .. } = &spec.schedule.trigger
            && !specs.iter().any(|other| other.id == *fault && other.id != spec.id)
        {
            return Err(BuildError::NoSuchFault { id: spec.id.clone(), after: fault.clone() });
        }
        let mut schedule = spec.schedule.clone();
        match spec.kind.lasts {
            Lasts::Fading => {}
            Lasts::Span if schedule.recovery > 0 => {
                let problem = "this kind doesn't fade: it is there or it isn't";
                return Err(BuildError::value("recovery", problem));
            }
            Lasts::Span => {}
            Lasts::Instant => (schedule.duration, schedule.recovery) = (Some(1), 0),
        }
        if schedule.duration == Some(0) {
            return Err(BuildError::value(
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
        })
    }

    /// Looks what has to be looked at next.
    fn plan(&mut self) {
        self.wake = self.stages.iter().map(|stage| stage.clock.wake()).min().unwrap_or(u64::MAX);
        self.remember = self.stages.iter().map(Stage::looks_back_from).min().unwrap_or(u64::MAX);
        self.busy = self.conditions || self.stages.iter().any(Stage::engaged);
    }

    /// Before the source makes its next epoch: `command` is what it would get from the core,
    /// `output` the core's last output.
    ///
    /// This is [`Self::begin`], then [`Self::command`]. Who gets the command later, but before the
    /// source does, calls these one by one.
    #[inline]
    pub fn before(&mut self, command: &mut GimbalCommand, output: &Output, world: &mut dyn World) {
        self.begin(output, world);
        self.command(command, output);
    }

    /// The next epoch begins: what sets in and what ends with it, and faults of the plant and of the
    /// unit under test.
    #[inline]
    pub fn begin(&mut self, output: &Output, world: &mut dyn World) {
        self.epoch += 1;
        if self.epoch >= self.wake || self.busy || Scene::of(output).packed() != self.seen {
            self.look(output, world);
        }
    }

    /// Faults of set points act on that of the present epoch.
    #[inline]
    pub fn command(&mut self, command: &mut GimbalCommand, output: &Output) {
        if self.commands && (self.busy || *command != self.set_points.last) {
            self.act_on(command, output);
        }
    }

    /// Whether anything has to be done with the epoch that the source has made.
    #[inline]
    #[must_use]
    pub fn is_idle(&self) -> bool {
        !self.busy && self.epoch < self.remember
    }

    /// With the epoch that the source has made, on its way to the core.
    #[inline]
    pub fn after(&mut self, epoch: &Epoch, output: &Output) -> Delivered<'_> {
        if self.busy {
            return self.pass(epoch, output);
        }
        if self.epoch >= self.remember {
            self.last = *epoch;
        }
        Delivered::Untouched
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

    #[inline(never)]
    fn look(&mut self, output: &Output, world: &mut dyn World) {
        let scene = Scene::of(output);
        let truth = if self.truth { world.truth() } else { None };
        let news =
            News { epoch: self.epoch, before: self.scene, scene, output, truth: truth.as_ref() };
        for stage in &mut self.stages {
            stage.clock.look(&news);
        }
        (self.scene, self.seen) = (Some(scene), scene.packed());
        let shared = self.shared();
        let events = self.events.len();
        for index in 0..self.stages.len() {
            let stage = &mut self.stages[index];
            if stage.acts_unseen() {
                stage.ledger.touched_to(self.epoch - 1);
            }
            let ticked = stage.clock.tick(self.epoch);
            if ticked.ended {
                end(stage, index as u32, world);
                self.tell(index, false);
                self.tell_others(index);
            }
            if ticked.began {
                let stage = &mut self.stages[index];
                let now = stage.context(&shared, &self.last, output);
                begin(stage, index as u32, &now, world);
                stage.fresh = true;
                self.tell(index, true);
            }
            self.act_before(index, &shared, output);
        }
        self.settle_power(events);
        self.plan();
    }

    #[inline(never)]
    fn act_on(&mut self, command: &mut GimbalCommand, output: &Output) {
        let shared = self.shared();
        for stage in &mut self.stages {
            if !stage.acting() {
                continue;
            }
            let now = stage.context(&shared, &self.last, output);
            if let Rule::Command(rule) = &mut stage.rule {
                let clean = *command;
                rule.on_command(command, &now);
                if *command != clean {
                    stage.ledger.touched(shared.epoch);
                    stage.ledger.commands(&clean, command);
                }
            }
        }
        if *command != self.set_points.last {
            self.set_points = SetPoints { last: *command, before: self.set_points.last };
        }
    }

    /// Power goes with the first fault that cuts it and comes back with the last; `from`: number of
    /// events that there were before this epoch.
    fn settle_power(&mut self, from: usize) {
        let without = self.stages.iter().any(Stage::cuts_power);
        match (self.without_power, without) {
            (false, false) => return,
            // Whatever else happens to it in this epoch is forgotten with its state.
            (false, true) => {
                self.events.truncate(from);
                self.events.push(UnitEvent::PowerOff);
            }
            (true, true) => self.events.truncate(from),
            (true, false) => self.events.insert(from, UnitEvent::PowerOn),
        }
        self.without_power = without;
    }

    /// Those that wait for a fault hear that it has ended.
    fn tell_others(&mut self, ended: usize) {
        for other in 0..self.stages.len() {
            let waits = matches!(
                self.stages[other].clock.trigger(),
                Trigger::After { fault, .. } if *fault == self.stages[ended].id
            );
            if waits {
                self.stages[other].clock.other_ended(self.epoch);
            }
        }
    }

    fn tell(&mut self, fault: usize, begins: bool) {
        // The harness looks after every epoch; more than that in one step can't be told.
        if self.occurrences.len() < OCCURRENCES_MAX {
            self.occurrences.push(Occurrence { epoch: self.epoch, fault, begins });
        }
    }

    fn act_before(&mut self, index: usize, shared: &Shared, output: &Output) {
        let stage = &mut self.stages[index];
        if !stage.acting() {
            return;
        }
        let now = stage.context(shared, &self.last, output);
        match &mut stage.rule {
            Rule::Unit(rule) => {
                let event = rule.on_epoch(&now);
                // What happens to a unit that is without power already alters nothing.
                if rule.cuts_power() || (event.is_some() && !self.without_power) {
                    stage.ledger.touched(shared.epoch);
                }
                self.events.extend(event);
            }
            Rule::Plant(_) => stage.ledger.touched(shared.epoch),
            Rule::Command(_)
            | Rule::Samples(_)
            | Rule::Delivery(_)
            | Rule::Wire(_)
            | Rule::Host(_) => {}
        }
    }

    #[inline(never)]
    fn pass(&mut self, epoch: &Epoch, output: &Output) -> Delivered<'_> {
        let shared = self.shared();
        self.flight.clear();
        self.flight.push(*epoch);
        let mut engaged = false;
        for stage in &mut self.stages {
            if !stage.engaged() {
                continue;
            }
            let acting = stage.acting();
            let instant = stage.kind.lasts == Lasts::Instant;
            let now = stage.context(&shared, &self.last, output);
            match &mut stage.rule {
                Rule::Samples(rule) => {
                    engaged = true;
                    for epoch in &mut self.flight {
                        let clean = *epoch;
                        if stage.fresh && (acting || instant) {
                            let strength = if acting { now.strength } else { 1.0 };
                            rule.on_epoch(epoch, &Context { since_onset: 0, strength, ..now });
                            stage.fresh = false;
                        } else if acting && !instant {
                            let since_onset = now.since_onset.max(1);
                            rule.on_epoch(epoch, &Context { since_onset, ..now });
                        } else if rule.lingers() {
                            rule.afterwards(epoch, &now);
                        }
                        if !epoch.same_bits(&clean) {
                            stage.ledger.touched(shared.epoch);
                            stage.ledger.clean(&clean);
                            stage.ledger.faulted(epoch);
                        }
                    }
                }
                Rule::Delivery(rule) => {
                    engaged = true;
                    self.landed.clear();
                    rule.on_step(&self.flight, acting, &now, &mut self.landed);
                    debug_assert!(self.landed.len() <= self.burst, "{} allocates", stage.kind.name);
                    if !same(&self.flight, &self.landed) {
                        stage.ledger.touched(shared.epoch);
                        self.flight.iter().for_each(|epoch| stage.ledger.clean(epoch));
                        self.landed.iter().for_each(|epoch| stage.ledger.faulted(epoch));
                    }
                    core::mem::swap(&mut self.flight, &mut self.landed);
                }
                Rule::Plant(_)
                | Rule::Command(_)
                | Rule::Unit(_)
                | Rule::Wire(_)
                | Rule::Host(_) => {}
            }
        }
        self.last = *epoch;
        self.plan();
        if engaged { Delivered::These(&self.flight) } else { Delivered::Untouched }
    }

    /// What faults of the wire altered while the present epoch was exchanged goes into their receipts.
    pub fn exchanged(&mut self, wire: &mut dyn Wired) {
        let epoch = self.epoch;
        for (handle, stage) in self.stages.iter_mut().enumerate() {
            if matches!(stage.rule, Rule::Wire(_)) {
                stage.ledger.frames(epoch, &wire.altered(handle as u32));
            }
        }
    }

    /// What happened to the unit under test in this epoch, to be done before it gets the epoch.
    /// Empty almost always.
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

    /// Unit events and occurrences have been dealt with.
    pub fn told(&mut self) {
        self.events.clear();
        self.occurrences.clear();
    }

    /// Lets a fault with a manual trigger set in at the next epoch. False if there is none of that
    /// id that waits.
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

    /// Ends a fault with a manual trigger at the next epoch, as at the end of its duration; one that
    /// was to set in then doesn't. False if there is none of that id that lasts.
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

    /// How a fault does, by its number in the scenario from 0.
    #[must_use]
    pub fn progress(&self, fault: usize) -> Option<Progress> {
        self.stages.get(fault).map(|stage| Progress {
            active: stage.acting(),
            firings: stage.clock.firings,
            samples_altered: stage.ledger_at(self.epoch).altered(),
        })
    }

    /// The most epochs that can be delivered in one step of the source.
    #[must_use]
    pub fn most_delivered(&self) -> usize {
        self.burst
    }

    /// Whether a place has faults at all.
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
                stage.ledger_at(self.epoch).receipt(&stage.id, stage.kind.name, firings)
            })
            .collect()
    }
}

fn begin(stage: &mut Stage, handle: u32, now: &Context<'_>, world: &mut dyn World) {
    if let (Rule::Plant(rule), Some(plant)) = (&mut stage.rule, world.disturbed()) {
        let disturbance = rule.begin(now, &plant.motor());
        plant.begin(handle, &disturbance);
    }
    if let (Rule::Wire(rule), Some(wire)) = (&mut stage.rule, world.wired()) {
        wire.begin(handle, &rule.begin(now));
    }
    if let (Rule::Host(action), Some(host)) = (&stage.rule, world.host())
        && host.begin(action)
    {
        stage.ledger.touched(now.epoch);
    }
}

fn end(stage: &Stage, handle: u32, world: &mut dyn World) {
    if let (Rule::Plant(_), Some(plant)) = (&stage.rule, world.disturbed()) {
        plant.end(handle);
    }
    if let (Rule::Wire(_), Some(wire)) = (&stage.rule, world.wired()) {
        wire.end(handle);
    }
}

/// The same epochs, bit for bit, in the same order.
fn same(a: &[Epoch], b: &[Epoch]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.same_bits(b))
}

/// Epochs that can leave the last stage in one step of the source.
fn burst(stages: &[Stage]) -> Result<usize, (String, BuildError)> {
    let mut most = 1;
    for stage in stages {
        let Rule::Delivery(rule) = &stage.rule else { continue };
        most = rule.most_out(most);
        if most > BURST_MAX {
            let problem = alloc::format!(
                "with the faults before it, up to {most} epochs could be delivered in one step, at \
                 most {BURST_MAX} are possible"
            );
            return Err((stage.id.clone(), BuildError::value("kind", problem)));
        }
    }
    Ok(most)
}
