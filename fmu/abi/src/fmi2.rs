//! FMI 2.0: model exchange and co-simulation.

use core::ffi::{c_char, c_void};

/// `fmi2Component`: the instance.
pub type Component = *mut c_void;
/// `fmi2ComponentEnvironment`.
pub type Environment = *mut c_void;
/// `fmi2FMUstate`.
pub type State = *mut c_void;
/// `fmi2ValueReference`.
pub type ValueReference = u32;
/// `fmi2Boolean`.
pub type Boolean = i32;
/// `fmi2String`.
pub type String = *const c_char;
/// `fmi2Byte`.
pub type Byte = c_char;

/// `fmi2True`.
pub const TRUE: Boolean = 1;
/// `fmi2False`.
pub const FALSE: Boolean = 0;

/// `fmi2Status`.
pub type Status = i32;
/// `fmi2OK`.
pub const OK: Status = 0;
/// `fmi2Warning`.
pub const WARNING: Status = 1;
/// `fmi2Discard`.
pub const DISCARD: Status = 2;
/// `fmi2Error`.
pub const ERROR: Status = 3;
/// `fmi2Fatal`.
pub const FATAL: Status = 4;
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

super::functions! {
    get_types_platform "fmi2GetTypesPlatform": GetTypesPlatform() -> String;
    get_version "fmi2GetVersion": GetVersion() -> String;
    set_debug_logging "fmi2SetDebugLogging": SetDebugLogging(c: Component, on: Boolean, count: usize, categories: *const String) -> Status;
    instantiate "fmi2Instantiate": Instantiate(name: String, kind: i32, guid: String, resources: String, functions: *const CallbackFunctions, visible: Boolean, logging: Boolean) -> Component;
    free_instance "fmi2FreeInstance": FreeInstance(c: Component);
    setup_experiment "fmi2SetupExperiment": SetupExperiment(c: Component, tolerance_defined: Boolean, tolerance: f64, start: f64, stop_defined: Boolean, stop: f64) -> Status;
    enter_initialization_mode "fmi2EnterInitializationMode": EnterInitializationMode(c: Component) -> Status;
    exit_initialization_mode "fmi2ExitInitializationMode": ExitInitializationMode(c: Component) -> Status;
    terminate "fmi2Terminate": Terminate(c: Component) -> Status;
    reset "fmi2Reset": Reset(c: Component) -> Status;
    get_real "fmi2GetReal": GetReal(c: Component, references: *const ValueReference, count: usize, values: *mut f64) -> Status;
    get_integer "fmi2GetInteger": GetInteger(c: Component, references: *const ValueReference, count: usize, values: *mut i32) -> Status;
    get_boolean "fmi2GetBoolean": GetBoolean(c: Component, references: *const ValueReference, count: usize, values: *mut Boolean) -> Status;
    get_string "fmi2GetString": GetString(c: Component, references: *const ValueReference, count: usize, values: *mut String) -> Status;
    set_real "fmi2SetReal": SetReal(c: Component, references: *const ValueReference, count: usize, values: *const f64) -> Status;
    set_integer "fmi2SetInteger": SetInteger(c: Component, references: *const ValueReference, count: usize, values: *const i32) -> Status;
    set_boolean "fmi2SetBoolean": SetBoolean(c: Component, references: *const ValueReference, count: usize, values: *const Boolean) -> Status;
    set_string "fmi2SetString": SetString(c: Component, references: *const ValueReference, count: usize, values: *const String) -> Status;
    get_fmu_state "fmi2GetFMUstate": GetFmuState(c: Component, state: *mut State) -> Status;
    set_fmu_state "fmi2SetFMUstate": SetFmuState(c: Component, state: State) -> Status;
    free_fmu_state "fmi2FreeFMUstate": FreeFmuState(c: Component, state: *mut State) -> Status;
    serialized_fmu_state_size "fmi2SerializedFMUstateSize": SerializedFmuStateSize(c: Component, state: State, size: *mut usize) -> Status;
    serialize_fmu_state "fmi2SerializeFMUstate": SerializeFmuState(c: Component, state: State, bytes: *mut Byte, size: usize) -> Status;
    deserialize_fmu_state "fmi2DeSerializeFMUstate": DeserializeFmuState(c: Component, bytes: *const Byte, size: usize, state: *mut State) -> Status;
    get_directional_derivative "fmi2GetDirectionalDerivative": GetDirectionalDerivative(c: Component, unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize, seed: *const f64, sensitivity: *mut f64) -> Status;
    enter_event_mode "fmi2EnterEventMode": EnterEventMode(c: Component) -> Status;
    new_discrete_states "fmi2NewDiscreteStates": NewDiscreteStates(c: Component, info: *mut EventInfo) -> Status;
    enter_continuous_time_mode "fmi2EnterContinuousTimeMode": EnterContinuousTimeMode(c: Component) -> Status;
    completed_integrator_step "fmi2CompletedIntegratorStep": CompletedIntegratorStep(c: Component, no_set_prior: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean) -> Status;
    set_time "fmi2SetTime": SetTime(c: Component, time: f64) -> Status;
    set_continuous_states "fmi2SetContinuousStates": SetContinuousStates(c: Component, states: *const f64, count: usize) -> Status;
    get_derivatives "fmi2GetDerivatives": GetDerivatives(c: Component, derivatives: *mut f64, count: usize) -> Status;
    get_event_indicators "fmi2GetEventIndicators": GetEventIndicators(c: Component, indicators: *mut f64, count: usize) -> Status;
    get_continuous_states "fmi2GetContinuousStates": GetContinuousStates(c: Component, states: *mut f64, count: usize) -> Status;
    get_nominals_of_continuous_states "fmi2GetNominalsOfContinuousStates": GetNominalsOfContinuousStates(c: Component, nominals: *mut f64, count: usize) -> Status;
    set_real_input_derivatives "fmi2SetRealInputDerivatives": SetRealInputDerivatives(c: Component, references: *const ValueReference, count: usize, orders: *const i32, values: *const f64) -> Status;
    get_real_output_derivatives "fmi2GetRealOutputDerivatives": GetRealOutputDerivatives(c: Component, references: *const ValueReference, count: usize, orders: *const i32, values: *mut f64) -> Status;
    do_step "fmi2DoStep": DoStep(c: Component, time: f64, step: f64, no_set_prior: Boolean) -> Status;
    cancel_step "fmi2CancelStep": CancelStep(c: Component) -> Status;
    get_status "fmi2GetStatus": GetStatus(c: Component, kind: i32, value: *mut Status) -> Status;
    get_real_status "fmi2GetRealStatus": GetRealStatus(c: Component, kind: i32, value: *mut f64) -> Status;
    get_integer_status "fmi2GetIntegerStatus": GetIntegerStatus(c: Component, kind: i32, value: *mut i32) -> Status;
    get_boolean_status "fmi2GetBooleanStatus": GetBooleanStatus(c: Component, kind: i32, value: *mut Boolean) -> Status;
    get_string_status "fmi2GetStringStatus": GetStringStatus(c: Component, kind: i32, value: *mut String) -> Status;
}
