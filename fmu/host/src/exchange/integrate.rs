//! Integration from one communication point to the next.

use super::super::instance::co_simulation::Phase;
use super::super::instance::unit::Continuous;
use super::super::instance::{Instance, InstanceError, REPEATS_MAX, StepOutcome, Stepped};
use super::{Exchange, ended};

/// Largest number of the solver's attempts at a step within one communication step.
const SOLVER_STEPS_MAX: usize = 1_000_000;

/// Reason why the solver stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stop {
    /// The target is reached.
    Target,
    /// An event occurred.
    Event,
    /// The FMU requests the end of the simulation.
    End,
}

impl<U: Continuous> Exchange<U> {
    /// Makes one communication step.
    pub(super) fn integrate(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        let end_s = time_s + step_s;
        // Times that differ only by rounding are equal.
        let close_s = 1e-9 * step_s + 4.0 * f64::EPSILON * end_s.abs();
        if !(step_s > 0.0 && end_s.is_finite() && (time_s - self.own.time_s).abs() <= close_s) {
            return Err(InstanceError::unsupported(
                self.name(),
                format!("step from {time_s} s by {step_s} s"),
                format!("its time is {} s, and a step has a positive length", self.own.time_s),
            ));
        }
        self.own.time_s = time_s;
        if self.own.phase == Phase::Event && self.settle()? {
            return Ok(ended(time_s));
        }
        let mut events = 0;
        let mut last_event_s = f64::NEG_INFINITY;
        loop {
            let due =
                self.own.next_event_s.is_some_and(|next_s| next_s <= self.own.time_s + close_s);
            let stop = if due {
                Stop::Event
            } else if self.own.time_s >= end_s {
                return Ok(Stepped {
                    time_s: end_s,
                    outcome: StepOutcome::Done,
                    event: false,
                    terminate: false,
                });
            } else {
                let next_s = self.own.next_event_s.unwrap_or(f64::INFINITY);
                let target_s = if next_s < end_s - close_s { next_s } else { end_s };
                self.go(target_s)?
            };
            match stop {
                Stop::Target => {}
                Stop::End => return Ok(ended(self.own.time_s)),
                Stop::Event => {
                    // Events at which time doesn't advance would never end.
                    if self.own.time_s > last_event_s + close_s {
                        events = 0;
                        last_event_s = self.own.time_s;
                    }
                    events += 1;
                    if events > REPEATS_MAX {
                        return Err(InstanceError::Endless {
                            fmu: self.name().into(),
                            what: format!("{REPEATS_MAX} events at {last_event_s} s"),
                        });
                    }
                    // The FMU compares its time with that of the event, so that both have to agree
                    // to the bit.
                    if let Some(next_s) = self.own.next_event_s.filter(|_| due)
                        && next_s > self.own.time_s
                    {
                        self.own.time_s = next_s;
                        self.unit.set_time(next_s)?;
                    }
                    self.enter_event_mode()?;
                    if self.settle()? {
                        return Ok(ended(self.own.time_s));
                    }
                }
            }
        }
    }

    /// Updates the discrete states until the FMU needs no more updates, and returns to continuous
    /// time; returns true if the FMU requests the end.
    pub(super) fn settle(&mut self) -> Result<bool, InstanceError> {
        let mut nominals = false;
        for _ in 0..REPEATS_MAX {
            let update = self.unit.update_discrete_states()?;
            nominals |= update.nominals_changed;
            if update.terminate || !update.again {
                self.own.next_event_s = update.next_event_time_s;
                self.unit.enter_continuous_time_mode()?;
                self.own.phase = Phase::Step;
                self.take_states(nominals)?;
                return Ok(update.terminate);
            }
        }
        Err(InstanceError::Endless {
            fmu: self.name().into(),
            what: format!("{REPEATS_MAX} updates of the discrete states at one event"),
        })
    }

    /// Integrates until the target or an event before it.
    fn go(&mut self, target_s: f64) -> Result<Stop, InstanceError> {
        if self.states.is_empty() {
            let from_s = self.own.time_s;
            let crossing =
                self.indicators.first_crossing(&mut self.unit, None, from_s, target_s)?;
            let at_s = crossing.unwrap_or(target_s);
            self.unit.set_time(at_s)?;
            return self.completed(at_s, crossing.is_some(), target_s);
        }
        for _ in 0..SOLVER_STEPS_MAX {
            let (time_s, unit) = (self.own.time_s, &mut self.unit);
            if !self.solver.step(unit, time_s, &self.states, target_s)? {
                continue;
            }
            let (from_s, mut to_s) = self.solver.span();
            // A step to the target ends exactly there, regardless of rounding.
            let rounding_s = 8.0 * f64::EPSILON * target_s.abs();
            if to_s >= target_s - rounding_s {
                to_s = target_s;
            }
            let crossing =
                self.indicators.first_crossing(unit, Some(&mut self.solver), from_s, to_s)?;
            let at_s = crossing.unwrap_or(to_s);
            if crossing.is_some() {
                self.solver.states_at(at_s, &mut self.states);
            } else {
                self.states.copy_from_slice(self.solver.states());
            }
            unit.set_time(at_s)?;
            if !unit.set_states(&self.states)? {
                return Err(InstanceError::Integration {
                    fmu: self.name().into(),
                    time_s,
                    reason: "it refuses the states that it came to".into(),
                });
            }
            let stop = self.completed(at_s, crossing.is_some(), target_s)?;
            if stop != Stop::Target || at_s >= target_s {
                return Ok(stop);
            }
        }
        Err(InstanceError::Integration {
            fmu: self.name().into(),
            time_s: self.own.time_s,
            reason: format!(
                "{SOLVER_STEPS_MAX} steps of the solver don't suffice; its equations are stiff"
            ),
        })
    }

    /// Reports a completed step to the FMU.
    fn completed(
        &mut self,
        time_s: f64,
        crossing: bool,
        target_s: f64,
    ) -> Result<Stop, InstanceError> {
        self.own.time_s = time_s;
        let (event, terminate) =
            if self.tells_steps { self.unit.completed_step()? } else { (false, false) };
        debug_assert!(time_s <= target_s, "{time_s} is beyond {target_s}");
        Ok(if terminate {
            Stop::End
        } else if event || crossing {
            Stop::Event
        } else {
            Stop::Target
        })
    }
}
