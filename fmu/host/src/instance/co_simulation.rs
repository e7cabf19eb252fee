//! Co-simulation in the order of calls that the standards require.

use super::super::description::Description;
use super::call::Condition;
use super::clocks::Clocks;
use super::held::Held;
use super::states::States;
use super::unit::Steps;
use super::{
    Access, FmuMessage, Instance, InstanceError, REPEATS_MAX, StepOutcome, Stepped, Update,
    VariableGroup,
};
use serde::{Deserialize, Serialize};

/// Phase in the life of an instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Phase {
    /// After instantiation or reset.
    New,
    /// In initialization mode.
    Initialization,
    /// Ready for a step.
    Step,
    /// In event mode.
    Event,
    /// Terminated.
    End,
}

impl Phase {
    /// Describes the phase for an error.
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::New => "before the initialization",
            Self::Initialization => "during the initialization",
            Self::Step => "between steps",
            Self::Event => "in event mode",
            Self::End => "after the end",
        }
    }
}

/// A co-simulation FMU.
pub(super) struct CoSimulation<U: Steps> {
    unit: U,
    own: Own,
    states: States<Own>,
    held: Held,
}

/// Part of a stored state beside the FMU's own.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Own {
    phase: Phase,
    time_s: f64,
    clocks: Clocks,
}

impl<U: Steps> CoSimulation<U> {
    pub(super) fn new(unit: U) -> Self {
        let clocks = if unit.has_event_mode() {
            Clocks::of(&unit.base().description)
        } else {
            Clocks::default()
        };
        let own = Own { phase: Phase::New, time_s: 0.0, clocks };
        Self { unit, own, states: States::new(), held: Held::default() }
    }

    fn expect(&self, what: &str, phases: &[Phase]) -> Result<(), InstanceError> {
        if phases.contains(&self.own.phase) {
            Ok(())
        } else {
            Err(self.unit.base().order(what, self.own.phase.words()))
        }
    }

    /// Updates the discrete states until the FMU needs no more updates, and returns to step mode.
    fn settle(&mut self) -> Result<bool, InstanceError> {
        let mut terminate = false;
        for _ in 0..REPEATS_MAX {
            let update = self.unit.update_discrete_states()?;
            terminate |= update.terminate;
            if !self.own.clocks.is_empty() {
                self.own.clocks.ask(&mut self.unit, self.own.time_s)?;
            }
            if terminate || !update.again {
                self.unit.enter_step_mode()?;
                self.own.phase = Phase::Step;
                return Ok(terminate);
            }
        }
        Err(InstanceError::Endless {
            fmu: self.name().into(),
            what: format!("{REPEATS_MAX} updates of the discrete states at one event"),
        })
    }

    /// Makes a step that stops where clocks are due, and activates them.
    fn step_with_clocks(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        let end_s = time_s + step_s;
        let close_s = 1e-9 * step_s;
        let mut stepped =
            Stepped { time_s, outcome: StepOutcome::Done, event: false, terminate: false };
        let mut ticks = 0;
        loop {
            self.own.time_s = stepped.time_s;
            let next_s = self.own.clocks.next_s().unwrap_or(f64::INFINITY);
            if next_s <= stepped.time_s + close_s {
                ticks += 1;
                if ticks > REPEATS_MAX {
                    return Err(InstanceError::Endless {
                        fmu: self.name().into(),
                        what: format!("{REPEATS_MAX} ticks of clocks at {} s", stepped.time_s),
                    });
                }
                self.enter_event_mode()?;
                self.own.clocks.tick(&mut self.unit, stepped.time_s + close_s)?;
                if self.settle()? {
                    return Ok(Stepped { outcome: StepOutcome::Early, terminate: true, ..stepped });
                }
                continue;
            }
            if stepped.time_s >= end_s - close_s {
                return Ok(Stepped { time_s: end_s, ..stepped });
            }
            ticks = 0;
            let target_s = if next_s < end_s - close_s { next_s } else { end_s };
            stepped = self.unit.do_step(stepped.time_s, target_s - stepped.time_s)?;
            if stepped.outcome == StepOutcome::Done {
                stepped.time_s = target_s;
            }
            // Events and ends of the FMU are handled by the caller; before the end of the step this
            // is an early return.
            if stepped.outcome != StepOutcome::Done || stepped.event || stepped.terminate {
                self.own.time_s = stepped.time_s;
                if stepped.outcome == StepOutcome::Done && target_s < end_s {
                    stepped.outcome = StepOutcome::Early;
                }
                return Ok(stepped);
            }
        }
    }

    /// Brings the FMU to a mode in which a group can be set, sets it, and leaves configuration mode
    /// again.
    fn with_access(
        &mut self,
        group: &VariableGroup,
        set: impl FnOnce(&mut U) -> Result<(), InstanceError>,
    ) -> Result<(), InstanceError> {
        match group.access {
            Access::Event if self.own.phase == Phase::Step && self.unit.has_event_mode() => {
                self.unit.enter_event_mode()?;
                self.own.phase = Phase::Event;
            }
            Access::Configuration => {
                self.unit.enter_configuration_mode()?;
                let done = set(&mut self.unit);
                return done.and(self.unit.exit_configuration_mode());
            }
            Access::Event | Access::Step => {}
        }
        set(&mut self.unit)
    }
}

impl<U: Steps> Instance for CoSimulation<U> {
    fn name(&self) -> &str {
        &self.unit.base().name
    }

    fn description(&self) -> &Description {
        &self.unit.base().description
    }

    fn enter_initialization(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), InstanceError> {
        self.expect("the initialization", &[Phase::New])?;
        self.unit.enter_initialization(start_s, stop_s, tolerance)?;
        self.own.time_s = start_s;
        self.own.phase = Phase::Initialization;
        Ok(())
    }

    fn exit_initialization(&mut self) -> Result<bool, InstanceError> {
        self.expect("the end of the initialization", &[Phase::Initialization])?;
        self.unit.exit_initialization()?;
        if self.unit.has_event_mode() {
            self.own.phase = Phase::Event;
            if !self.own.clocks.is_empty() {
                self.own.clocks.start(&mut self.unit, self.own.time_s)?;
                self.own.clocks.tick(&mut self.unit, self.own.time_s)?;
            }
            return self.settle();
        }
        self.own.phase = Phase::Step;
        Ok(false)
    }

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
        self.held.forget();
        self.with_access(group, |unit| unit.set(group, values))
    }

    fn set_in_exchange(
        &mut self,
        place: usize,
        group: &VariableGroup,
        values: &[f64],
    ) -> Result<(), InstanceError> {
        let can_be_held = Held::can_be(group, self.unit.has_event_mode());
        if can_be_held && self.held.is(place, group, values) {
            return Ok(());
        }
        let done = self.with_access(group, |unit| unit.set(group, values));
        if done.is_err() {
            // The FMU may have taken a part.
            self.held.forget();
        } else if can_be_held {
            self.held.keep(place, group, values);
        }
        done
    }

    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError> {
        self.unit.get(group, values)
    }

    fn set_strings(
        &mut self,
        group: &VariableGroup,
        values: &[String],
    ) -> Result<(), InstanceError> {
        self.with_access(group, |unit| unit.set_strings(group, values))
    }

    fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError> {
        self.unit.get_strings(group)
    }

    fn set_binaries(
        &mut self,
        group: &VariableGroup,
        values: &[Vec<u8>],
    ) -> Result<(), InstanceError> {
        self.with_access(group, |unit| unit.set_binaries(group, values))
    }

    fn get_binaries(&mut self, group: &VariableGroup) -> Result<Vec<Vec<u8>>, InstanceError> {
        self.unit.get_binaries(group)
    }

    fn step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        // A step of length zero would be an event, a negative one a return to the past.
        if !(time_s.is_finite() && step_s.is_finite() && step_s > 0.0) {
            return Err(InstanceError::unsupported(
                self.name(),
                format!("step from {time_s} s by {step_s} s"),
                "a step has a positive length",
            ));
        }
        self.own.time_s = time_s;
        let ended = self.own.phase == Phase::Event && self.settle()?;
        self.expect("a step", &[Phase::Step])?;
        if ended {
            return Ok(Stepped {
                time_s,
                outcome: StepOutcome::Early,
                event: false,
                terminate: true,
            });
        }
        if self.own.clocks.is_empty() {
            return self.unit.do_step(time_s, step_s);
        }
        self.step_with_clocks(time_s, step_s)
    }

    fn handle_events(&mut self) -> Result<bool, InstanceError> {
        match self.own.phase {
            Phase::Step if !self.unit.has_event_mode() => return Ok(false),
            Phase::Step => self.enter_event_mode()?,
            _ => self.expect("the handling of events", &[Phase::Event])?,
        }
        self.settle()
    }

    fn enter_event_mode(&mut self) -> Result<(), InstanceError> {
        self.expect("event mode", &[Phase::Step])?;
        if !self.unit.has_event_mode() {
            return Err(InstanceError::unsupported(
                self.name(),
                "enter event mode",
                "it has none, or it isn't used",
            ));
        }
        self.unit.enter_event_mode()?;
        self.own.phase = Phase::Event;
        Ok(())
    }

    fn update_discrete_states(&mut self) -> Result<Update, InstanceError> {
        self.expect("an update of the discrete states", &[Phase::Event])?;
        let update = self.unit.update_discrete_states()?;
        if !self.own.clocks.is_empty() {
            self.own.clocks.ask(&mut self.unit, self.own.time_s)?;
        }
        Ok(update)
    }

    fn leave_event_mode(&mut self) -> Result<(), InstanceError> {
        self.expect("the end of event mode", &[Phase::Event])?;
        self.unit.enter_step_mode()?;
        self.own.phase = Phase::Step;
        Ok(())
    }

    fn keep_state(&mut self) -> Result<u64, InstanceError> {
        self.states.keep(&mut self.unit, self.own.clone())
    }

    fn restore_state(&mut self, state: u64) -> Result<(), InstanceError> {
        self.held.forget();
        self.own = self.states.restore(&mut self.unit, state)?;
        Ok(())
    }

    fn forget_state(&mut self, state: u64) -> Result<(), InstanceError> {
        self.states.forget(&mut self.unit, state)
    }

    fn state_to_bytes(&mut self, state: u64) -> Result<Vec<u8>, InstanceError> {
        self.states.save(&mut self.unit, state)
    }

    fn state_from_bytes(&mut self, bytes: &[u8]) -> Result<u64, InstanceError> {
        self.states.load(&mut self.unit, bytes)
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        self.held.forget();
        self.unit.reset()?;
        self.own.phase = Phase::New;
        Ok(())
    }

    fn terminate(&mut self) -> Result<(), InstanceError> {
        self.expect("the end", &[Phase::Step, Phase::Event])?;
        self.unit.terminate()?;
        self.own.phase = Phase::End;
        Ok(())
    }

    fn messages(&mut self) -> Vec<FmuMessage> {
        self.unit.base().messages()
    }
}

impl<U: Steps> Drop for CoSimulation<U> {
    fn drop(&mut self) {
        let runs = matches!(self.own.phase, Phase::Step | Phase::Event);
        if runs && self.unit.base().condition == Condition::Sound {
            // The instance is freed in any case, so that the answer doesn't matter.
            let _ = self.unit.terminate();
        }
        self.states.clear(&mut self.unit);
    }
}
