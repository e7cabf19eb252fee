//! An FMU that runs, of both standards and both kinds, behind one trait.

use super::description::{Description, Kind};

/// Variables of one type that are set or got together.
///
/// Numbers of every type, Booleans and enumerations travel as f64 (whole numbers exact up to 2⁵³);
/// text and bytes by functions of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Their type.
    pub kind: Kind,
    /// Their value references.
    pub references: Vec<u32>,
    /// Number of elements of all of them together.
    pub elements: usize,
}

/// How a step ended.
#[derive(Clone, Copy, Debug, PartialEq)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It was done.
    Done,
    /// The FMU returned before its end, at an event.
    Early,
    /// The FMU refused it, or could do only a part: another step may be tried from a kept state.
    Discarded,
}

/// What is done with one FMU, in this process or in another.
pub trait Instance: Send {
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

    /// End of the initialization, and of the first events.
    ///
    /// # Errors
    /// If the FMU fails.
    fn exit_initialization(&mut self) -> Result<(), InstanceError>;

    /// Sets numbers.
    ///
    /// # Errors
    /// If the FMU fails or refuses a value, or a number doesn't fit the type.
    fn set(&mut self, group: &Group, values: &[f64]) -> Result<(), InstanceError>;

    /// Gets numbers.
    ///
    /// # Errors
    /// If the FMU fails.
    fn get(&mut self, group: &Group, values: &mut [f64]) -> Result<(), InstanceError>;

    /// Sets texts.
    ///
    /// # Errors
    /// If the FMU fails or refuses a value.
    fn set_strings(&mut self, references: &[u32], values: &[String]) -> Result<(), InstanceError>;

    /// Gets texts of scalars.
    ///
    /// # Errors
    /// If the FMU fails.
    fn get_strings(&mut self, references: &[u32]) -> Result<Vec<String>, InstanceError>;

    /// Sets bytes (FMI 3.0).
    ///
    /// # Errors
    /// If the FMU fails or refuses a value.
    fn set_binaries(&mut self, references: &[u32], values: &[Vec<u8>])
    -> Result<(), InstanceError>;

    /// Gets bytes of scalars (FMI 3.0).
    ///
    /// # Errors
    /// If the FMU fails.
    fn get_binaries(&mut self, references: &[u32]) -> Result<Vec<Vec<u8>>, InstanceError>;

    /// One communication step. Model exchange is integrated over it, with its events.
    ///
    /// # Errors
    /// If the FMU fails.
    fn step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError>;

    /// Sets, steps and gets in one go: in another process, one way there and back. `set` and `get`
    /// are groups with the place of their numbers in `inputs` and `outputs`, one after another.
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
        let mut rest = inputs;
        for group in set {
            let (these, others) = rest.split_at(group.elements);
            self.set(group, these)?;
            rest = others;
        }
        let mut stepped = self.step(time_s, step_s)?;
        if stepped.event {
            stepped.terminate |= self.handle_events()?;
        }
        let mut rest = outputs;
        for group in get {
            let (these, others) = rest.split_at_mut(group.elements);
            self.get(group, these)?;
            rest = others;
        }
        Ok(stepped)
    }

    /// Handles events until there are none; true if the FMU wants the simulation to end.
    ///
    /// # Errors
    /// If the FMU fails, or its events don't come to an end.
    fn handle_events(&mut self) -> Result<bool, InstanceError>;

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

    /// What the FMU logged since the last call: its words, with category and status.
    fn messages(&mut self) -> Vec<String>;
}

/// Why an FMU could not go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InstanceError {
    /// A function answered that it failed.
    #[error("{function} of {fmu} answered {status}{said}")]
    Failed {
        /// Name of the FMU's file.
        fmu: String,
        /// The function.
        function: String,
        /// `error`, `fatal`, `discard`.
        status: String,
        /// What the FMU logged, after a colon; else empty.
        said: String,
    },
    /// The FMU hasn't what is asked for.
    #[error("{fmu} can't {what}: {reason}")]
    Unsupported {
        /// Name of the FMU's file.
        fmu: String,
        /// What is asked for.
        what: String,
        /// Why it can't.
        reason: String,
    },
    /// A value doesn't fit the variable's type.
    #[error("{fmu}: {value} doesn't fit the type of {variable}, {kind}")]
    Value {
        /// Name of the FMU's file.
        fmu: String,
        /// The variable.
        variable: String,
        /// The value.
        value: f64,
        /// Its type.
        kind: String,
    },
    /// The process of the FMU is gone or hangs.
    #[error("the process of {fmu} {what}")]
    Process {
        /// Name of the FMU's file.
        fmu: String,
        /// `was ended by SIGSEGV in fmi2DoStep`, `gave no answer to … for 10 s`.
        what: String,
    },
}
