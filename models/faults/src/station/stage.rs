//! One fault in the pipeline: its rule, its clock and its ledger.

use crate::catalogue::{FaultKind, Lasts};
use crate::receipt::Ledger;
use crate::rule::{Context, FaultRule, SetPoints};
use crate::trigger::{Clock, State};
use alloc::string::String;
use octant_random::stream::Phase;
use octant_sample::{Epoch, Output};

#[derive(Clone, Debug)]
pub(super) struct Stage {
    pub(super) id: String,
    pub(super) kind: &'static FaultKind,
    pub(super) rule: FaultRule,
    pub(super) clock: Clock,
    pub(super) ledger: Ledger,
    /// True if the fault has set in and its rule hasn't seen an epoch since.
    pub(super) fresh: bool,
    /// True if the fault has disturbed the plant and a plant without it is beside it.
    pub(super) compares: bool,
    /// True from the onset of a fault inside the plant until its effect is over.
    pub(super) goes_on: bool,
}

impl Stage {
    pub(super) fn acting(&self) -> bool {
        matches!(self.clock.state, State::Active { .. } | State::Fading { .. })
    }

    /// Returns whether every epoch has to pass the stage: the fault acts, or an effect of it is
    /// left.
    pub(super) fn engaged(&self) -> bool {
        match &self.rule {
            FaultRule::Delivery(rule) => self.acting() || rule.holds() > 0,
            FaultRule::Samples(rule) => self.acting() || rule.lingers() || self.is_owed(),
            FaultRule::Command(_) | FaultRule::Unit(_) | FaultRule::Wire(_) => self.acting(),
            // Between onset and end the plant realises the fault alone, then its effect may go on.
            FaultRule::Plant(_) => self.goes_on && !self.acting(),
            // The host realises the fault alone.
            FaultRule::Host(_) => false,
        }
    }

    /// Returns whether the fault's instant passed while faults before it held every epoch back: the
    /// next epoch gets it.
    pub(super) fn is_owed(&self) -> bool {
        self.fresh && self.kind.lasts == Lasts::Instant
    }

    pub(super) fn cuts_power(&self) -> bool {
        self.acting() && matches!(&self.rule, FaultRule::Unit(rule) if rule.cuts_power())
    }

    /// First epoch to be remembered as the one before an onset.
    pub(super) fn looks_back_from(&self) -> u64 {
        match (&self.rule, self.clock.state) {
            (FaultRule::Samples(rule), state) if rule.looks_back() => match state {
                State::Pending(at) => at.saturating_sub(1),
                State::Spent => u64::MAX,
                State::Waiting | State::Active { .. } | State::Fading { .. } => 0,
            },
            _ => u64::MAX,
        }
    }

    pub(super) fn context<'a>(
        &self,
        shared: &Shared,
        last: &'a Epoch,
        output: &'a Output,
    ) -> Context<'a> {
        Context {
            epoch: shared.epoch,
            phase: shared.phase,
            counter: shared.counter,
            dt_s: shared.dt_s,
            since_onset: self.clock.onset().map_or(0, |onset| shared.epoch - onset),
            firing: self.clock.firings.saturating_sub(1),
            strength: self.clock.strength(shared.epoch),
            last,
            output,
            set_points: shared.set_points,
        }
    }
}

/// Common part of the contexts of an epoch.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shared {
    pub(super) epoch: u64,
    pub(super) phase: Phase,
    pub(super) counter: u64,
    pub(super) dt_s: f64,
    pub(super) set_points: SetPoints,
}
