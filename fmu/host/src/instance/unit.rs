//! Functions of both standards in one form. Each is one call, or the few that one standard needs
//! where the other needs one; the user of the trait is responsible for the order of calls.

use super::call::Base;
use super::clock_update::WatchedClocks;
use super::{ClockNews, InstanceError, Stepped, Update, VariableGroup};
use std::ffi::c_void;
use std::sync::Arc;

/// A state as returned by the FMU.
pub(crate) type RawState = *mut c_void;

/// Common functions of co-simulation and model exchange.
pub(crate) trait Unit: Send {
    fn base(&self) -> &Base;

    fn enter_initialization(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), InstanceError>;
    fn exit_initialization(&mut self) -> Result<(), InstanceError>;
    fn terminate(&mut self) -> Result<(), InstanceError>;
    fn reset(&mut self) -> Result<(), InstanceError>;

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError>;
    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError>;
    fn set_strings(
        &mut self,
        group: &VariableGroup,
        values: &[String],
    ) -> Result<(), InstanceError>;
    fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError>;
    fn set_binaries(
        &mut self,
        group: &VariableGroup,
        values: &[Vec<u8>],
    ) -> Result<(), InstanceError>;
    fn get_binaries(&mut self, group: &VariableGroup) -> Result<Vec<Vec<u8>>, InstanceError>;

    fn enter_configuration_mode(&mut self) -> Result<(), InstanceError>;
    fn exit_configuration_mode(&mut self) -> Result<(), InstanceError>;

    fn enter_event_mode(&mut self) -> Result<(), InstanceError>;
    fn update_discrete_states(&mut self) -> Result<Update, InstanceError>;

    fn state(&mut self) -> Result<RawState, InstanceError>;
    fn set_state(&mut self, state: RawState) -> Result<(), InstanceError>;
    fn free_state(&mut self, state: RawState) -> Result<(), InstanceError>;
    fn serialize(&mut self, state: RawState) -> Result<Vec<u8>, InstanceError>;
    fn deserialize(&mut self, bytes: &[u8]) -> Result<RawState, InstanceError>;
}

/// Co-simulation.
pub(crate) trait Steps: Unit {
    /// Returns whether the importer uses event mode.
    fn has_event_mode(&self) -> bool;
    fn enter_step_mode(&mut self) -> Result<(), InstanceError>;
    fn do_step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError>;
    /// Interval of a clock.
    fn interval(&mut self, clock: u32) -> Result<Interval, InstanceError>;
    /// Activates a clock.
    fn activate(&mut self, clock: u32) -> Result<(), InstanceError>;
}

/// Scheduled execution.
pub(crate) trait Partitions: Steps {
    /// Activates the model partition of an input clock. When the FMU calls back meanwhile, the
    /// watched clocks are asked.
    fn activate_partition(
        &mut self,
        clock: u32,
        time_s: f64,
        watched: &Arc<WatchedClocks>,
    ) -> Result<ClockNews, InstanceError>;
}

/// Answer of an FMU on a clock's interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Interval {
    /// The interval isn't known yet.
    Unknown,
    /// The interval is unchanged, s.
    Unchanged(f64),
    /// The interval is new, s.
    Changed(f64),
}

/// Model exchange. If a value can't be computed (the FMU discards the call), this is no failure but
/// the answer `false`: the solver tries elsewhere.
#[cfg_attr(not(feature = "model-exchange"), expect(dead_code, reason = "only the solver needs it"))]
pub(crate) trait Continuous: Unit {
    /// Numbers of continuous states and of event indicators.
    fn counts(&mut self) -> Result<(usize, usize), InstanceError>;
    fn enter_continuous_time_mode(&mut self) -> Result<(), InstanceError>;
    fn set_time(&mut self, time_s: f64) -> Result<(), InstanceError>;
    fn set_states(&mut self, states: &[f64]) -> Result<bool, InstanceError>;
    fn states(&mut self, states: &mut [f64]) -> Result<(), InstanceError>;
    fn derivatives(&mut self, derivatives: &mut [f64]) -> Result<bool, InstanceError>;
    fn indicators(&mut self, indicators: &mut [f64]) -> Result<bool, InstanceError>;
    fn nominals(&mut self, nominals: &mut [f64]) -> Result<(), InstanceError>;
    /// Reports a completed step of the solver; returns whether there is an event, and whether the
    /// FMU requests the end.
    fn completed_step(&mut self) -> Result<(bool, bool), InstanceError>;
}
