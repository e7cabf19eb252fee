//! Onsets and ends of faults, and the faults that act before the source makes an epoch.

use super::stage::{Shared, Stage};
use super::{OCCURRENCES_MAX, Occurrence, Station, World};
use crate::rule::{Context, FaultRule, SetPoints, UnitEvent};
use crate::trigger::{News, Scene, Trigger};
use octant_sample::{GimbalCommand, Output};

impl Station {
    #[inline(never)]
    pub(super) fn look(&mut self, output: &Output, world: &mut dyn World) {
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
            let ticked = stage.clock.tick(self.epoch);
            if ticked.ended {
                end(stage, index as u32, world);
            }
            if stage.is_over(index as u32, ticked.ended, world) {
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
    pub(super) fn act_on(&mut self, command: &mut GimbalCommand, output: &Output) {
        let shared = self.shared();
        for stage in &mut self.stages {
            if !stage.acting() {
                continue;
            }
            let now = stage.context(&shared, &self.last, output);
            if let FaultRule::Command(rule) = &mut stage.rule {
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

    /// Updates the power of the unit: it goes with the first fault that cuts it and returns with
    /// the last end; `from`: number of events before this epoch.
    fn settle_power(&mut self, from: usize) {
        let without = self.stages.iter().any(Stage::cuts_power);
        match (self.without_power, without) {
            (false, false) => return,
            // Other events of the unit in this epoch are dropped: it loses its state anyway.
            (false, true) => {
                self.events.truncate(from);
                self.events.push(UnitEvent::PowerOff);
            }
            (true, true) => self.events.truncate(from),
            (true, false) => self.events.insert(from, UnitEvent::PowerOn),
        }
        self.without_power = without;
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

    fn tell(&mut self, fault: usize, begins: bool) {
        // The harness reads the occurrences after every epoch; further ones in the same step are
        // dropped.
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
            FaultRule::Unit(rule) => {
                let event = rule.on_epoch(&now);
                // An event of a unit that is already without power alters nothing.
                if rule.cuts_power() || (event.is_some() && !self.without_power) {
                    stage.ledger.touched(shared.epoch);
                }
                self.events.extend(event);
            }
            FaultRule::Plant(_)
            | FaultRule::Command(_)
            | FaultRule::Samples(_)
            | FaultRule::Delivery(_)
            | FaultRule::Wire(_)
            | FaultRule::Host(_) => {}
        }
    }
}

impl Stage {
    /// Returns whether the fault is over at this epoch, once: with its `end`, or, inside the plant, as soon after it as
    /// nothing that it set in motion goes on.
    fn is_over(&mut self, handle: u32, end: bool, world: &mut dyn World) -> bool {
        if !matches!(self.rule, FaultRule::Plant(_)) {
            return end;
        }
        let went_on = self.goes_on || end;
        let mut moves = || world.disturbed().is_some_and(|plant| plant.goes_on(handle));
        self.goes_on = self.goes_on && (self.acting() || moves());
        went_on && !self.goes_on && !self.acting()
    }
}

fn begin(stage: &mut Stage, handle: u32, now: &Context<'_>, world: &mut dyn World) {
    if let (FaultRule::Plant(rule), Some(plant)) = (&mut stage.rule, world.disturbed()) {
        let disturbance = rule.begin(now, &plant.motor());
        plant.begin(handle, &disturbance);
        (stage.compares, stage.goes_on) = (true, true);
    }
    if let (FaultRule::Wire(rule), Some(wire)) = (&mut stage.rule, world.wired()) {
        wire.begin(handle, &rule.begin(now));
    }
    if let (FaultRule::Host(action), Some(host)) = (&stage.rule, world.host())
        && host.begin(action)
    {
        stage.ledger.touched(now.epoch);
    }
}

fn end(stage: &Stage, handle: u32, world: &mut dyn World) {
    if let (FaultRule::Plant(_), Some(plant)) = (&stage.rule, world.disturbed()) {
        plant.end(handle);
    }
    if let (FaultRule::Wire(_), Some(wire)) = (&stage.rule, world.wired()) {
        wire.end(handle);
    }
}
