//! A running FMU, of both standards and both kinds, behind one trait.
//!
//! | module | idea |
//! |---|---|
//! | [`group`] | variables that are set or got together, and the positions of their numbers |
//! | [`options`] | options for opening an FMU |
//! | [`open`] | opening an FMU: its archive, its description, its library, an instance |
//! | `once` | FMUs that allow only one instance in a process |
//! | `setup` | data with which an instance is made |
//! | [`error`] | errors of a running FMU |
//! | `message` | messages that an FMU logs |
//! | `call` | one call of a function: its name, its status, the meaning of the status |
//! | [`whole`] | whole numbers of 64 bits as their bits |
//! | `number` | conversion between f64 and the number types of FMI, checked |
//! | `scratch` | buffers through which numbers of other types than f64 are got and set |
//! | `unit` | functions of both standards in one form |
//! | `fmi2`, `fmi3` | the functions of each standard |
//! | `states` | stored states, and states as bytes |
//! | `clocks` | ticks of time-based clocks |
//! | `common` | the part that co-simulation and model exchange have in common |
//! | `co_simulation` | co-simulation in the order of calls that the standards require |
//! | `scheduled` | scheduled execution: model partitions that the caller activates |
//! | `clock_update` | callbacks of scheduled execution |

pub(super) mod call;
mod clock_update;
mod clocks;
pub(super) mod co_simulation;
pub(super) mod common;
pub mod error;
pub(super) mod fmi2;
pub(super) mod fmi3;
pub mod group;
mod held;
mod message;
mod number;
pub(super) mod once;
pub mod open;
pub mod options;
mod scheduled;
mod scratch;
pub(super) mod setup;
pub(super) mod states;
pub(super) mod unit;
pub mod whole;

pub use clock_update::ClockNews;
pub use error::InstanceError;
pub use group::{Access, AccessPlan, VariableGroup};
pub use message::FmuMessage;
pub use open::FmuOpenError;
pub use options::{InterfaceKind, OpenOptions, ProcessPlace};

use super::description::Description;
use serde::{Deserialize, Serialize};

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stepped {
    /// Time reached, s: the end of the step, or earlier.
    pub time_s: f64,
    /// Outcome.
    pub outcome: StepOutcome,
    /// True if events have to be handled: [`Instance::handle_events`].
    pub event: bool,
    /// True if the FMU requests the end of the simulation.
    pub terminate: bool,
}

/// Outcome of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum StepOutcome {
    /// The step was completed.
    Done,
    /// The FMU returned before the end of the step, at an event.
    Early,
    /// The FMU refused the step, or made only a part of it: another step may be tried from a stored
    /// state.
    Discarded,
}

/// Result of an update of the discrete states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Update {
    /// True if another update is needed.
    pub again: bool,
    /// True if the FMU requests the end of the simulation.
    pub terminate: bool,
    /// True if nominals of the continuous states have changed.
    pub nominals_changed: bool,
    /// True if continuous states have changed.
    pub states_changed: bool,
    /// Next time event, s, if there is one.
    pub next_event_time_s: Option<f64>,
}

/// Largest number of early returns within one exchange, and of updates of the discrete states at
/// one event, before they count as endless.
pub const REPEATS_MAX: usize = 1000;

const NOT_SCHEDULED: &str = "it isn't run by scheduled execution";

/// Operations on one FMU, in this process or in another.
pub trait Instance: Send {
    /// Name in errors: the file's, or the model's.
    fn name(&self) -> &str;

    /// Description of the FMU.
    fn description(&self) -> &Description;

    /// Starts the initialization. Variables are set before and during it.
    ///
    /// # Errors
    /// If the FMU fails; the same holds for all following functions.
    fn enter_initialization(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), InstanceError>;

    /// Ends the initialization, and handles the first events; returns true if the FMU requests the
    /// end of the simulation at once.
    ///
    /// # Errors
    /// If the FMU fails.
    fn exit_initialization(&mut self) -> Result<bool, InstanceError>;

    /// Sets numbers. Values that may only be set at events ([`Access::Event`]) are set at one,
    /// which lasts until the next step.
    ///
    /// # Errors
    /// If the FMU fails or refuses a value, or a number doesn't fit the type.
    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError>;

    /// Sets as [`Self::set`] the group at `place` in an [`Self::exchange`]: an implementation that
    /// knows the FMU's present values can skip unchanged ones.
    ///
    /// # Errors
    /// As [`Self::set`].
    fn set_in_exchange(
        &mut self,
        _place: usize,
        group: &VariableGroup,
        values: &[f64],
    ) -> Result<(), InstanceError> {
        self.set(group, values)
    }

    /// Gets numbers.
    ///
    /// # Errors
    /// If the FMU fails.
    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError>;

    /// Sets texts.
    ///
    /// # Errors
    /// If the FMU fails or refuses a value.
    fn set_strings(
        &mut self,
        group: &VariableGroup,
        values: &[String],
    ) -> Result<(), InstanceError>;

    /// Gets texts.
    ///
    /// # Errors
    /// If the FMU fails.
    fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError>;

    /// Sets bytes (FMI 3.0).
    ///
    /// # Errors
    /// If the FMU fails or refuses a value.
    fn set_binaries(
        &mut self,
        group: &VariableGroup,
        values: &[Vec<u8>],
    ) -> Result<(), InstanceError>;

    /// Gets bytes (FMI 3.0).
    ///
    /// # Errors
    /// If the FMU fails.
    fn get_binaries(&mut self, group: &VariableGroup) -> Result<Vec<Vec<u8>>, InstanceError>;

    /// Makes one communication step. Model exchange is integrated over it, with its events; clocks
    /// of co-simulation that are due tick during it and at its end.
    ///
    /// # Errors
    /// If the FMU fails.
    fn step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError>;

    /// Sets, steps and gets in one call: for another process, in one round trip. `set` and `get`
    /// are groups whose numbers follow one another in `inputs` and `outputs`.
    ///
    /// At an early return the FMU's events are handled and it continues, so that the outcome is
    /// [`StepOutcome::Done`], [`StepOutcome::Discarded`], or an early end because the FMU requests it.
    ///
    /// # Errors
    /// If the FMU fails.
    fn exchange(
        &mut self,
        set: &[VariableGroup],
        inputs: &[f64],
        time_s: f64,
        step_s: f64,
        get: &[VariableGroup],
        outputs: &mut [f64],
    ) -> Result<Stepped, InstanceError> {
        for (groups, count) in [(set, inputs.len()), (get, outputs.len())] {
            if groups.iter().map(|group| group.elements).sum::<usize>() != count {
                return Err(group::unfitting(self.name(), groups, count));
            }
        }
        let mut rest = inputs;
        for (place, group) in set.iter().enumerate() {
            let (these, others) = rest.split_at(group.elements);
            self.set_in_exchange(place, group, these)?;
            rest = others;
        }
        let stepped = self.advance(time_s, step_s)?;
        let mut rest = outputs;
        for group in get {
            let (these, others) = rest.split_at_mut(group.elements);
            self.get(group, these)?;
            rest = others;
        }
        Ok(stepped)
    }

    /// Makes [`Self::step`] to the end of the step, through early returns and their events.
    ///
    /// # Errors
    /// If the FMU fails, or its early returns don't come to an end.
    fn advance(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        let end_s = time_s + step_s;
        let mut stepped = self.step(time_s, step_s)?;
        for _ in 0..REPEATS_MAX {
            if stepped.event {
                stepped.terminate |= self.handle_events()?;
                stepped.event = false;
            }
            if stepped.outcome != StepOutcome::Early || stepped.terminate {
                return Ok(stepped);
            }
            // The rest may be rounding alone: then the end is reached.
            let left_s = end_s - stepped.time_s;
            if left_s <= 1e-9 * step_s {
                return Ok(Stepped { time_s: end_s, outcome: StepOutcome::Done, ..stepped });
            }
            stepped = self.step(stepped.time_s, left_s)?;
        }
        Err(InstanceError::Endless {
            fmu: self.name().into(),
            what: format!("{REPEATS_MAX} early returns within one step at {} s", stepped.time_s),
        })
    }

    /// Handles events until there are none; returns true if the FMU requests the end of the
    /// simulation.
    ///
    /// # Errors
    /// If the FMU fails, or its events don't come to an end.
    fn handle_events(&mut self) -> Result<bool, InstanceError>;

    /// Enters event mode, for a caller that handles events together with those of other FMUs.
    ///
    /// # Errors
    /// If the FMU fails or offers no event mode to the importer.
    fn enter_event_mode(&mut self) -> Result<(), InstanceError>;

    /// Makes one update of the discrete states, in event mode.
    ///
    /// # Errors
    /// If the FMU fails or isn't in event mode.
    fn update_discrete_states(&mut self) -> Result<Update, InstanceError>;

    /// Leaves event mode.
    ///
    /// # Errors
    /// If the FMU fails or isn't in event mode.
    fn leave_event_mode(&mut self) -> Result<(), InstanceError>;

    /// Activates the model partition of an input clock (scheduled execution), and returns what the
    /// FMU said about other clocks meanwhile. Times of one clock increase.
    ///
    /// # Errors
    /// If the FMU fails, or isn't run by scheduled execution.
    fn activate_partition(
        &mut self,
        _clock: u32,
        _time_s: f64,
    ) -> Result<ClockNews, InstanceError> {
        Err(InstanceError::unsupported(self.name(), "activate a model partition", NOT_SCHEDULED))
    }

    /// Returns the interval of an input clock, s (scheduled execution); `None`: the FMU doesn't know
    /// it yet.
    ///
    /// # Errors
    /// As [`Self::activate_partition`].
    fn partition_interval_s(&mut self, _clock: u32) -> Result<Option<f64>, InstanceError> {
        Err(InstanceError::unsupported(self.name(), "tell a clock's interval", NOT_SCHEDULED))
    }

    /// Stores the state of the FMU and returns its number.
    ///
    /// # Errors
    /// If the FMU can't store states.
    fn keep_state(&mut self) -> Result<u64, InstanceError>;

    /// Returns to a stored state.
    ///
    /// # Errors
    /// If the FMU can't, or the state doesn't belong to it.
    fn restore_state(&mut self, state: u64) -> Result<(), InstanceError>;

    /// Frees a stored state.
    ///
    /// # Errors
    /// If the state doesn't belong to the FMU.
    fn forget_state(&mut self, state: u64) -> Result<(), InstanceError>;

    /// Converts a stored state to bytes.
    ///
    /// # Errors
    /// If the FMU can't.
    fn state_to_bytes(&mut self, state: u64) -> Result<Vec<u8>, InstanceError>;

    /// Stores a state given as bytes.
    ///
    /// # Errors
    /// If the FMU can't, or the bytes don't belong to it.
    fn state_from_bytes(&mut self, bytes: &[u8]) -> Result<u64, InstanceError>;

    /// Returns to the state after instantiation.
    ///
    /// # Errors
    /// If the FMU fails.
    fn reset(&mut self) -> Result<(), InstanceError>;

    /// Ends the simulation.
    ///
    /// # Errors
    /// If the FMU fails.
    fn terminate(&mut self) -> Result<(), InstanceError>;

    /// Frees the FMU and unloads its library. An FMU in a process of its own is freed here, and its
    /// process ends; one in this process is freed when it is dropped. Nothing else may be called
    /// after it.
    ///
    /// # Errors
    /// If the FMU crashes or hangs on the way, or ends its process.
    fn finish(&mut self) -> Result<(), InstanceError> {
        Ok(())
    }

    /// Messages that the FMU logged since the last call.
    fn messages(&mut self) -> Vec<FmuMessage>;
}

/// Last message of an FMU, after a colon; empty where it sent none.
pub fn said(instance: &mut dyn Instance) -> String {
    let messages = instance.messages();
    messages.last().map_or(String::new(), |message| format!(": {}", message.text.trim()))
}
