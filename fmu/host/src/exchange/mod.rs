//! Model exchange as co-simulation: Octant's solver takes the FMU from one communication point to
//! the next, with its events.
//!
//! | module | idea |
//! |---|---|
//! | `solver` | integration of the equations, with error control and dense output |
//! | `crossing` | detection of sign changes of event indicators |
//! | `integrate` | integration from one communication point to the next |
//! | `fmi2`, `fmi3` | the functions of each standard |
//!
//! Between communication points inputs are constant, so that setting one is an event: the discrete
//! equations are updated, and the solver restarts. The method is explicit: a stiff model is
//! integrated correctly, but in many small steps, up to a limit.

mod crossing;
mod fmi2;
mod fmi3;
mod integrate;
mod solver;

use super::description::Description;
use super::instance::call::Condition;
use super::instance::co_simulation::Phase;
use super::instance::states::States;
use super::instance::unit::Continuous;
use super::instance::{
    Access, FmuMessage, Instance, InstanceError, StepOutcome, Stepped, Update, VariableGroup,
};
use crossing::Indicators;
use serde::{Deserialize, Serialize};
use solver::Solver;

/// Relative tolerance if neither the user nor the description gives one.
const TOLERANCE: f64 = 1e-6;

/// Largest number of continuous states, and of event indicators, of an FMU.
const COUNT_MAX: usize = 1 << 24;

/// A model exchange FMU with its solver.
pub(super) struct Exchange<U: Continuous> {
    unit: U,
    /// True if the FMU has to be told the end of each step of the solver.
    tells_steps: bool,
    own: Own,
    tolerance: f64,
    states: Vec<f64>,
    nominals: Vec<f64>,
    solver: Solver,
    indicators: Indicators,
    kept: States<Own>,
}

/// Part of a stored state beside the FMU's own. The FMU is in continuous-time mode in
/// [`Phase::Step`].
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Own {
    phase: Phase,
    time_s: f64,
    next_event_s: Option<f64>,
    natural_s: f64,
}

impl<U: Continuous> Exchange<U> {
    pub(super) fn new(unit: U, tells_steps: bool) -> Self {
        let tolerance = unit.base().description.default_experiment.tolerance;
        Self {
            unit,
            tells_steps,
            own: Own { phase: Phase::New, time_s: 0.0, next_event_s: None, natural_s: 0.0 },
            tolerance: tolerance.unwrap_or(TOLERANCE),
            states: Vec::new(),
            nominals: Vec::new(),
            solver: Solver::new(TOLERANCE, &[]),
            indicators: Indicators::new(0, 0),
            kept: States::new(),
        }
    }

    fn expect(&self, what: &str, phases: &[Phase]) -> Result<(), InstanceError> {
        if phases.contains(&self.own.phase) {
            Ok(())
        } else {
            Err(self.unit.base().order(what, self.own.phase.words()))
        }
    }

    /// Makes room for the FMU's present numbers of states and indicators.
    fn make_room(&mut self) -> Result<(), InstanceError> {
        let (states, indicators) = self.unit.counts()?;
        if states > COUNT_MAX || indicators > COUNT_MAX {
            return Err(InstanceError::unsupported(
                self.name(),
                "be integrated",
                format!("it has {states} states and {indicators} event indicators"),
            ));
        }
        self.states = vec![0.0; states];
        self.nominals = vec![1.0; states];
        self.solver = Solver::new(self.tolerance, &self.nominals);
        self.indicators = Indicators::new(indicators, states);
        Ok(())
    }

    /// Reads the FMU's states after a start, an event or a restored state.
    fn take_states(&mut self, nominals: bool) -> Result<(), InstanceError> {
        self.solver.forget();
        if !self.states.is_empty() {
            self.unit.states(&mut self.states)?;
            if nominals {
                self.unit.nominals(&mut self.nominals)?;
                self.solver.set_nominals(self.tolerance, &self.nominals);
            }
        }
        self.indicators.settle(&mut self.unit)
    }

    /// Brings the FMU to a mode in which a group can be set, sets it, and leaves configuration mode
    /// again.
    fn with_access(
        &mut self,
        group: &VariableGroup,
        set: impl FnOnce(&mut U) -> Result<(), InstanceError>,
    ) -> Result<(), InstanceError> {
        if group.access == Access::Configuration {
            self.unit.enter_configuration_mode()?;
            let done = set(&mut self.unit);
            return done.and(self.unit.exit_configuration_mode());
        }
        if self.own.phase == Phase::Step {
            self.enter_event_mode()?;
        }
        set(&mut self.unit)
    }
}

impl<U: Continuous> Instance for Exchange<U> {
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
        if let Some(tolerance) = tolerance {
            self.tolerance = tolerance;
        }
        self.unit.enter_initialization(start_s, stop_s, Some(self.tolerance))?;
        self.own.time_s = start_s;
        self.own.phase = Phase::Initialization;
        Ok(())
    }

    fn exit_initialization(&mut self) -> Result<bool, InstanceError> {
        self.expect("the end of the initialization", &[Phase::Initialization])?;
        self.unit.exit_initialization()?;
        self.own.phase = Phase::Event;
        self.make_room()?;
        let terminate = self.settle()?;
        self.take_states(true)?;
        Ok(terminate)
    }

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
        self.with_access(group, |unit| unit.set(group, values))
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
        self.expect("a step", &[Phase::Step, Phase::Event])?;
        self.integrate(time_s, step_s)
    }

    fn handle_events(&mut self) -> Result<bool, InstanceError> {
        if self.own.phase == Phase::Step {
            self.enter_event_mode()?;
        }
        self.expect("the handling of events", &[Phase::Event])?;
        self.settle()
    }

    fn enter_event_mode(&mut self) -> Result<(), InstanceError> {
        self.expect("event mode", &[Phase::Step])?;
        self.unit.enter_event_mode()?;
        self.own.phase = Phase::Event;
        Ok(())
    }

    fn update_discrete_states(&mut self) -> Result<Update, InstanceError> {
        self.expect("an update of the discrete states", &[Phase::Event])?;
        let update = self.unit.update_discrete_states()?;
        self.own.next_event_s = update.next_event_time_s;
        Ok(update)
    }

    fn leave_event_mode(&mut self) -> Result<(), InstanceError> {
        self.expect("the end of event mode", &[Phase::Event])?;
        self.unit.enter_continuous_time_mode()?;
        self.own.phase = Phase::Step;
        // A caller that handled the FMU's events itself doesn't report the changes: everything is
        // read again.
        self.take_states(true)
    }

    fn keep_state(&mut self) -> Result<u64, InstanceError> {
        let own = Own { natural_s: self.solver.natural_s(), ..self.own };
        self.kept.keep(&mut self.unit, own)
    }

    fn restore_state(&mut self, state: u64) -> Result<(), InstanceError> {
        self.own = self.kept.restore(&mut self.unit, state)?;
        if matches!(self.own.phase, Phase::Step | Phase::Event) {
            let (states, _) = self.unit.counts()?;
            if states != self.states.len() {
                self.make_room()?;
            }
            self.solver.set_natural(self.own.natural_s);
            self.take_states(true)?;
        }
        Ok(())
    }

    fn forget_state(&mut self, state: u64) -> Result<(), InstanceError> {
        self.kept.forget(&mut self.unit, state)
    }

    fn state_to_bytes(&mut self, state: u64) -> Result<Vec<u8>, InstanceError> {
        self.kept.save(&mut self.unit, state)
    }

    fn state_from_bytes(&mut self, bytes: &[u8]) -> Result<u64, InstanceError> {
        self.kept.load(&mut self.unit, bytes)
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        self.unit.reset()?;
        self.own = Own { phase: Phase::New, time_s: 0.0, next_event_s: None, natural_s: 0.0 };
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

impl<U: Continuous> Drop for Exchange<U> {
    fn drop(&mut self) {
        let runs = matches!(self.own.phase, Phase::Step | Phase::Event);
        if runs && self.unit.base().condition == Condition::Sound {
            // The instance is freed in any case, so that the answer doesn't matter.
            let _ = self.unit.terminate();
        }
        self.kept.clear(&mut self.unit);
    }
}

/// Result of a step at which the FMU requests the end before the step's end.
fn ended(time_s: f64) -> Stepped {
    Stepped { time_s, outcome: StepOutcome::Early, event: false, terminate: true }
}
