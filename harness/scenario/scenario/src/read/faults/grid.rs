//! Epochs at equal intervals, and schedules on them: the part of a schedule that needs no core.

use crate::error::Problem;
use crate::keys::{At, FromTable, LastingKeys, RepeatKeys, TriggerKeys};
use crate::quantity::{Quantity, UnitDimension};
use crate::read::reader::Reader;
use octant_base::names::suggestion;
use octant_faults::catalogue::Lasts;
use octant_faults::trigger::{Repeat, Schedule, Trigger};

/// Epochs at equal intervals.
pub(super) struct Grid {
    /// Interval, ns.
    pub(super) period_ns: f64,
    /// Name of an interval in messages.
    pub(super) step: &'static str,
}

impl Grid {
    pub(super) fn period_s(&self) -> f64 {
        self.period_ns * 1e-9
    }

    /// Converts a time, or a number of samples, to epochs.
    pub(super) fn epochs(&self, quantity: Quantity) -> u64 {
        if quantity.is(UnitDimension::SAMPLES) {
            quantity.si as u64
        } else {
            self.of_time(quantity.si)
        }
    }

    pub(super) fn of_time(&self, time_s: f64) -> u64 {
        // The cast saturates at a value beyond any run.
        (time_s * 1e9 / self.period_ns).round() as u64
    }

    /// Converts as [`Self::epochs`] does, and requires at least one epoch.
    fn span<Q: Copy + Into<Option<Quantity>>>(&self, at: &At<Q>) -> Result<Option<u64>, Problem> {
        match at.value.into().map(|quantity| self.epochs(quantity)) {
            Some(0) => Err(at.problem(format!(
                "found {:?}, which is less than a {} of {} s",
                at.text,
                self.step,
                self.period_s()
            ))),
            other => Ok(other),
        }
    }

    /// Reads the schedule of a fault that lasts so, with a trigger, and the epochs at which it is fired
    /// by hand.
    pub(super) fn schedule(
        &self,
        table: &Reader<'_>,
        lasts: Lasts,
        at: &At<TriggerKeys>,
        (trigger, fires): (Trigger, &[u64]),
    ) -> Result<Schedule, Problem> {
        let keys = LastingKeys::of(table)?;
        let repeat = match &*keys.repeat {
            None => Repeat::Once,
            Some(RepeatKeys::EveryTime) => Repeat::EveryTime,
            Some(RepeatKeys::Times(keys)) => {
                Repeat::Times { times: keys.times, every: self.span(&keys.every)?.unwrap_or(1) }
            }
        };
        let schedule = Schedule {
            trigger,
            duration: self.span(&keys.duration)?,
            recovery: keys.recovery.map_or(0, |recovery| self.epochs(recovery)),
            repeat,
        };
        self.check_repetition(&keys, at, lasts, &schedule, fires)?;
        Ok(schedule)
    }

    /// Reads a trigger by time, after another fault or by hand, and the epochs at which it is fired by
    /// hand; `None`: another one.
    pub(super) fn trigger(
        &self,
        keys: &TriggerKeys,
    ) -> Result<Option<(Trigger, Vec<u64>)>, Problem> {
        let first = |from: Quantity| self.epochs(from).saturating_add(1);
        let last = |until: &At<Option<Quantity>>, from| {
            let last = self.span(until)?.map(|until| until.saturating_add(1));
            if last.is_some_and(|last| last < first(from)) {
                return Err(until.problem(format!("found {:?}, which is before from", until.text)));
            }
            Ok(last)
        };
        let mut fires = Vec::new();
        let trigger = match keys {
            TriggerKeys::At(keys) => Trigger::Epoch(first(keys.at)),
            TriggerKeys::Sample(keys) => Trigger::Epoch(keys.sample),
            TriggerKeys::Every(keys) => Trigger::Periodic {
                period: self.span(&keys.every)?.unwrap_or(1),
                first: first(keys.from),
                last: last(&keys.until, keys.from)?,
            },
            TriggerKeys::Poisson(keys) => {
                let is_time = keys.poisson.is(UnitDimension::TIME);
                let mean_s = if is_time { keys.poisson.si } else { 1.0 / keys.poisson.si };
                Trigger::Poisson {
                    first: first(keys.from),
                    last: last(&keys.until, keys.from)?,
                    mean: mean_s / self.period_s(),
                }
            }
            TriggerKeys::AfterFault(keys) => {
                Trigger::After { fault: keys.after_fault.clone(), delay: self.epochs(keys.after) }
            }
            TriggerKeys::Manual(keys) => {
                if !*keys.manual {
                    return Err(keys.manual.problem("found false, expected true"));
                }
                fires.extend(
                    keys.fire.iter().flatten().map(|at_s| self.of_time(*at_s).saturating_add(1)),
                );
                fires.sort_unstable();
                Trigger::Manual
            }
            TriggerKeys::Position(_)
            | TriggerKeys::MovingTo(_)
            | TriggerKeys::Mode(_)
            | TriggerKeys::When(_) => return Ok(None),
        };
        Ok(Some((trigger, fires)))
    }

    /// Checks that a repeated fault ends before it returns, and that the repetition has an effect.
    fn check_repetition(
        &self,
        keys: &LastingKeys,
        at: &At<TriggerKeys>,
        lasts: Lasts,
        schedule: &Schedule,
        fires: &[u64],
    ) -> Result<(), Problem> {
        let length = match (lasts, schedule.duration) {
            (Lasts::Instant, _) => Some(1),
            (_, duration) => duration.map(|epochs| epochs.saturating_add(schedule.recovery)),
        };
        let by_itself =
            matches!(schedule.trigger, Trigger::Periodic { .. } | Trigger::Poisson { .. });
        if schedule.duration.is_none() && schedule.recovery > 0 {
            let message = "without effect: without a duration it lasts to the end of the run";
            return Err(keys.recovery.problem(message));
        }
        if by_itself && schedule.repeat != Repeat::Once {
            let message = "without effect: this trigger comes back by itself";
            return Err(keys.repeat.problem(message));
        }
        if schedule.repeat == Repeat::EveryTime && matches!(schedule.trigger, Trigger::Epoch(_)) {
            let message = "without effect: a time comes once; give times and every";
            return Err(keys.repeat.problem(message));
        }
        if length.is_none() && (by_itself || schedule.repeat != Repeat::Once) {
            let message = "missing: without it the fault lasts to the end of the run, and never \
                           comes back";
            return Err(keys.duration.problem(message));
        }
        let distance = match (&schedule.trigger, schedule.repeat) {
            (Trigger::Periodic { period, .. }, _) => Some(*period),
            (_, Repeat::Times { every, .. }) => Some(every),
            _ => None,
        };
        if let (Some(distance), Some(length)) = (distance, length)
            && distance <= length
        {
            let message = format!(
                "every {} comes before the fault is over, which takes {} with its recovery",
                self.words(distance),
                self.words(length)
            );
            return Err(if by_itself { at.problem(message) } else { keys.repeat.problem(message) });
        }
        if fires.len() > 1 && schedule.repeat != Repeat::EveryTime {
            let message =
                format!("fired {} times, which needs repeat = \"every time\"", fires.len());
            return Err(at.problem(message));
        }
        Ok(())
    }

    pub(super) fn words(&self, epochs: u64) -> String {
        use octant_base::number::plain;
        format!("{} s", plain(epochs as f64 * self.period_s(), 9))
    }
}

/// A fault that may wait for another one, or be waited for.
pub(super) struct Waiting<'a> {
    pub(super) id: &'a str,
    pub(super) schedule: &'a Schedule,
    pub(super) lasts: Lasts,
}

/// Checks faults that wait for others: those exist and end, and something starts the chain.
pub(super) fn check_chains(tables: &[Reader<'_>], all: &[Waiting<'_>]) -> Result<(), Problem> {
    let of = |id: &str| all.iter().position(|fault| fault.id == id);
    let waits_for = |fault: &Waiting<'_>| match &fault.schedule.trigger {
        Trigger::After { fault, .. } => Some(fault.clone()),
        _ => None,
    };
    for (table, fault) in tables.iter().zip(all) {
        let Some(id) = waits_for(fault) else { continue };
        let trigger = table.table("trigger")?;
        let problem = |message: String| Err(trigger.problem("after_fault", message));
        let Some(mut at) = of(&id) else {
            let ids = all.iter().map(|fault| fault.id);
            return problem(format!("found {id:?}, {}", suggestion(&id, ids, "faults")));
        };
        let other = &all[at];
        if other.schedule.duration.is_none() && other.lasts != Lasts::Instant {
            return problem(format!(
                "it can't fire: it waits for the end of {id:?}, which lasts to the end of the run"
            ));
        }
        let mut chain = vec![fault.id.to_owned()];
        loop {
            let spec = &all[at];
            if chain.iter().any(|id| id == spec.id) {
                return problem(format!(
                    "it can't fire: {} wait for each other and nothing starts them",
                    chain.iter().map(|id| format!("{id:?}")).collect::<Vec<_>>().join(" and ")
                ));
            }
            chain.push(spec.id.to_owned());
            match waits_for(&all[at]).and_then(|next| of(&next)) {
                Some(next) => at = next,
                None => break,
            }
        }
    }
    Ok(())
}
