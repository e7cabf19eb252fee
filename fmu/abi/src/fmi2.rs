//! FMI 2.0: model exchange and co-simulation.

pub use super::{DISCARD, ERROR, FATAL, OK, Status, String, ValueReference, WARNING};
use core::ffi::{c_char, c_void};

/// `fmi2Component`: the instance.
pub type Component = *mut c_void;
/// `fmi2ComponentEnvironment`.
pub type Environment = *mut c_void;
/// `fmi2FMUstate`.
pub type State = *mut c_void;
/// `fmi2Boolean`.
pub type Boolean = i32;
/// `fmi2Byte`.
pub type Byte = c_char;

/// `fmi2True`.
pub const TRUE: Boolean = 1;
/// `fmi2False`.
pub const FALSE: Boolean = 0;

/// `fmi2Pending`.
pub const PENDING: Status = 5;

/// `fmi2Type`: model exchange.
pub const MODEL_EXCHANGE: i32 = 0;
/// `fmi2Type`: co-simulation.
pub const CO_SIMULATION: i32 = 1;

/// `fmi2StatusKind`: status of an asynchronous step.
pub const DO_STEP_STATUS: i32 = 0;
/// `fmi2StatusKind`: reason why a step is pending.
pub const PENDING_STATUS: i32 = 1;
/// `fmi2StatusKind`: end of the last successful step.
pub const LAST_SUCCESSFUL_TIME: i32 = 2;
/// `fmi2StatusKind`: whether the slave wants to terminate.
pub const TERMINATED: i32 = 3;

/// `fmi2CallbackLogger`: environment, instance name, status, category, message in `printf` form.
pub type Logger = unsafe extern "C" fn(Environment, String, Status, String, String, ...);
/// `fmi2CallbackAllocateMemory`.
pub type AllocateMemory = unsafe extern "C" fn(usize, usize) -> *mut c_void;
/// `fmi2CallbackFreeMemory`.
pub type FreeMemory = unsafe extern "C" fn(*mut c_void);
/// `fmi2StepFinished`.
pub type StepFinished = unsafe extern "C" fn(Environment, Status);

/// `fmi2CallbackFunctions`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CallbackFunctions {
    /// Messages.
    pub logger: Option<Logger>,
    /// Memory of the importer.
    pub allocate_memory: Option<AllocateMemory>,
    /// Release of such memory.
    pub free_memory: Option<FreeMemory>,
    /// End of an asynchronous step.
    pub step_finished: Option<StepFinished>,
    /// Passed back to the logger.
    pub environment: Environment,
}

/// `fmi2EventInfo`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct EventInfo {
    /// Another iteration is needed.
    pub new_discrete_states_needed: Boolean,
    /// The simulation is to end.
    pub terminate_simulation: Boolean,
    /// Nominals have changed.
    pub nominals_of_continuous_states_changed: Boolean,
    /// States have changed.
    pub values_of_continuous_states_changed: Boolean,
    /// True if `next_event_time` is defined.
    pub next_event_time_defined: Boolean,
    /// The next time event, s.
    pub next_event_time: f64,
}

functions! {
    fmi2GetTypesPlatform() -> String;
    fmi2GetVersion() -> String;
    fmi2SetDebugLogging(c: Component, on: Boolean, count: usize, categories: *const String) -> Status;
    fmi2Instantiate(name: String, kind: i32, guid: String, resources: String, functions: *const CallbackFunctions, visible: Boolean, logging: Boolean) -> Component;
    fmi2FreeInstance(c: Component);
    fmi2SetupExperiment(c: Component, tolerance_defined: Boolean, tolerance: f64, start: f64, stop_defined: Boolean, stop: f64) -> Status;
    fmi2EnterInitializationMode(c: Component) -> Status;
    fmi2ExitInitializationMode(c: Component) -> Status;
    fmi2Terminate(c: Component) -> Status;
    fmi2Reset(c: Component) -> Status;
    fmi2GetReal(c: Component, references: *const ValueReference, count: usize, values: *mut f64) -> Status;
    fmi2GetInteger(c: Component, references: *const ValueReference, count: usize, values: *mut i32) -> Status;
    fmi2GetBoolean(c: Component, references: *const ValueReference, count: usize, values: *mut Boolean) -> Status;
    fmi2GetString(c: Component, references: *const ValueReference, count: usize, values: *mut String) -> Status;
    fmi2SetReal(c: Component, references: *const ValueReference, count: usize, values: *const f64) -> Status;
    fmi2SetInteger(c: Component, references: *const ValueReference, count: usize, values: *const i32) -> Status;
    fmi2SetBoolean(c: Component, references: *const ValueReference, count: usize, values: *const Boolean) -> Status;
    fmi2SetString(c: Component, references: *const ValueReference, count: usize, values: *const String) -> Status;
    fmi2GetFMUstate(c: Component, state: *mut State) -> Status;
    fmi2SetFMUstate(c: Component, state: State) -> Status;
    fmi2FreeFMUstate(c: Component, state: *mut State) -> Status;
    fmi2SerializedFMUstateSize(c: Component, state: State, size: *mut usize) -> Status;
    fmi2SerializeFMUstate(c: Component, state: State, bytes: *mut Byte, size: usize) -> Status;
    fmi2DeSerializeFMUstate(c: Component, bytes: *const Byte, size: usize, state: *mut State) -> Status;
    fmi2GetDirectionalDerivative(c: Component, unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize, seed: *const f64, sensitivity: *mut f64) -> Status;
    fmi2EnterEventMode(c: Component) -> Status;
    fmi2NewDiscreteStates(c: Component, info: *mut EventInfo) -> Status;
    fmi2EnterContinuousTimeMode(c: Component) -> Status;
    fmi2CompletedIntegratorStep(c: Component, no_set_prior: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean) -> Status;
    fmi2SetTime(c: Component, time: f64) -> Status;
    fmi2SetContinuousStates(c: Component, states: *const f64, count: usize) -> Status;
    fmi2GetDerivatives(c: Component, derivatives: *mut f64, count: usize) -> Status;
    fmi2GetEventIndicators(c: Component, indicators: *mut f64, count: usize) -> Status;
    fmi2GetContinuousStates(c: Component, states: *mut f64, count: usize) -> Status;
    fmi2GetNominalsOfContinuousStates(c: Component, nominals: *mut f64, count: usize) -> Status;
    fmi2SetRealInputDerivatives(c: Component, references: *const ValueReference, count: usize, orders: *const i32, values: *const f64) -> Status;
    fmi2GetRealOutputDerivatives(c: Component, references: *const ValueReference, count: usize, orders: *const i32, values: *mut f64) -> Status;
    fmi2DoStep(c: Component, time: f64, step: f64, no_set_prior: Boolean) -> Status;
    fmi2CancelStep(c: Component) -> Status;
    fmi2GetStatus(c: Component, kind: i32, value: *mut Status) -> Status;
    fmi2GetRealStatus(c: Component, kind: i32, value: *mut f64) -> Status;
    fmi2GetIntegerStatus(c: Component, kind: i32, value: *mut i32) -> Status;
    fmi2GetBooleanStatus(c: Component, kind: i32, value: *mut Boolean) -> Status;
    fmi2GetStringStatus(c: Component, kind: i32, value: *mut String) -> Status;
}
