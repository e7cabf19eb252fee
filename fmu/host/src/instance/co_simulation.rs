//! Co-simulation in the order of calls that the standards require.

use super::super::description::Description;
use super::call::Condition;
use super::clocks::Clocks;
use super::common::{functions_of_unit, instance_of_unit};
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
    kept: States<Own>,
    held: Held,
    /// True if a step may end at a time event: the FMU makes steps of any length.
    splits: bool,
    /// True once it was said that a time event is handled late.
    told_late: bool,
}

/// Part of a stored state beside the FMU's own.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Own {
    phase: Phase,
    time_s: f64,
    clocks: Clocks,
    /// Time of the next event that the FMU has announced, s.
    next_event_s: Option<f64>,
}

impl<U: Steps> CoSimulation<U> {
    pub(super) fn new(unit: U) -> Self {
        let clocks = if unit.has_event_mode() {
            Clocks::of(&unit.base().description)
        } else {
            Clocks::default()
        };
        let own = Own { phase: Phase::New, time_s: 0.0, clocks, next_event_s: None };
        let interface = &unit.base().description.co_simulation;
        let splits = interface.as_ref().is_some_and(|interface| interface.variable_step);
        Self { unit, own, kept: States::new(), held: Held::default(), splits, told_late: false }
    }

    /// Updates the discrete states until the FMU needs no more updates, and returns to step mode.
    fn settle(&mut self) -> Result<bool, InstanceError> {
        let mut terminate = false;
        for _ in 0..REPEATS_MAX {
            let update = self.unit.update_discrete_states()?;
            terminate |= update.terminate;
            self.own.next_event_s = update.next_event_time_s;
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

    /// Makes a step that stops where clocks and time events are due. It activates the clocks, and
    /// handles the events: those within a step at its end, where the FMU can't make a shorter one.
    fn step_with_events(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        let end_s = time_s + step_s;
        let close_s = 1e-9 * step_s;
        let mut stepped =
            Stepped { time_s, outcome: StepOutcome::Done, event: false, terminate: false };
        let mut ticks = 0;
        loop {
            self.own.time_s = stepped.time_s;
            let tick_s = self.own.clocks.next_s().unwrap_or(f64::INFINITY);
            let event_s = self.own.next_event_s.unwrap_or(f64::INFINITY);
            if tick_s.min(event_s) <= stepped.time_s + close_s {
                ticks += 1;
                if ticks > REPEATS_MAX {
                    return Err(InstanceError::Endless {
                        fmu: self.name().into(),
                        what: format!(
                            "{REPEATS_MAX} ticks of clocks and time events at {} s",
                            stepped.time_s
                        ),
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
            let next_s = if self.splits { tick_s.min(event_s) } else { tick_s };
            let target_s = if next_s < end_s - close_s { next_s } else { end_s };
            // The nominal length of a whole step: a difference of times would be rounded.
            let whole = stepped.time_s == time_s && target_s == end_s;
            let length_s = if whole { step_s } else { target_s - stepped.time_s };
            stepped = self.unit.do_step(stepped.time_s, length_s)?;
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

    /// Says once that a time event is handled after its time.
    fn tell_late(&mut self) {
        let Own { next_event_s, time_s, .. } = self.own;
        let Some(event_s) = next_event_s.filter(|_| !self.told_late) else { return };
        if event_s >= time_s - 1e-9 * (1.0 + time_s.abs()) {
            return;
        }
        self.told_late = true;
        self.unit.base().note(&format!(
            "the time event at {event_s} s is handled at {time_s} s, the end of the step: the FMU can't vary its step \
             (canHandleVariableCommunicationStepSize)"
        ));
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
    functions_of_unit!();

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
        let done = self.with_access(group, |unit| unit.set(group, values));
        if done.is_ok() && Held::can_be(group, self.unit.has_event_mode()) {
            self.held.learn(group, values);
        } else {
            self.held.forget();
        }
        done
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
        if self.own.clocks.is_empty() && self.own.next_event_s.is_none() {
            return self.unit.do_step(time_s, step_s);
        }
        self.step_with_events(time_s, step_s)
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
        self.tell_late();
        self.unit.enter_event_mode()?;
        self.own.phase = Phase::Event;
        Ok(())
    }

    fn update_discrete_states(&mut self) -> Result<Update, InstanceError> {
        self.expect("an update of the discrete states", &[Phase::Event])?;
        let update = self.unit.update_discrete_states()?;
        self.own.next_event_s = update.next_event_time_s;
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
        self.kept.keep(&mut self.unit, self.own.clone())
    }

    fn restore_state(&mut self, state: u64) -> Result<(), InstanceError> {
        self.held.forget();
        self.own = self.kept.restore(&mut self.unit, state)?;
        Ok(())
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        self.held.forget();
        self.unit.reset()?;
        self.own.phase = Phase::New;
        self.own.next_event_s = None;
        Ok(())
    }
}

instance_of_unit!(CoSimulation, Steps);
