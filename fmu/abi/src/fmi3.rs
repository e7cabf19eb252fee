//! FMI 3.0: model exchange, co-simulation and scheduled execution.

use core::ffi::{c_char, c_void};

/// `fmi3Instance`.
pub type Instance = *mut c_void;
/// `fmi3InstanceEnvironment`.
pub type Environment = *mut c_void;
/// `fmi3FMUState`.
pub type State = *mut c_void;
/// `fmi3ValueReference`.
pub type ValueReference = u32;
/// `fmi3Boolean` (and `fmi3Clock`): C's `bool`; see the note of the crate.
pub type Boolean = u8;
/// `fmi3String`.
pub type String = *const c_char;
/// `fmi3Binary`.
pub type Binary = *const u8;

/// `fmi3Status`.
pub type Status = i32;
/// `fmi3OK`.
pub const OK: Status = 0;
/// `fmi3Warning`.
pub const WARNING: Status = 1;
/// `fmi3Discard`.
pub const DISCARD: Status = 2;
/// `fmi3Error`.
pub const ERROR: Status = 3;
/// `fmi3Fatal`.
pub const FATAL: Status = 4;

/// `fmi3DependencyKind`: independent, constant, fixed, tunable, discrete, dependent are 0 to 5.
pub type DependencyKind = i32;
/// `fmi3IntervalQualifier`: not yet known.
pub const INTERVAL_NOT_YET_KNOWN: i32 = 0;
/// `fmi3IntervalQualifier`: unchanged.
pub const INTERVAL_UNCHANGED: i32 = 1;
/// `fmi3IntervalQualifier`: changed.
pub const INTERVAL_CHANGED: i32 = 2;

/// `fmi3LogMessageCallback`: environment, status, category, message.
pub type LogMessage = unsafe extern "C" fn(Environment, Status, String, String);
/// `fmi3IntermediateUpdateCallback`: environment, time, set requested, get allowed, step finished,
/// can return early, early return requested (out), early return time (out).
pub type IntermediateUpdate = unsafe extern "C" fn(
    Environment,
    f64,
    Boolean,
    Boolean,
    Boolean,
    Boolean,
    *mut Boolean,
    *mut f64,
);
/// `fmi3ClockUpdateCallback`.
pub type ClockUpdate = unsafe extern "C" fn(Environment);
/// `fmi3LockPreemptionCallback` and `fmi3UnlockPreemptionCallback`.
pub type Preemption = unsafe extern "C" fn();

super::functions! {
    get_version "fmi3GetVersion": GetVersion() -> String;
    set_debug_logging "fmi3SetDebugLogging": SetDebugLogging(i: Instance, on: Boolean, count: usize, categories: *const String) -> Status;
    instantiate_model_exchange "fmi3InstantiateModelExchange": InstantiateModelExchange(name: String, token: String, resources: String, visible: Boolean, logging: Boolean, environment: Environment, log: Option<LogMessage>) -> Instance;
    instantiate_co_simulation "fmi3InstantiateCoSimulation": InstantiateCoSimulation(name: String, token: String, resources: String, visible: Boolean, logging: Boolean, event_mode_used: Boolean, early_return_allowed: Boolean, required: *const ValueReference, required_count: usize, environment: Environment, log: Option<LogMessage>, intermediate_update: Option<IntermediateUpdate>) -> Instance;
    instantiate_scheduled_execution "fmi3InstantiateScheduledExecution": InstantiateScheduledExecution(name: String, token: String, resources: String, visible: Boolean, logging: Boolean, environment: Environment, log: Option<LogMessage>, clock_update: Option<ClockUpdate>, lock: Option<Preemption>, unlock: Option<Preemption>) -> Instance;
    free_instance "fmi3FreeInstance": FreeInstance(i: Instance);
    enter_initialization_mode "fmi3EnterInitializationMode": EnterInitializationMode(i: Instance, tolerance_defined: Boolean, tolerance: f64, start: f64, stop_defined: Boolean, stop: f64) -> Status;
    exit_initialization_mode "fmi3ExitInitializationMode": ExitInitializationMode(i: Instance) -> Status;
    enter_event_mode "fmi3EnterEventMode": EnterEventMode(i: Instance) -> Status;
    terminate "fmi3Terminate": Terminate(i: Instance) -> Status;
    reset "fmi3Reset": Reset(i: Instance) -> Status;
    get_float32 "fmi3GetFloat32": GetFloat32(i: Instance, references: *const ValueReference, count: usize, values: *mut f32, value_count: usize) -> Status;
    set_float32 "fmi3SetFloat32": SetFloat32(i: Instance, references: *const ValueReference, count: usize, values: *const f32, value_count: usize) -> Status;
    get_float64 "fmi3GetFloat64": GetFloat64(i: Instance, references: *const ValueReference, count: usize, values: *mut f64, value_count: usize) -> Status;
    set_float64 "fmi3SetFloat64": SetFloat64(i: Instance, references: *const ValueReference, count: usize, values: *const f64, value_count: usize) -> Status;
    get_int8 "fmi3GetInt8": GetInt8(i: Instance, references: *const ValueReference, count: usize, values: *mut i8, value_count: usize) -> Status;
    set_int8 "fmi3SetInt8": SetInt8(i: Instance, references: *const ValueReference, count: usize, values: *const i8, value_count: usize) -> Status;
    get_uint8 "fmi3GetUInt8": GetUint8(i: Instance, references: *const ValueReference, count: usize, values: *mut u8, value_count: usize) -> Status;
    set_uint8 "fmi3SetUInt8": SetUint8(i: Instance, references: *const ValueReference, count: usize, values: *const u8, value_count: usize) -> Status;
    get_int16 "fmi3GetInt16": GetInt16(i: Instance, references: *const ValueReference, count: usize, values: *mut i16, value_count: usize) -> Status;
    set_int16 "fmi3SetInt16": SetInt16(i: Instance, references: *const ValueReference, count: usize, values: *const i16, value_count: usize) -> Status;
    get_uint16 "fmi3GetUInt16": GetUint16(i: Instance, references: *const ValueReference, count: usize, values: *mut u16, value_count: usize) -> Status;
    set_uint16 "fmi3SetUInt16": SetUint16(i: Instance, references: *const ValueReference, count: usize, values: *const u16, value_count: usize) -> Status;
    get_int32 "fmi3GetInt32": GetInt32(i: Instance, references: *const ValueReference, count: usize, values: *mut i32, value_count: usize) -> Status;
    set_int32 "fmi3SetInt32": SetInt32(i: Instance, references: *const ValueReference, count: usize, values: *const i32, value_count: usize) -> Status;
    get_uint32 "fmi3GetUInt32": GetUint32(i: Instance, references: *const ValueReference, count: usize, values: *mut u32, value_count: usize) -> Status;
    set_uint32 "fmi3SetUInt32": SetUint32(i: Instance, references: *const ValueReference, count: usize, values: *const u32, value_count: usize) -> Status;
    get_int64 "fmi3GetInt64": GetInt64(i: Instance, references: *const ValueReference, count: usize, values: *mut i64, value_count: usize) -> Status;
    set_int64 "fmi3SetInt64": SetInt64(i: Instance, references: *const ValueReference, count: usize, values: *const i64, value_count: usize) -> Status;
    get_uint64 "fmi3GetUInt64": GetUint64(i: Instance, references: *const ValueReference, count: usize, values: *mut u64, value_count: usize) -> Status;
    set_uint64 "fmi3SetUInt64": SetUint64(i: Instance, references: *const ValueReference, count: usize, values: *const u64, value_count: usize) -> Status;
    get_boolean "fmi3GetBoolean": GetBoolean(i: Instance, references: *const ValueReference, count: usize, values: *mut Boolean, value_count: usize) -> Status;
    set_boolean "fmi3SetBoolean": SetBoolean(i: Instance, references: *const ValueReference, count: usize, values: *const Boolean, value_count: usize) -> Status;
    get_string "fmi3GetString": GetString(i: Instance, references: *const ValueReference, count: usize, values: *mut String, value_count: usize) -> Status;
    set_string "fmi3SetString": SetString(i: Instance, references: *const ValueReference, count: usize, values: *const String, value_count: usize) -> Status;
    get_binary "fmi3GetBinary": GetBinary(i: Instance, references: *const ValueReference, count: usize, sizes: *mut usize, values: *mut Binary, value_count: usize) -> Status;
    set_binary "fmi3SetBinary": SetBinary(i: Instance, references: *const ValueReference, count: usize, sizes: *const usize, values: *const Binary, value_count: usize) -> Status;
    get_clock "fmi3GetClock": GetClock(i: Instance, references: *const ValueReference, count: usize, values: *mut Boolean) -> Status;
    set_clock "fmi3SetClock": SetClock(i: Instance, references: *const ValueReference, count: usize, values: *const Boolean) -> Status;
    get_number_of_variable_dependencies "fmi3GetNumberOfVariableDependencies": GetNumberOfVariableDependencies(i: Instance, reference: ValueReference, count: *mut usize) -> Status;
    get_variable_dependencies "fmi3GetVariableDependencies": GetVariableDependencies(i: Instance, dependent: ValueReference, dependent_elements: *mut usize, independents: *mut ValueReference, independent_elements: *mut usize, kinds: *mut DependencyKind, count: usize) -> Status;
    get_fmu_state "fmi3GetFMUState": GetFmuState(i: Instance, state: *mut State) -> Status;
    set_fmu_state "fmi3SetFMUState": SetFmuState(i: Instance, state: State) -> Status;
    free_fmu_state "fmi3FreeFMUState": FreeFmuState(i: Instance, state: *mut State) -> Status;
    serialized_fmu_state_size "fmi3SerializedFMUStateSize": SerializedFmuStateSize(i: Instance, state: State, size: *mut usize) -> Status;
    serialize_fmu_state "fmi3SerializeFMUState": SerializeFmuState(i: Instance, state: State, bytes: *mut u8, size: usize) -> Status;
    deserialize_fmu_state "fmi3DeserializeFMUState": DeserializeFmuState(i: Instance, bytes: *const u8, size: usize, state: *mut State) -> Status;
    get_directional_derivative "fmi3GetDirectionalDerivative": GetDirectionalDerivative(i: Instance, unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize, seed: *const f64, seed_count: usize, sensitivity: *mut f64, sensitivity_count: usize) -> Status;
    get_adjoint_derivative "fmi3GetAdjointDerivative": GetAdjointDerivative(i: Instance, unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize, seed: *const f64, seed_count: usize, sensitivity: *mut f64, sensitivity_count: usize) -> Status;
    enter_configuration_mode "fmi3EnterConfigurationMode": EnterConfigurationMode(i: Instance) -> Status;
    exit_configuration_mode "fmi3ExitConfigurationMode": ExitConfigurationMode(i: Instance) -> Status;
    get_interval_decimal "fmi3GetIntervalDecimal": GetIntervalDecimal(i: Instance, references: *const ValueReference, count: usize, intervals: *mut f64, qualifiers: *mut i32) -> Status;
    get_interval_fraction "fmi3GetIntervalFraction": GetIntervalFraction(i: Instance, references: *const ValueReference, count: usize, counters: *mut u64, resolutions: *mut u64, qualifiers: *mut i32) -> Status;
    get_shift_decimal "fmi3GetShiftDecimal": GetShiftDecimal(i: Instance, references: *const ValueReference, count: usize, shifts: *mut f64) -> Status;
    get_shift_fraction "fmi3GetShiftFraction": GetShiftFraction(i: Instance, references: *const ValueReference, count: usize, counters: *mut u64, resolutions: *mut u64) -> Status;
    set_interval_decimal "fmi3SetIntervalDecimal": SetIntervalDecimal(i: Instance, references: *const ValueReference, count: usize, intervals: *const f64) -> Status;
    set_interval_fraction "fmi3SetIntervalFraction": SetIntervalFraction(i: Instance, references: *const ValueReference, count: usize, counters: *const u64, resolutions: *const u64) -> Status;
    set_shift_decimal "fmi3SetShiftDecimal": SetShiftDecimal(i: Instance, references: *const ValueReference, count: usize, shifts: *const f64) -> Status;
    set_shift_fraction "fmi3SetShiftFraction": SetShiftFraction(i: Instance, references: *const ValueReference, count: usize, counters: *const u64, resolutions: *const u64) -> Status;
    evaluate_discrete_states "fmi3EvaluateDiscreteStates": EvaluateDiscreteStates(i: Instance) -> Status;
    update_discrete_states "fmi3UpdateDiscreteStates": UpdateDiscreteStates(i: Instance, need_update: *mut Boolean, terminate: *mut Boolean, nominals_changed: *mut Boolean, states_changed: *mut Boolean, next_event_time_defined: *mut Boolean, next_event_time: *mut f64) -> Status;
    enter_continuous_time_mode "fmi3EnterContinuousTimeMode": EnterContinuousTimeMode(i: Instance) -> Status;
    completed_integrator_step "fmi3CompletedIntegratorStep": CompletedIntegratorStep(i: Instance, no_set_prior: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean) -> Status;
    set_time "fmi3SetTime": SetTime(i: Instance, time: f64) -> Status;
    set_continuous_states "fmi3SetContinuousStates": SetContinuousStates(i: Instance, states: *const f64, count: usize) -> Status;
    get_continuous_state_derivatives "fmi3GetContinuousStateDerivatives": GetContinuousStateDerivatives(i: Instance, derivatives: *mut f64, count: usize) -> Status;
    get_event_indicators "fmi3GetEventIndicators": GetEventIndicators(i: Instance, indicators: *mut f64, count: usize) -> Status;
    get_continuous_states "fmi3GetContinuousStates": GetContinuousStates(i: Instance, states: *mut f64, count: usize) -> Status;
    get_nominals_of_continuous_states "fmi3GetNominalsOfContinuousStates": GetNominalsOfContinuousStates(i: Instance, nominals: *mut f64, count: usize) -> Status;
    get_number_of_event_indicators "fmi3GetNumberOfEventIndicators": GetNumberOfEventIndicators(i: Instance, count: *mut usize) -> Status;
    get_number_of_continuous_states "fmi3GetNumberOfContinuousStates": GetNumberOfContinuousStates(i: Instance, count: *mut usize) -> Status;
    enter_step_mode "fmi3EnterStepMode": EnterStepMode(i: Instance) -> Status;
    get_output_derivatives "fmi3GetOutputDerivatives": GetOutputDerivatives(i: Instance, references: *const ValueReference, count: usize, orders: *const i32, values: *mut f64, value_count: usize) -> Status;
    do_step "fmi3DoStep": DoStep(i: Instance, time: f64, step: f64, no_set_prior: Boolean, event_handling_needed: *mut Boolean, terminate: *mut Boolean, early_return: *mut Boolean, last_successful_time: *mut f64) -> Status;
    activate_model_partition "fmi3ActivateModelPartition": ActivateModelPartition(i: Instance, clock: ValueReference, activation_time: f64) -> Status;
}
