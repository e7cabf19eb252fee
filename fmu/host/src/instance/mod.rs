//! An FMU that runs, of both standards and both kinds, behind one trait.
//!
//! | module | idea |
//! |---|---|
//! | [`group`] | variables that are set or got together, and where their numbers lie |
//! | [`options`] | how an FMU is opened |
//! | [`open`] | opening it: its archive, its description, its library, an instance |
//! | `setup` | what an instance is told when it is made |
//! | [`error`] | why an FMU could not go on |
//! | `message` | what an FMU logs |
//! | `call` | one call of a function: its name, its status, what it means |
//! | `number` | f64 and the number types of FMI, checked |
//! | `unit` | what the functions of both standards do, in one form |
//! | `fmi2`, `fmi3` | the functions of each standard |
//! | `states` | kept states, and states as bytes |
//! | `clocks` | when clocks tick in time |
//! | `co_simulation` | co-simulation in the order that the standards ask for |

pub(super) mod call;
mod clocks;
pub(super) mod co_simulation;
pub mod error;
pub(super) mod fmi2;
pub(super) mod fmi3;
pub mod group;
mod held;
mod message;
mod number;
pub mod open;
pub mod options;
pub(super) mod setup;
pub(super) mod states;
pub(super) mod unit;

pub use error::InstanceError;
pub use group::{Access, Group, Plan};
pub use message::Message;
pub use open::OpenError;
pub use options::{InterfaceKind, Options, Place};

use super::description::Description;
use serde::{Deserialize, Serialize};

/// How a step ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stepped {
    /// The time that was reached, s: the end of the step, or earlier.
    pub time_s: f64,
    /// What happened.
    pub outcome: Outcome,
    /// Events wait to be handled: [`Instance::handle_events`].
    pub event: bool,
    /// The FMU wants the simulation to end.
    pub terminate: bool,
}

/// What became of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// It was done.
    Done,
    /// The FMU returned before its end, at an event.
    Early,
    /// The FMU refused it, or could do only a part: another step may be tried from a kept state.
    Discarded,
}

/// What an update of the discrete states answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Update {
    /// Another update is needed.
    pub again: bool,
    /// The FMU wants the simulation to end.
    pub terminate: bool,
    /// Nominals of the continuous states have changed.
    pub nominals_changed: bool,
    /// Continuous states have changed.
    pub states_changed: bool,
    /// The next time event, s, where there is one.
    pub next_event_time_s: Option<f64>,
}

/// Early returns within one exchange, and updates of the discrete states at one event, before it
/// is said that there is no end to them.
pub const REPEATS_MAX: usize = 1000;

/// What is done with one FMU, in this process or in another.
pub trait Instance: Send {
    /// Its name in errors: the file's, or the model's.
    fn name(&self) -> &str;

    /// What it says of itself.
    fn description(&self) -> &Description;

    /// Start of the initialization. Variables are set before and within it.
    ///
    /// # Errors
    /// If the FMU fails; so for all that follow.
    fn enter_initialization(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), InstanceError>;

    /// End of the initialization, and of the first events; true if the FMU wants the simulation to
    /// end at once.
    ///
    /// # Errors
    /// If the FMU fails.
    fn exit_initialization(&mut self) -> Result<bool, InstanceError>;

    /// Sets numbers. What may be set at events alone ([`Access::Event`]) is set at one, which lasts
    /// until the next step.
    ///
    /// # Errors
    /// If the FMU fails or refuses a value, or a number doesn't fit the type.
    fn set(&mut self, group: &Group, values: &[f64]) -> Result<(), InstanceError>;

    /// [`Self::set`] of the group that stands at `place` in an [`Self::exchange`]: who knows what the FMU
    /// has already can leave out what changes nothing.
    ///
    /// # Errors
    /// As [`Self::set`].
    fn set_in_exchange(
        &mut self,
        _place: usize,
        group: &Group,
        values: &[f64],
    ) -> Result<(), InstanceError> {
        self.set(group, values)
    }

    /// Gets numbers.
    ///
    /// # Errors
    /// If the FMU fails.
    fn get(&mut self, group: &Group, values: &mut [f64]) -> Result<(), InstanceError>;

    /// Sets texts.
    ///
    /// # Errors
    /// If the FMU fails or refuses a value.
    fn set_strings(&mut self, group: &Group, values: &[String]) -> Result<(), InstanceError>;

    /// Gets texts.
    ///
    /// # Errors
    /// If the FMU fails.
    fn get_strings(&mut self, group: &Group) -> Result<Vec<String>, InstanceError>;

    /// Sets bytes (FMI 3.0).
    ///
    /// # Errors
    /// If the FMU fails or refuses a value.
    fn set_binaries(&mut self, group: &Group, values: &[Vec<u8>]) -> Result<(), InstanceError>;

    /// Gets bytes (FMI 3.0).
    ///
    /// # Errors
    /// If the FMU fails.
    fn get_binaries(&mut self, group: &Group) -> Result<Vec<Vec<u8>>, InstanceError>;

    /// One communication step. Model exchange is integrated over it, with its events; clocks of
    /// co-simulation that are due tick on the way and at its end.
    ///
    /// # Errors
    /// If the FMU fails.
    fn step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError>;

    /// Sets, steps and gets in one go: in another process, one way there and back. `set` and `get`
    /// are groups with the place of their numbers in `inputs` and `outputs`, one after another.
    ///
    /// Where the FMU returns early its events are handled and it goes on, so that the answer is
    /// [`Outcome::Done`], [`Outcome::Discarded`], or an early end because it wants to terminate.
    ///
    /// # Errors
    /// If the FMU fails.
    fn exchange(
        &mut self,
        set: &[Group],
        inputs: &[f64],
        time_s: f64,
        step_s: f64,
        get: &[Group],
        outputs: &mut [f64],
    ) -> Result<Stepped, InstanceError> {
        for (groups, count) in [(set, inputs.len()), (get, outputs.len())] {
            if groups.iter().map(|group| group.elements).sum::<usize>() != count {
                return Err(InstanceError::numbers(self.name(), groups, count));
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

    /// [`Self::step`] to the end of the step, over early returns and their events.
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
            if stepped.outcome != Outcome::Early || stepped.terminate {
                return Ok(stepped);
            }
            // What is left may be rounding alone: then the end is reached.
            let left_s = end_s - stepped.time_s;
            if left_s <= 1e-9 * step_s {
                return Ok(Stepped { time_s: end_s, outcome: Outcome::Done, ..stepped });
            }
            stepped = self.step(stepped.time_s, left_s)?;
        }
        Err(InstanceError::Endless {
            fmu: self.name().into(),
            what: format!("{REPEATS_MAX} early returns within one step at {} s", stepped.time_s),
        })
    }

    /// Handles events until there are none; true if the FMU wants the simulation to end.
    ///
    /// # Errors
    /// If the FMU fails, or its events don't come to an end.
    fn handle_events(&mut self) -> Result<bool, InstanceError>;

    /// Enters event mode, for who handles events together with those of other FMUs.
    ///
    /// # Errors
    /// If the FMU fails or has no event mode that is open to the outside.
    fn enter_event_mode(&mut self) -> Result<(), InstanceError>;

    /// One update of the discrete states, in event mode.
    ///
    /// # Errors
    /// If the FMU fails or isn't in event mode.
    fn update_discrete_states(&mut self) -> Result<Update, InstanceError>;

    /// Leaves event mode.
    ///
    /// # Errors
    /// If the FMU fails or isn't in event mode.
    fn leave_event_mode(&mut self) -> Result<(), InstanceError>;

    /// Keeps the state of the FMU; the number names it.
    ///
    /// # Errors
    /// If the FMU can't.
    fn keep_state(&mut self) -> Result<u64, InstanceError>;

    /// Back to a kept state.
    ///
    /// # Errors
    /// If the FMU can't, or the state isn't one of its.
    fn restore_state(&mut self, state: u64) -> Result<(), InstanceError>;

    /// Forgets a kept state.
    ///
    /// # Errors
    /// If the state isn't one of its.
    fn forget_state(&mut self, state: u64) -> Result<(), InstanceError>;

    /// A kept state as bytes.
    ///
    /// # Errors
    /// If the FMU can't.
    fn state_to_bytes(&mut self, state: u64) -> Result<Vec<u8>, InstanceError>;

    /// A kept state from bytes.
    ///
    /// # Errors
    /// If the FMU can't, or the bytes are none of its.
    fn state_from_bytes(&mut self, bytes: &[u8]) -> Result<u64, InstanceError>;

    /// Back to where it was after instantiation.
    ///
    /// # Errors
    /// If the FMU fails.
    fn reset(&mut self) -> Result<(), InstanceError>;

    /// End of the simulation.
    ///
    /// # Errors
    /// If the FMU fails.
    fn terminate(&mut self) -> Result<(), InstanceError>;

    /// What the FMU logged since the last call.
    fn messages(&mut self) -> Vec<Message>;
}
