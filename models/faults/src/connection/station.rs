//! Active faults on connections at an epoch, and their receipts.

use super::kinds::{ConnectionFaultKind, Now, Rule, Target};
use crate::catalogue::Lasts;
use crate::receipt::{Ledger, Receipt};
use crate::setup::{FaultBuildError, Setup};
use crate::station::Occurrence;
use crate::trigger::{Clock, Schedule, State, Trigger};
use crate::values::Values;
use alloc::string::String;
use alloc::vec::Vec;
use octant_random::stream::Phase;

/// One fault on a connection.
#[derive(Clone, Debug)]
pub struct ConnectionFaultSpec {
    /// Id, unique in the run.
    pub id: String,
    /// Kind of the fault.
    pub kind: &'static ConnectionFaultKind,
    /// Values of every parameter of the kind, in the unit of the input.
    pub values: Values,
    /// Time of the fault. Triggers that depend on a core are not for connections: positions, moves,
    /// modes and conditions on its signals. [`Trigger::Outside`] is.
    pub schedule: Schedule,
    /// Elements on which the fault acts, by the caller's numbers, and their types.
    pub elements: Vec<(usize, Target)>,
}

#[derive(Debug)]
struct Stage {
    id: String,
    kind: &'static ConnectionFaultKind,
    rule: Rule,
    clock: Clock,
    ledger: Ledger,
    targets: Vec<Target>,
    now: Now,
}

/// The faults of one run on all its connections.
#[derive(Debug)]
pub struct ConnectionStation {
    stages: Vec<Stage>,
    /// For each element of the caller: the stages that act on it, and its index in each.
    on: Vec<Vec<(usize, usize)>>,
    epoch: u64,
    occurrences: Vec<Occurrence>,
}

/// Largest number of occurrences kept until the caller reads them.
const OCCURRENCES_MAX: usize = 256;

impl ConnectionStation {
    /// Makes a station with the faults in the order in which they act. `period_s`: the length of a
    /// step.
    ///
    /// # Errors
    /// If a fault's values contradict each other, it can't act on the types of its elements, an id
    /// is given twice, or a fault waits for one that isn't there.
    pub fn new(
        specs: &[ConnectionFaultSpec],
        seed: u64,
        period_s: f64,
    ) -> Result<Self, (String, FaultBuildError)> {
        let mut stages: Vec<Stage> = Vec::with_capacity(specs.len());
        for spec in specs {
            let stage = stage(spec, specs, &stages, seed, period_s);
            stages.push(stage.map_err(|error| (spec.id.clone(), error))?);
        }
        let elements = specs.iter().flat_map(|spec| &spec.elements).map(|(element, _)| element + 1);
        let mut on = alloc::vec![Vec::new(); elements.max().unwrap_or(0)];
        for (index, spec) in specs.iter().enumerate() {
            for (inner, (element, _)) in spec.elements.iter().enumerate() {
                on[*element].push((index, inner));
            }
        }
        let occurrences = Vec::with_capacity(OCCURRENCES_MAX);
        Ok(Self { stages, on, epoch: 0, occurrences })
    }

    /// Begins an epoch, before its transfers. `holds` tells whether the condition of a fault with
    /// [`Trigger::Outside`], given by its number, held at the end of the epoch before; `None`:
    /// unknown.
    pub fn begin(&mut self, mut holds: impl FnMut(usize) -> Option<bool>) {
        self.epoch += 1;
        for (index, stage) in self.stages.iter_mut().enumerate() {
            if matches!(stage.clock.trigger(), Trigger::Outside { .. })
                && let Some(holds) = holds(index)
            {
                stage.clock.look_outside(self.epoch, holds);
            }
        }
        for index in 0..self.stages.len() {
            let stage = &mut self.stages[index];
            let ticked = stage.clock.tick(self.epoch);
            stage.now = Now {
                epoch: self.epoch,
                acting: matches!(stage.clock.state, State::Active { .. } | State::Fading { .. }),
                onset: ticked.began,
                strength: stage.clock.strength(self.epoch),
            };
            stage.rule.begin(&stage.now);
            if ticked.ended {
                self.tell(index, false);
                self.tell_others(index);
            }
            if ticked.began {
                self.tell(index, true);
            }
        }
    }

    fn tell(&mut self, fault: usize, begins: bool) {
        if self.occurrences.len() < OCCURRENCES_MAX {
            self.occurrences.push(Occurrence { epoch: self.epoch, fault, begins });
        }
    }

    /// Tells the faults that wait for this one that it has ended.
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

    /// Returns whether there are faults on an element.
    #[must_use]
    pub fn is_on(&self, element: usize) -> bool {
        self.on.get(element).is_some_and(|stages| !stages.is_empty())
    }

    /// Returns the value that an element gets instead of `value`. `again`: the element's transfer
    /// of this epoch was made before, as when a step is repeated or made in parts; such a transfer
    /// is altered in the same way, and isn't counted.
    #[inline]
    pub fn transfer(&mut self, element: usize, value: f64, again: bool) -> f64 {
        let mut value = value;
        for (index, inner) in self.on.get(element).into_iter().flatten() {
            let stage = &mut self.stages[*index];
            if !stage.now.acting && !stage.rule.remembers() {
                continue;
            }
            let clean = value;
            value = stage.rule.transfer(*inner, clean, stage.targets[*inner], &stage.now, again);
            if !again && value.to_bits() != clean.to_bits() {
                stage.ledger.touched(self.epoch);
                stage.ledger.number(clean, value);
            }
        }
        value
    }

    /// Returns whether a fault on an element acts at this epoch.
    #[must_use]
    pub fn acts_on(&self, element: usize) -> bool {
        self.on.get(element).into_iter().flatten().any(|(stage, _)| self.stages[*stage].now.acting)
    }

    /// Onsets and ends since the last call of [`Self::told`].
    #[must_use]
    pub fn occurrences(&self) -> &[Occurrence] {
        &self.occurrences
    }

    /// Clears the occurrences once they are handled.
    pub fn told(&mut self) {
        self.occurrences.clear();
    }

    /// Lets a fault with a manual trigger set in at the next epoch. Returns false if no fault of
    /// that id waits.
    pub fn fire(&mut self, id: &str) -> bool {
        let next = self.epoch + 1;
        self.stages
            .iter_mut()
            .find(|stage| stage.id == id && *stage.clock.trigger() == Trigger::Manual)
            .is_some_and(|stage| stage.clock.fire(next))
    }

    /// Id and kind of a fault by its number.
    #[must_use]
    pub fn name(&self, fault: usize) -> Option<(&str, &'static str)> {
        self.stages.get(fault).map(|stage| (stage.id.as_str(), stage.kind.name))
    }

    /// Receipts of all faults, in order. Samples in them are epochs; checksums are over the 64 bits
    /// of the altered values, little-endian, in the order of the transfers.
    #[must_use]
    pub fn receipts(&self) -> Vec<Receipt> {
        let receipt =
            |stage: &Stage| stage.ledger.receipt(&stage.id, stage.kind.name, stage.clock.firings);
        self.stages.iter().map(receipt).collect()
    }
}

fn stage(
    spec: &ConnectionFaultSpec,
    specs: &[ConnectionFaultSpec],
    before: &[Stage],
    seed: u64,
    period_s: f64,
) -> Result<Stage, FaultBuildError> {
    if before.iter().any(|stage| stage.id == spec.id) {
        return Err(FaultBuildError::DuplicateId(spec.id.clone()));
    }
    match &spec.schedule.trigger {
        Trigger::After { fault, .. }
            if !specs.iter().any(|other| other.id == *fault && other.id != spec.id) =>
        {
            return Err(FaultBuildError::NoSuchFault { id: spec.id.clone(), after: fault.clone() });
        }
        Trigger::Position { .. }
        | Trigger::Move { .. }
        | Trigger::Mode { .. }
        | Trigger::Condition { .. } => {
            let problem = "it waits for a core, and a connection has none";
            return Err(FaultBuildError::value("trigger", problem));
        }
        _ => {}
    }
    if spec.kind.lasts == Lasts::Span && spec.schedule.recovery > 0 {
        let problem = "this kind doesn't fade: it is there or it isn't";
        return Err(FaultBuildError::value("recovery", problem));
    }
    if spec.schedule.duration == Some(0) {
        return Err(FaultBuildError::value(
            "duration",
            "less than a step, at least one is expected",
        ));
    }
    if let Some((_, target)) = spec.elements.iter().find(|(_, target)| !target.takes(spec.kind.on))
    {
        let problem = alloc::format!("{} can't act on {target:?}", spec.kind.name);
        return Err(FaultBuildError::value("kind", problem));
    }
    let targets: Vec<Target> = spec.elements.iter().map(|(_, target)| *target).collect();
    let setup = Setup {
        seed,
        // Rounded: the period is used only for delays that are given as times.
        sample_period_ns: libm::round(period_s * 1e9) as u64,
        calibration_samples: u64::MAX,
        angle_random_walk: 0.0,
        velocity_random_walk: 0.0,
        turntable_rate_radps: 0.0,
        id: spec.id.clone(),
    };
    let rule = Rule::new(spec.kind, &spec.values, &setup, &targets)?;
    let key = setup.stream("trigger").key(Phase::Calibration);
    Ok(Stage {
        id: spec.id.clone(),
        kind: spec.kind,
        rule,
        clock: Clock::new(spec.schedule.clone(), key),
        ledger: Ledger::default(),
        targets,
        now: Now { epoch: 0, acting: false, onset: false, strength: 0.0 },
    })
}
