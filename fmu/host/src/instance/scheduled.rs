//! Scheduled execution (FMI 3.0, 5.2) in the order of calls that the standard requires. The times and the
//! order of the activations are the caller's.

use super::super::description::{Causality, Description, IntervalVariability, VariableType};
use super::call::Condition;
use super::clock_update::WatchedClocks;
use super::co_simulation::Phase;
use super::common::{functions_of_unit, instance_of_unit};
use super::states::States;
use super::unit::{Interval, Partitions};
use super::{
    Access, ClockNews, FmuMessage, Instance, InstanceError, Stepped, Update, VariableGroup,
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// An FMU whose model partitions are activated.
pub(super) struct ScheduledExecution<U: Partitions> {
    unit: U,
    own: Own,
    kept: States<Own>,
    watched: Arc<WatchedClocks>,
}

/// Part of a stored state beside the FMU's own.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Own {
    phase: Phase,
}

impl<U: Partitions> ScheduledExecution<U> {
    pub(super) fn new(unit: U) -> Self {
        let mut watched = WatchedClocks::default();
        for variable in &unit.base().description.variables {
            let countdown = variable
                .clock
                .is_some_and(|clock| clock.interval_variability == IntervalVariability::Countdown);
            match variable.causality {
                _ if variable.kind != VariableType::Clock => {}
                Causality::Output => watched.outputs.push(variable.reference),
                Causality::Input if countdown => watched.countdowns.push(variable.reference),
                _ => {}
            }
        }
        let own = Own { phase: Phase::New };
        Self { unit, own, kept: States::new(), watched: Arc::new(watched) }
    }

    /// Sets a group, in configuration mode where it needs that. Everything else can be set between
    /// activations.
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
        set(&mut self.unit)
    }

    fn no_steps<T>(&self, what: &str) -> Result<T, InstanceError> {
        let reason =
            "it is run by scheduled execution, in which its model partitions are activated";
        Err(InstanceError::unsupported(self.name(), what, reason))
    }
}

impl<U: Partitions> Instance for ScheduledExecution<U> {
    functions_of_unit!();

    fn enter_initialization(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), InstanceError> {
        self.expect("the initialization", &[Phase::New])?;
        self.unit.enter_initialization(start_s, stop_s, tolerance)?;
        self.own.phase = Phase::Initialization;
        Ok(())
    }

    fn exit_initialization(&mut self) -> Result<bool, InstanceError> {
        self.expect("the end of the initialization", &[Phase::Initialization])?;
        self.unit.exit_initialization()?;
        self.own.phase = Phase::Step;
        Ok(false)
    }

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
        self.with_access(group, |unit| unit.set(group, values))
    }

    fn activate_partition(&mut self, clock: u32, time_s: f64) -> Result<ClockNews, InstanceError> {
        self.expect("the activation of a model partition", &[Phase::Step])?;
        self.unit.activate_partition(clock, time_s, &self.watched)
    }

    fn partition_interval_s(&mut self, clock: u32) -> Result<Option<f64>, InstanceError> {
        Ok(match self.unit.interval(clock)? {
            Interval::Unknown => None,
            Interval::Unchanged(interval_s) | Interval::Changed(interval_s) => Some(interval_s),
        })
    }

    fn step(&mut self, _time_s: f64, _step_s: f64) -> Result<Stepped, InstanceError> {
        self.no_steps("make a step")
    }

    fn handle_events(&mut self) -> Result<bool, InstanceError> {
        Ok(false)
    }

    fn enter_event_mode(&mut self) -> Result<(), InstanceError> {
        self.no_steps("enter event mode")
    }

    fn update_discrete_states(&mut self) -> Result<Update, InstanceError> {
        self.no_steps("update the discrete states")
    }

    fn leave_event_mode(&mut self) -> Result<(), InstanceError> {
        self.no_steps("leave event mode")
    }

    fn keep_state(&mut self) -> Result<u64, InstanceError> {
        self.kept.keep(&mut self.unit, self.own.clone())
    }

    fn restore_state(&mut self, state: u64) -> Result<(), InstanceError> {
        self.own = self.kept.restore(&mut self.unit, state)?;
        Ok(())
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        self.unit.reset()?;
        self.own.phase = Phase::New;
        Ok(())
    }
}

instance_of_unit!(ScheduledExecution, Partitions);
