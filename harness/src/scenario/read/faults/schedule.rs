//! When faults set in: triggers in epochs, and those that can't come true.

use super::{Fault, Reader, method_name};
use crate::scenario::condition;
use crate::scenario::document::{Node, Value};
use crate::scenario::error::{Problem, suggestion};
use crate::scenario::quantity::{self, Dimension};
use crate::scenario::{Alignment, Calibration, Method, Scenario, Source};
use octant_calibration::config::TurntableRates;
use octant_calibration::schedule::move_between_s;
use octant_calibration::sequence::{Sequence, Stop};
use octant_faults::catalogue::{Kind, Lasts};
use octant_faults::trigger::{Repeat, Schedule, Trigger};
use octant_sample::Mode;

/// What is known of the run's time before it starts.
pub(super) struct Timing<'a> {
    scenario: &'a Scenario,
    period_s: f64,
    /// Epochs of the whole run, where they are known.
    total: Option<u64>,
    calibration_samples: u64,
}

/// One walk through positions.
struct Walk<'a> {
    sequence: &'a Sequence,
    from: Stop,
    dwell_s: f64,
    /// Positions that come, over all passes; `None`: as long as it lasts.
    positions: Option<u64>,
    name: &'static str,
}

impl<'a> Timing<'a> {
    pub(super) fn of(scenario: &'a Scenario) -> Self {
        Self {
            scenario,
            period_s: scenario.sample_period_ns as f64 * 1e-9,
            total: scenario.samples(),
            calibration_samples: scenario.calibration_samples(),
        }
    }

    /// A time, or a number of samples, as epochs.
    fn epochs(&self, table: &Reader<'_>, key: &str) -> Result<Option<u64>, Problem> {
        let Some(text) = table.optional_text(key) else { return Ok(None) };
        let quantity = quantity::parse(text).map_err(|_| table.problem(key, "missing"))?;
        Ok(Some(if quantity.is(Dimension::SAMPLES) {
            quantity.si as u64
        } else {
            self.of_time(quantity.si)
        }))
    }

    fn of_time(&self, time_s: f64) -> u64 {
        // The cast saturates: past any run.
        (time_s * 1e9 / self.scenario.sample_period_ns as f64).round() as u64
    }

    /// As [`Timing::epochs`], one at least.
    fn span(&self, table: &Reader<'_>, key: &str) -> Result<Option<u64>, Problem> {
        match self.epochs(table, key)? {
            Some(0) => {
                let found = table.text(key)?;
                let message =
                    format!("found {found:?}, which is less than a sample of {} s", self.period_s);
                Err(table.problem(key, message))
            }
            other => Ok(other),
        }
    }

    fn or_zero(&self, table: &Reader<'_>, key: &str) -> Result<u64, Problem> {
        self.epochs(table, key).map(Option::unwrap_or_default)
    }

    /// The schedule of a fault, and the epochs at which it is fired by hand.
    pub(super) fn schedule(
        &self,
        table: &Reader<'_>,
        kind: &Kind,
    ) -> Result<(Schedule, Vec<u64>), Problem> {
        let (trigger, fires) = self.trigger(&table.table("trigger")?)?;
        let schedule = Schedule {
            trigger,
            duration: self.span(table, "duration")?,
            recovery: self.or_zero(table, "recovery")?,
            repeat: self.repeat(table)?,
        };
        self.check_repetition(table, kind, &schedule, &fires)?;
        Ok((schedule, fires))
    }

    fn trigger(&self, table: &Reader<'_>) -> Result<(Trigger, Vec<u64>), Problem> {
        let delay = self.or_zero(table, "after")?;
        let first = || Ok(self.or_zero(table, "from")?.saturating_add(1));
        let last = || Ok(self.span(table, "until")?.map(|until| until.saturating_add(1)));
        let mode = || {
            Ok(if table.text("phase")? == "calibration" {
                Mode::Calibrating
            } else {
                Mode::Navigating
            })
        };
        let stop = |key| Ok(table.integer::<u16>(key)?.saturating_sub(1));
        let trigger = if table.node("at").is_some() {
            Trigger::Epoch(self.or_zero(table, "at")?.saturating_add(1))
        } else if table.node("sample").is_some() {
            Trigger::Epoch(table.integer("sample")?)
        } else if table.node("position").is_some() {
            Trigger::Position { stop: stop("position")?, mode: mode()?, delay }
        } else if table.node("moving_to").is_some() {
            Trigger::Move { stop: stop("moving_to")?, mode: mode()?, delay }
        } else if table.node("mode").is_some() {
            let mode = match table.text("mode")? {
                "aligning" => Mode::Aligning,
                "calibrating" => Mode::Calibrating,
                _ => Mode::Navigating,
            };
            Trigger::Mode { mode, delay }
        } else if table.node("when").is_some() {
            let (signal, comparison, value) =
                condition::parse(table.text("when")?).map_err(|m| table.problem("when", m))?;
            if signal.needs_truth()
                && let Some(without) = without_truth(&self.scenario.source)
            {
                let found = table.text("when")?;
                let message = format!("found {found:?}, which needs truth, and {without}");
                return Err(table.problem("when", message));
            }
            Trigger::Condition { signal, comparison, value, delay }
        } else if table.node("every").is_some() {
            let period = self.span(table, "every")?.unwrap_or(1);
            Trigger::Periodic { first: first()?, period, last: last()? }
        } else if table.node("poisson").is_some() {
            let quantity = quantity::parse(table.text("poisson")?)
                .map_err(|_| table.problem("poisson", "missing"))?;
            let is_time = quantity.is(Dimension::TIME);
            let mean_s = if is_time { quantity.si } else { 1.0 / quantity.si };
            Trigger::Poisson { first: first()?, last: last()?, mean: mean_s / self.period_s }
        } else if table.node("after_fault").is_some() {
            Trigger::After { fault: table.text("after_fault")?.to_owned(), delay }
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

    fn repeat(&self, table: &Reader<'_>) -> Result<Repeat, Problem> {
        match table.node("repeat") {
            None => Ok(Repeat::Once),
            Some(Node { value: Value::Text(_), .. }) => Ok(Repeat::EveryTime),
            Some(_) => {
                let repeat = table.table("repeat")?;
                let every = self.span(&repeat, "every")?.unwrap_or(1);
                Ok(Repeat::Times { times: repeat.integer("times")?, every })
            }
        }
    }

    /// What comes back has to end before, and a repetition has to have an effect.
    fn check_repetition(
        &self,
        table: &Reader<'_>,
        kind: &Kind,
        schedule: &Schedule,
        fires: &[u64],
    ) -> Result<(), Problem> {
        let length = match (kind.lasts, schedule.duration) {
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

    fn words(&self, epochs: u64) -> String {
        use crate::report::number::plain;
        format!("{} s", plain(epochs as f64 * self.period_s, 9))
    }

    /// Refuses a fault that can't fire, as far as that is known before the run.
    pub(super) fn check(
        &self,
        table: &Reader<'_>,
        all: &[Fault],
        index: usize,
    ) -> Result<(), Problem> {
        let trigger = table.table("trigger")?;
        self.check_phase(&trigger, &all[index].spec.schedule.trigger)?;
        let (Some(earliest), Some(total)) = (self.earliest(all, index, all.len()), self.total)
        else {
            return Ok(());
        };
        if let Some(fire) = all[index].fires.iter().find(|fire| **fire > total) {
            let message = format!(
                "found {}, and the run ends at {}",
                self.words(fire.saturating_sub(1)),
                self.words(total)
            );
            return Err(trigger.problem("fire", message));
        }
        if earliest > total {
            let key = trigger.first_key();
            let at_the_earliest = match all[index].spec.schedule.trigger {
                Trigger::Epoch(_) => "",
                _ => " at the earliest",
            };
            let message = format!(
                "it can't fire: it would set in at {}{at_the_earliest}, and the run ends at {}",
                self.words(earliest.saturating_sub(1)),
                self.words(total)
            );
            return Err(trigger.problem(key, message));
        }
        Ok(())
    }

    /// A trigger waits for a phase that the run has, and for positions that it goes to.
    fn check_phase(&self, table: &Reader<'_>, trigger: &Trigger) -> Result<(), Problem> {
        let (mode, key) = match trigger {
            Trigger::Position { mode, .. } => (*mode, "position"),
            Trigger::Move { mode, .. } => (*mode, "moving_to"),
            Trigger::Mode { mode, .. } => (*mode, "mode"),
            _ => return Ok(()),
        };
        let there = match mode {
            Mode::Aligning => matches!(self.scenario.alignment, Alignment::Coarse { .. }),
            Mode::Calibrating => self.scenario.calibration.is_some(),
            _ => self.scenario.navigation.is_some(),
        };
        if !there {
            let (what, section) = match mode {
                Mode::Aligning => ("its attitude is handed over", "procedure.alignment"),
                Mode::Calibrating => ("it has no calibration", "procedure.calibration"),
                _ => ("it has no navigation", "procedure.navigation"),
            };
            let message =
                format!("it can't fire: the run never is {}, {what} ({section})", mode.name());
            return Err(table.problem(key, message));
        }
        let (Trigger::Position { stop, mode, .. } | Trigger::Move { stop, mode, .. }) = trigger
        else {
            return Ok(());
        };
        let moving = matches!(trigger, Trigger::Move { .. });
        for walk in self.walks(*mode) {
            let number = u64::from(*stop) + 1;
            if let Some(positions) = walk.positions
                && number > positions
            {
                let message = format!(
                    "it can't fire: found position {number}, and {} has {positions}",
                    walk.name
                );
                return Err(table.problem(key, message));
            }
            if moving && walk.move_to_s(*stop, &self.rates()) < self.period_s {
                let message = format!(
                    "it can't fire: in {} the gimbals are at position {number} already when its \
                     turn comes",
                    walk.name
                );
                return Err(table.problem(key, message));
            }
        }
        Ok(())
    }

    fn rates(&self) -> TurntableRates {
        TurntableRates {
            rate_radps: self.scenario.turntable.rate_radps,
            acceleration_radps2: self.scenario.turntable.acceleration_radps2,
        }
    }

    /// The walks through positions of both methods.
    fn walks(&self, mode: Mode) -> Vec<Walk<'_>> {
        let methods = [
            (Method::Primary, self.scenario.calibration.as_ref()),
            (Method::Baseline, self.scenario.baseline.as_ref()),
        ];
        let mut walks = Vec::new();
        for (method, calibration) in methods {
            if mode == Mode::Calibrating {
                walks.extend(calibration.map(|calibration| Walk {
                    sequence: &calibration.sequence,
                    from: Stop::default(),
                    dwell_s: calibration.dwell_s,
                    positions: Some(positions(calibration)),
                    name: method_name(method),
                }));
            } else if (method == Method::Primary || calibration.is_some())
                && let Some(plan) = &self.scenario.navigation
            {
                let last = calibration.and_then(|c| c.sequence.stops().last().copied());
                walks.push(Walk {
                    sequence: &plan.rotation,
                    from: last.unwrap_or_default(),
                    dwell_s: plan.dwell_s,
                    positions: None,
                    name: "the rotation in navigation",
                });
            }
        }
        walks
    }

    /// The first epoch at which a fault can set in, where that is known. `depth` ends the walk
    /// along faults that wait for each other.
    fn earliest(&self, all: &[Fault], index: usize, depth: usize) -> Option<u64> {
        let fault = all.get(index)?;
        let after = |start: u64, delay: &u64| Some(start.saturating_add(*delay));
        match &fault.spec.schedule.trigger {
            Trigger::Position { stop, mode, delay } | Trigger::Move { stop, mode, delay } => {
                let moving = matches!(fault.spec.schedule.trigger, Trigger::Move { .. });
                let walks = self.walks(*mode);
                // The later one: the fault is to fire in both methods.
                let reached = walks
                    .iter()
                    .map(|walk| self.of_time(walk.reached_s(*stop, moving, &self.rates())));
                after(self.start(*mode).saturating_add(reached.max()?), delay)
            }
            Trigger::Mode { mode, delay } => after(self.start(*mode), delay),
            Trigger::After { fault: id, delay } => {
                let other = all.iter().position(|other| other.spec.id == *id)?;
                let start = self.earliest(all, other, depth.checked_sub(1)?)?;
                let schedule = &all[other].spec.schedule;
                let length = schedule.duration.unwrap_or(1).saturating_add(schedule.recovery);
                after(start.saturating_add(length), delay)
            }
            Trigger::Condition { delay, .. } => after(1, delay),
            Trigger::Manual => fault.fires.first().copied(),
            other => other.earliest(),
        }
    }

    /// The first epoch of a mode.
    fn start(&self, mode: Mode) -> u64 {
        match (mode, self.scenario.alignment) {
            (Mode::Navigating, _) => self.calibration_samples,
            (Mode::Calibrating, Alignment::Coarse { duration_s }) => self.of_time(duration_s),
            _ => 0,
        }
    }
}

impl Walk<'_> {
    fn at(&self, stop: u16) -> Stop {
        let stops = self.sequence.stops();
        stops[usize::from(stop) % stops.len()]
    }

    fn before(&self, stop: u16) -> Stop {
        stop.checked_sub(1).map_or(self.from, |before| self.at(before))
    }

    fn move_to_s(&self, stop: u16, rates: &TurntableRates) -> f64 {
        move_between_s(&self.before(stop), &self.at(stop), rates)
    }

    /// When a position is reached, or set out for, since the start of the walk, s.
    fn reached_s(&self, stop: u16, moving: bool, rates: &TurntableRates) -> f64 {
        let before: f64 = (0..stop)
            .map(|stop| self.move_to_s(stop, rates) + self.at(stop).weight * self.dwell_s)
            .sum();
        if moving { before } else { before + self.move_to_s(stop, rates) }
    }
}

fn positions(calibration: &Calibration) -> u64 {
    calibration.sequence.stops().len() as u64 * u64::from(calibration.sequence.passes())
}

/// Faults that wait for others: those are there, they end, and something starts the chain.
pub(super) fn check_chains(tables: &[Reader<'_>], all: &[Fault]) -> Result<(), Problem> {
    let of = |id: &str| all.iter().position(|fault| fault.spec.id == id);
    let waits_for = |fault: &Fault| match &fault.spec.schedule.trigger {
        Trigger::After { fault, .. } => Some(fault.clone()),
        _ => None,
    };
    for (table, fault) in tables.iter().zip(all) {
        let Some(id) = waits_for(fault) else { continue };
        let trigger = table.table("trigger")?;
        let problem = |message: String| Err(trigger.problem("after_fault", message));
        let Some(mut at) = of(&id) else {
            let ids = all.iter().map(|fault| fault.spec.id.as_str());
            return problem(format!("found {id:?}, {}", suggestion(&id, ids, "faults")));
        };
        let other = &all[at].spec;
        if other.schedule.duration.is_none() && other.kind.lasts != Lasts::Instant {
            return problem(format!(
                "it can't fire: it waits for the end of {id:?}, which lasts to the end of the run"
            ));
        }
        let mut chain = vec![fault.spec.id.clone()];
        loop {
            let spec = &all[at].spec;
            if chain.contains(&spec.id) {
                return problem(format!(
                    "it can't fire: {} wait for each other and nothing starts them",
                    chain.iter().map(|id| format!("{id:?}")).collect::<Vec<_>>().join(" and ")
                ));
            }
            chain.push(spec.id.clone());
            match waits_for(&all[at]).and_then(|next| of(&next)) {
                Some(next) => at = next,
                None => break,
            }
        }
    }
    Ok(())
}

/// What a source without truth is, in words. An FMU without a map may be our plant, which has it.
fn without_truth(source: &Source) -> Option<&'static str> {
    match source {
        Source::Plant => None,
        Source::Fmu(fmu) if fmu.is_motion() || fmu.map.is_empty() => None,
        Source::Fmu(fmu) if fmu.map.iter().any(|m| m.channel.name.starts_with("truth.")) => None,
        Source::Fmu(_) => Some("source.fmu.map has no truth"),
        Source::Replay { .. } | Source::Text(_) => Some("the source is a recording"),
    }
}
