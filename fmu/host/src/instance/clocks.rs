//! Time-based clocks (FMI 3.0): the times of their ticks. The FMU doesn't stop at a tick by itself;
//! the importer ends its step there, and activates the clock.

use super::super::description::{Causality, Description, IntervalVariability, VariableType};
use super::InstanceError;
use super::unit::{Interval, Steps};
use serde::{Deserialize, Serialize};

/// Time-based input clocks of an FMU.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Clocks(Vec<TimeClock>);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct TimeClock {
    reference: u32,
    kind: TimeKind,
    shift_s: f64,
    /// Interval in the description.
    described_s: Option<f64>,
    interval_s: Option<f64>,
    /// Start from which ticks at multiples of the interval are counted, so that rounding doesn't
    /// accumulate.
    base_s: f64,
    ticks: u64,
    /// Time of the next tick.
    next_s: Option<f64>,
}

/// Type of a clock's interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
enum TimeKind {
    /// One constant interval.
    Periodic,
    /// An interval that may change at each event.
    Tunable,
    /// A new interval after each tick.
    Changing,
    /// One tick after each request.
    Countdown,
}

impl Clocks {
    /// Finds the clocks of a description.
    pub(crate) fn of(description: &Description) -> Self {
        let clocks = description.variables.iter().filter(|variable| {
            variable.kind == VariableType::Clock && variable.causality == Causality::Input
        });
        Self(
            clocks
                .filter_map(|variable| {
                    let clock = variable.clock?;
                    let kind = match clock.interval_variability {
                        IntervalVariability::Constant | IntervalVariability::Fixed => {
                            TimeKind::Periodic
                        }
                        IntervalVariability::Tunable => TimeKind::Tunable,
                        IntervalVariability::Changing => TimeKind::Changing,
                        IntervalVariability::Countdown => TimeKind::Countdown,
                        IntervalVariability::Triggered => return None,
                    };
                    let counted = |count: u64| Some(count as f64 / clock.resolution? as f64);
                    let described_s = clock.interval_s.or_else(|| counted(clock.interval_counter?));
                    let shift_s = match counted(clock.shift_counter) {
                        Some(shift_s) if clock.shift_counter > 0 => shift_s,
                        _ => clock.shift_s,
                    };
                    Some(TimeClock {
                        reference: variable.reference,
                        kind,
                        shift_s,
                        described_s,
                        interval_s: None,
                        base_s: 0.0,
                        ticks: 0,
                        next_s: None,
                    })
                })
                .collect(),
        )
    }

    /// Returns whether there are no clocks.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Time of the next tick of any clock.
    pub(crate) fn next_s(&self) -> Option<f64> {
        self.0.iter().filter_map(|clock| clock.next_s).min_by(f64::total_cmp)
    }

    /// Determines the first ticks, at the end of the initialization.
    pub(crate) fn start(
        &mut self,
        unit: &mut impl Steps,
        time_s: f64,
    ) -> Result<(), InstanceError> {
        for clock in &mut self.0 {
            clock.ticks = 0;
            clock.base_s = time_s + clock.shift_s;
            clock.next_s = None;
            clock.interval_s = clock.described_s;
            if clock.kind == TimeKind::Countdown {
                continue;
            }
            if clock.interval_s.is_none() {
                clock.interval_s = match unit.interval(clock.reference)? {
                    Interval::Changed(interval_s) | Interval::Unchanged(interval_s) => {
                        Some(interval_s)
                    }
                    Interval::Unknown => None,
                };
            }
            clock.check(unit)?;
            clock.next_s = clock.interval_s.map(|_| clock.base_s);
        }
        Ok(())
    }

    /// Activates all clocks that are due at a time, in event mode before the first update.
    pub(crate) fn tick(
        &mut self,
        unit: &mut impl Steps,
        until_s: f64,
    ) -> Result<(), InstanceError> {
        for clock in &mut self.0 {
            if clock.next_s.is_some_and(|next_s| next_s <= until_s) {
                unit.activate(clock.reference)?;
                clock.ticks += 1;
                clock.next_s = match (clock.kind, clock.interval_s) {
                    (TimeKind::Periodic | TimeKind::Tunable, Some(interval_s)) => {
                        Some(clock.base_s + clock.ticks as f64 * interval_s)
                    }
                    // Clocks of other kinds are asked after the update.
                    _ => None,
                };
            }
        }
        Ok(())
    }

    /// Asks for the intervals that an event may have changed, in event mode after an update.
    pub(crate) fn ask(&mut self, unit: &mut impl Steps, time_s: f64) -> Result<(), InstanceError> {
        for clock in &mut self.0 {
            let waits = clock.next_s.is_none();
            let asked = match clock.kind {
                TimeKind::Periodic => false,
                TimeKind::Tunable | TimeKind::Countdown => true,
                TimeKind::Changing => waits,
            };
            if !asked {
                continue;
            }
            let interval_s = match (unit.interval(clock.reference)?, clock.kind) {
                (Interval::Unknown, _) | (Interval::Unchanged(_), TimeKind::Tunable) => continue,
                // A countdown that is already running continues.
                (Interval::Unchanged(_), TimeKind::Countdown) => continue,
                (Interval::Unchanged(interval_s) | Interval::Changed(interval_s), _) => interval_s,
            };
            if clock.kind == TimeKind::Tunable && clock.interval_s == Some(interval_s) {
                continue;
            }
            // The interval counts from here.
            clock.interval_s = Some(interval_s);
            clock.base_s = time_s;
            clock.ticks = 1;
            clock.check(unit)?;
            clock.next_s = Some(time_s + interval_s);
        }
        Ok(())
    }
}

impl TimeClock {
    /// Checks that the interval is valid.
    fn check(&self, unit: &impl Steps) -> Result<(), InstanceError> {
        let least_s = if self.kind == TimeKind::Countdown { 0.0 } else { f64::MIN_POSITIVE };
        match self.interval_s {
            Some(interval_s) if !(interval_s >= least_s && interval_s.is_finite()) => {
                Err(InstanceError::unsupported(
                    &unit.base().name,
                    format!("let the clock with value reference {} tick", self.reference),
                    format!("its interval is {interval_s} s, expected a positive one"),
                ))
            }
            _ => Ok(()),
        }
    }
}
