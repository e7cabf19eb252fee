//! Passage of an epoch through the faults of samples and delivery.

use super::{Station, World};
use crate::catalogue::Lasts;
use crate::rule::{Context, FaultRule};
use octant_sample::{Epoch, Output};

impl Station {
    /// Compares the plant's epoch, fault by fault from the last one on, with those of the plants without them. Returns
    /// whether there is one.
    #[inline(never)]
    pub(super) fn compare(&mut self, epoch: &Epoch, world: &mut dyn World) -> bool {
        let (number, mut with) = (self.epoch, *epoch);
        self.compares = false;
        let mut plant = world.disturbed();
        for (handle, stage) in self.stages.iter_mut().enumerate().rev() {
            if !stage.compares {
                continue;
            }
            let found = plant.as_deref_mut().and_then(|plant| {
                plant.without(handle as u32).map(|without| (*without, plant.remainder_counts()))
            });
            stage.compares = found.is_some();
            if let Some((without, remainder)) = found {
                stage.ledger.compare(number, (&without, &with), remainder);
                with = without;
                self.compares = true;
            }
        }
        self.undisturbed = with;
        self.compares
    }

    /// Lets faults act on the epoch. Returns whether one did: what is delivered is then in flight.
    #[inline(never)]
    pub(super) fn pass(&mut self, epoch: &Epoch, output: &Output) -> bool {
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
                FaultRule::Samples(rule) => {
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
                            stage.ledger.altered_in_place(shared.epoch, &clean, epoch);
                        }
                    }
                }
                FaultRule::Delivery(rule) => {
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
                FaultRule::Plant(_)
                | FaultRule::Command(_)
                | FaultRule::Unit(_)
                | FaultRule::Wire(_)
                | FaultRule::Host(_) => {}
            }
        }
        self.last = *epoch;
        self.plan();
        engaged
    }
}

/// Returns whether both hold the same epochs, bit for bit, in the same order.
fn same(a: &[Epoch], b: &[Epoch]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.same_bits(b))
}
