//! Schedules of faults: triggers in epochs, and the refusal of those that can't fire.

use super::grid::Grid;
use crate::condition;
use crate::error::Problem;
use crate::keys::{At, Counted, TriggerKeys, key};
use crate::model::{CalibrationSpec, Fault, Method, Scenario};
use crate::read::reader::Reader;
use octant_calibration::config::TurntableRates;
use octant_calibration::schedule::move_between_s;
use octant_calibration::sequence::{Sequence, Stop};
use octant_calibration::visits::VisitedPositions;
use octant_faults::catalogue::FaultKind;
use octant_faults::trigger::{Schedule, Trigger};
use octant_sample::Mode;

/// Timing of the run, as far as it is known before the start.
pub(super) struct Timing<'a> {
    scenario: &'a Scenario,
    grid: Grid,
    /// Number of epochs of the whole run, if known.
    total: Option<u64>,
    calibration_samples: u64,
}

/// A walk through positions.
struct Walk<'a> {
    sequence: &'a Sequence,
    from: Stop,
    dwell_s: f64,
    /// Number of positions, over all passes; `None`: until the end of the phase.
    positions: Option<u64>,
    name: &'static str,
}

impl<'a> Timing<'a> {
    pub(super) fn of(scenario: &'a Scenario) -> Self {
        Self {
            scenario,
            grid: Grid { period_ns: scenario.sample_period_ns as f64, step: "sample" },
            total: scenario.samples(),
            calibration_samples: scenario.calibration_samples(),
        }
    }

    /// Schedule of a fault, and the epochs at which it is fired by hand.
    pub(super) fn schedule(
        &self,
        table: &Reader<'_>,
        kind: &FaultKind,
        trigger: &At<TriggerKeys>,
    ) -> Result<(Schedule, Vec<u64>), Problem> {
        let (read, fires) = match self.grid.trigger(trigger)? {
            Some(read) => read,
            None => (self.trigger(table, trigger)?, Vec::new()),
        };
        let schedule = self.grid.schedule(table, kind.lasts, trigger, (read, &fires))?;
        Ok((schedule, fires))
    }

    /// Trigger of a step that comes once, in a run that has its phase.
    pub(super) fn once(&self, table: &Reader<'_>, keys: &TriggerKeys) -> Result<Trigger, Problem> {
        let read = self.grid.trigger(keys)?.map(|(trigger, _)| Ok(trigger));
        let trigger = read.unwrap_or_else(|| self.trigger(table, keys))?;
        self.check_phase(&table.table("trigger")?, &trigger)?;
        Ok(trigger)
    }

    fn trigger(&self, table: &Reader<'_>, keys: &TriggerKeys) -> Result<Trigger, Problem> {
        let delay = |after| self.grid.epochs(after);
        Ok(match keys {
            TriggerKeys::Position(keys) => Trigger::Position {
                stop: self.stop(&keys.position, keys.counted, keys.phase)?,
                mode: keys.phase,
                delay: delay(keys.after),
            },
            TriggerKeys::MovingTo(keys) => Trigger::Move {
                stop: self.stop(&keys.moving_to, keys.counted, keys.phase)?,
                mode: keys.phase,
                delay: delay(keys.after),
            },
            TriggerKeys::Mode(keys) => Trigger::Mode { mode: keys.mode, delay: delay(keys.after) },
            TriggerKeys::When(keys) => {
                let (signal, comparison, value) =
                    condition::parse(&keys.when).map_err(|message| keys.when.problem(message))?;
                if signal.needs_truth()
                    && let Some(without) = self.scenario.source.without_truth()
                {
                    let found = &*keys.when;
                    let message = format!("found {found:?}, which needs truth, and {without}");
                    return Err(keys.when.problem(message));
                }
                Trigger::Condition { signal, comparison, value, delay: delay(keys.after) }
            }
            _ => return Err(table.problem("trigger", "missing")),
        })
    }

    /// Stop of a trigger's number, from 0. A fault has one schedule for both methods, so a position
    /// has to be first visited at the same stop in both.
    fn stop(&self, number: &At<u16>, counted: Option<Counted>, mode: Mode) -> Result<u16, Problem> {
        if counted != Some(Counted::Positions) {
            return Ok(number.saturating_sub(1));
        }
        let position = **number;
        let mut first: Option<(usize, &str)> = None;
        for walk in self.walks(mode) {
            let visited = VisitedPositions::of(walk.sequence.stops());
            let Some(stop) = visited.first_visit(position.into()) else {
                return Err(number.problem(format!(
                    "it can't fire: found position {position}, and {} has {} positions",
                    walk.name,
                    visited.count()
                )));
            };
            match first {
                Some((other, name)) if other != stop => {
                    return Err(number.problem(format!(
                        "found position {position}, which {name} visits first at stop {} and {} at \
                         stop {}; expected the number of a stop, without counted",
                        other + 1,
                        walk.name,
                        stop + 1
                    )));
                }
                _ => first = Some((stop, walk.name)),
            }
        }
        // A run without the phase is refused by `check_phase`.
        Ok(first.map_or(0, |(stop, _)| u16::try_from(stop).unwrap_or(u16::MAX)))
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
                self.grid.words(fire.saturating_sub(1)),
                self.grid.words(total)
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
                self.grid.words(earliest.saturating_sub(1)),
                self.grid.words(total)
            );
            return Err(trigger.problem(key, message));
        }
        Ok(())
    }

    /// Checks that the run has the phase that a trigger waits for, and visits its position.
    fn check_phase(&self, table: &Reader<'_>, trigger: &Trigger) -> Result<(), Problem> {
        let (mode, key) = match trigger {
            Trigger::Position { mode, .. } => (*mode, "position"),
            Trigger::Move { mode, .. } => (*mode, "moving_to"),
            Trigger::Mode { mode, .. } => (*mode, "mode"),
            _ => return Ok(()),
        };
        let there = match mode {
            Mode::Aligning => self.scenario.alignment.duration_s().is_some(),
            Mode::Calibrating => self.scenario.calibration.is_some(),
            _ => self.scenario.navigation.is_some(),
        };
        if !there {
            let (what, section) = match mode {
                Mode::Aligning => ("its attitude is handed over", key!(procedure.alignment)),
                Mode::Calibrating => ("it has no calibration", key!(procedure.calibration)),
                _ => ("it has no navigation", key!(procedure.navigation)),
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
                    "it can't fire: found stop {number}, and {} has {positions} stops",
                    walk.name
                );
                return Err(table.problem(key, message));
            }
            if moving && walk.move_to_s(*stop, &self.rates()) < self.grid.period_s() {
                let message = format!(
                    "it can't fire: in {} the gimbals are at stop {number} already when its turn \
                     comes",
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

    /// Walks through positions of both methods.
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

    /// First epoch at which a fault can begin, if that is known. `depth` bounds the walk along faults
    /// that wait for each other.
    fn earliest(&self, all: &[Fault], index: usize, depth: usize) -> Option<u64> {
        let fault = all.get(index)?;
        let after = |start: u64, delay: &u64| Some(start.saturating_add(*delay));
        match &fault.spec.schedule.trigger {
            Trigger::Position { stop, mode, delay } | Trigger::Move { stop, mode, delay } => {
                let moving = matches!(fault.spec.schedule.trigger, Trigger::Move { .. });
                let walks = self.walks(*mode);
                // The later one counts, because the fault must fire in both methods.
                let reached = walks
                    .iter()
                    .map(|walk| self.grid.of_time(walk.reached_s(*stop, moving, &self.rates())));
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

    /// First epoch of a mode.
    fn start(&self, mode: Mode) -> u64 {
        match (mode, self.scenario.alignment.duration_s()) {
            (Mode::Navigating, _) => self.calibration_samples,
            (Mode::Calibrating, Some(duration_s)) => self.grid.of_time(duration_s),
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

    /// Time since the start of the walk at which a position is reached, or its move begins, s.
    fn reached_s(&self, stop: u16, moving: bool, rates: &TurntableRates) -> f64 {
        let before: f64 = (0..stop)
            .map(|stop| self.move_to_s(stop, rates) + self.at(stop).weight * self.dwell_s)
            .sum();
        if moving { before } else { before + self.move_to_s(stop, rates) }
    }
}

fn positions(calibration: &CalibrationSpec) -> u64 {
    calibration.sequence.stops().len() as u64 * u64::from(calibration.sequence.passes())
}

/// Name of a method, for messages.
fn method_name(method: Method) -> &'static str {
    match method {
        Method::Primary => "the calibration",
        Method::Baseline => "the calibration of the baseline",
    }
}
