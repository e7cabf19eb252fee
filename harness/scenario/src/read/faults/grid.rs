//! Epochs at equal intervals, and schedules on them: the part of a schedule that needs no core.

use crate::document::{DocumentNode, DocumentValue};
use crate::error::Problem;
use crate::quantity::{self, UnitDimension};
use crate::read::reader::TableReader;
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
    pub(super) fn epochs(
        &self,
        table: &TableReader<'_>,
        key: &str,
    ) -> Result<Option<u64>, Problem> {
        let Some(text) = table.optional_text(key) else { return Ok(None) };
        let quantity = quantity::parse(text).map_err(|_| table.problem(key, "missing"))?;
        Ok(Some(if quantity.is(UnitDimension::SAMPLES) {
            quantity.si as u64
        } else {
            self.of_time(quantity.si)
        }))
    }

    pub(super) fn of_time(&self, time_s: f64) -> u64 {
        // The cast saturates at a value beyond any run.
        (time_s * 1e9 / self.period_ns).round() as u64
    }

    /// Converts as [`Self::epochs`] does, and requires at least one epoch.
    pub(super) fn span(&self, table: &TableReader<'_>, key: &str) -> Result<Option<u64>, Problem> {
        match self.epochs(table, key)? {
            Some(0) => {
                let found = table.text(key)?;
                let message = format!(
                    "found {found:?}, which is less than a {} of {} s",
                    self.step,
                    self.period_s()
                );
                Err(table.problem(key, message))
            }
            other => Ok(other),
        }
    }

    pub(super) fn or_zero(&self, table: &TableReader<'_>, key: &str) -> Result<u64, Problem> {
        self.epochs(table, key).map(Option::unwrap_or_default)
    }

    /// Delay of a fault after the event that it waits for.
    pub(super) fn delay(&self, table: &TableReader<'_>) -> Result<u64, Problem> {
        self.or_zero(table, "after")
    }

    /// Reads a schedule with a given trigger.
    pub(super) fn schedule(
        &self,
        table: &TableReader<'_>,
        lasts: Lasts,
        trigger: Trigger,
        fires: &[u64],
    ) -> Result<Schedule, Problem> {
        let schedule = Schedule {
            trigger,
            duration: self.span(table, "duration")?,
            recovery: self.or_zero(table, "recovery")?,
            repeat: self.repeat(table)?,
        };
        self.check_repetition(table, lasts, &schedule, fires)?;
        Ok(schedule)
    }

    /// Reads a trigger by time, after another fault or by hand, and the epochs at which it is fired by
    /// hand.
    pub(super) fn trigger(&self, table: &TableReader<'_>) -> Result<(Trigger, Vec<u64>), Problem> {
        let first = || Ok(self.or_zero(table, "from")?.saturating_add(1));
        let last = || Ok(self.span(table, "until")?.map(|until| until.saturating_add(1)));
        let trigger = if table.node("at").is_some() {
            Trigger::Epoch(self.or_zero(table, "at")?.saturating_add(1))
        } else if table.node("sample").is_some() {
            Trigger::Epoch(table.integer("sample")?)
        } else if table.node("every").is_some() {
            let period = self.span(table, "every")?.unwrap_or(1);
            Trigger::Periodic { first: first()?, period, last: last()? }
        } else if table.node("poisson").is_some() {
            let quantity = quantity::parse(table.text("poisson")?)
                .map_err(|_| table.problem("poisson", "missing"))?;
            let is_time = quantity.is(UnitDimension::TIME);
            let mean_s = if is_time { quantity.si } else { 1.0 / quantity.si };
            Trigger::Poisson { first: first()?, last: last()?, mean: mean_s / self.period_s() }
        } else if table.node("after_fault").is_some() {
            let fault = table.text("after_fault")?.to_owned();
            Trigger::After { fault, delay: self.delay(table)? }
        } else {
            if !table.boolean("manual")? {
                return Err(table.problem("manual", "found false, expected true"));
            }
            Trigger::Manual
        };
        if let Trigger::Periodic { first, last: Some(last), .. }
        | Trigger::Poisson { first, last: Some(last), .. } = &trigger
            && last < first
        {
            let message = format!("found {:?}, which is before from", table.text("until")?);
            return Err(table.problem("until", message));
        }
        let mut fires: Vec<u64> = (table.optional_si_vec("fire").unwrap_or_default().into_iter())
            .map(|time_s| self.of_time(time_s).saturating_add(1))
            .collect();
        fires.sort_unstable();
        Ok((trigger, fires))
    }

    fn repeat(&self, table: &TableReader<'_>) -> Result<Repeat, Problem> {
        match table.node("repeat") {
            None => Ok(Repeat::Once),
            Some(DocumentNode { value: DocumentValue::Text(_), .. }) => Ok(Repeat::EveryTime),
            Some(_) => {
                let repeat = table.table("repeat")?;
                let every = self.span(&repeat, "every")?.unwrap_or(1);
                Ok(Repeat::Times { times: repeat.integer("times")?, every })
            }
        }
    }

    /// Checks that a repeated fault ends before it returns, and that the repetition has an effect.
    fn check_repetition(
        &self,
        table: &TableReader<'_>,
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
            return Err(table.problem("recovery", message));
        }
        if by_itself && schedule.repeat != Repeat::Once {
            let message = "without effect: this trigger comes back by itself";
            return Err(table.problem("repeat", message));
        }
        if schedule.repeat == Repeat::EveryTime && matches!(schedule.trigger, Trigger::Epoch(_)) {
            let message = "without effect: a time comes once; give times and every";
            return Err(table.problem("repeat", message));
        }
        if length.is_none() && (by_itself || schedule.repeat != Repeat::Once) {
            let message = "missing: without it the fault lasts to the end of the run, and never \
                           comes back";
            return Err(table.problem("duration", message));
        }
        let (distance, key) = match (&schedule.trigger, schedule.repeat) {
            (Trigger::Periodic { period, .. }, _) => (Some(*period), "trigger"),
            (_, Repeat::Times { every, .. }) => (Some(every), "repeat"),
            _ => (None, ""),
        };
        if let (Some(distance), Some(length)) = (distance, length)
            && distance <= length
        {
            let message = format!(
                "every {} comes before the fault is over, which takes {} with its recovery",
                self.words(distance),
                self.words(length)
            );
            return Err(table.problem(key, message));
        }
        if fires.len() > 1 && schedule.repeat != Repeat::EveryTime {
            let message =
                format!("fired {} times, which needs repeat = \"every time\"", fires.len());
            return Err(table.problem("trigger", message));
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
pub(super) fn check_chains(tables: &[TableReader<'_>], all: &[Waiting<'_>]) -> Result<(), Problem> {
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
