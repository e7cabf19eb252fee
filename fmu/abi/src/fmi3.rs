//! FMI 3.0: model exchange, co-simulation and scheduled execution.

pub use super::{DISCARD, ERROR, FATAL, OK, Status, String, ValueReference, WARNING};
use core::ffi::c_void;

/// `fmi3Instance`.
pub type Instance = *mut c_void;
/// `fmi3InstanceEnvironment`.
pub type Environment = *mut c_void;
/// `fmi3FMUState`.
pub type State = *mut c_void;
/// `fmi3Boolean` (and `fmi3Clock`): C's `bool`; see the note of the crate.
pub type Boolean = u8;
/// `fmi3True`.
pub const TRUE: Boolean = 1;
/// `fmi3False`.
pub const FALSE: Boolean = 0;
/// `fmi3Binary`.
pub type Binary = *const u8;

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

/// Applies a macro to the types of numbers and Booleans: the name of each, the type of a value in C,
/// and the functions that get and set variables of the type. Tokens given after the macro's name
/// come first.
#[macro_export]
macro_rules! fmi3_types {
    ($apply:ident $($first:tt)*) => {
        $apply! {
            $($first)*
            Float32 f32: fmi3GetFloat32 fmi3SetFloat32;
            Float64 f64: fmi3GetFloat64 fmi3SetFloat64;
            Int8 i8: fmi3GetInt8 fmi3SetInt8;
            UInt8 u8: fmi3GetUInt8 fmi3SetUInt8;
            Int16 i16: fmi3GetInt16 fmi3SetInt16;
            UInt16 u16: fmi3GetUInt16 fmi3SetUInt16;
            Int32 i32: fmi3GetInt32 fmi3SetInt32;
            UInt32 u32: fmi3GetUInt32 fmi3SetUInt32;
            Int64 i64: fmi3GetInt64 fmi3SetInt64;
            UInt64 u64: fmi3GetUInt64 fmi3SetUInt64;
            Boolean Boolean: fmi3GetBoolean fmi3SetBoolean;
        }
    };
}

fmi3_types! {
    functions {
        fmi3GetVersion() -> String;
        fmi3SetDebugLogging(i: Instance, on: Boolean, count: usize, categories: *const String) -> Status;
        fmi3InstantiateModelExchange(name: String, token: String, resources: String, visible: Boolean, logging: Boolean, environment: Environment, log: Option<LogMessage>) -> Instance;
        fmi3InstantiateCoSimulation(name: String, token: String, resources: String, visible: Boolean, logging: Boolean, event_mode_used: Boolean, early_return_allowed: Boolean, required: *const ValueReference, required_count: usize, environment: Environment, log: Option<LogMessage>, intermediate_update: Option<IntermediateUpdate>) -> Instance;
        fmi3InstantiateScheduledExecution(name: String, token: String, resources: String, visible: Boolean, logging: Boolean, environment: Environment, log: Option<LogMessage>, clock_update: Option<ClockUpdate>, lock: Option<Preemption>, unlock: Option<Preemption>) -> Instance;
        fmi3FreeInstance(i: Instance);
        fmi3EnterInitializationMode(i: Instance, tolerance_defined: Boolean, tolerance: f64, start: f64, stop_defined: Boolean, stop: f64) -> Status;
        fmi3ExitInitializationMode(i: Instance) -> Status;
        fmi3EnterEventMode(i: Instance) -> Status;
        fmi3Terminate(i: Instance) -> Status;
        fmi3Reset(i: Instance) -> Status;
    } {
        fmi3GetString(i: Instance, references: *const ValueReference, count: usize, values: *mut String, value_count: usize) -> Status;
        fmi3SetString(i: Instance, references: *const ValueReference, count: usize, values: *const String, value_count: usize) -> Status;
        fmi3GetBinary(i: Instance, references: *const ValueReference, count: usize, sizes: *mut usize, values: *mut Binary, value_count: usize) -> Status;
        fmi3SetBinary(i: Instance, references: *const ValueReference, count: usize, sizes: *const usize, values: *const Binary, value_count: usize) -> Status;
        fmi3GetClock(i: Instance, references: *const ValueReference, count: usize, values: *mut Boolean) -> Status;
        fmi3SetClock(i: Instance, references: *const ValueReference, count: usize, values: *const Boolean) -> Status;
        fmi3GetNumberOfVariableDependencies(i: Instance, reference: ValueReference, count: *mut usize) -> Status;
        fmi3GetVariableDependencies(i: Instance, dependent: ValueReference, dependent_elements: *mut usize, independents: *mut ValueReference, independent_elements: *mut usize, kinds: *mut DependencyKind, count: usize) -> Status;
        fmi3GetFMUState(i: Instance, state: *mut State) -> Status;
        fmi3SetFMUState(i: Instance, state: State) -> Status;
        fmi3FreeFMUState(i: Instance, state: *mut State) -> Status;
        fmi3SerializedFMUStateSize(i: Instance, state: State, size: *mut usize) -> Status;
        fmi3SerializeFMUState(i: Instance, state: State, bytes: *mut u8, size: usize) -> Status;
        fmi3DeserializeFMUState(i: Instance, bytes: *const u8, size: usize, state: *mut State) -> Status;
        fmi3GetDirectionalDerivative(i: Instance, unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize, seed: *const f64, seed_count: usize, sensitivity: *mut f64, sensitivity_count: usize) -> Status;
        fmi3GetAdjointDerivative(i: Instance, unknowns: *const ValueReference, unknown_count: usize, knowns: *const ValueReference, known_count: usize, seed: *const f64, seed_count: usize, sensitivity: *mut f64, sensitivity_count: usize) -> Status;
        fmi3EnterConfigurationMode(i: Instance) -> Status;
        fmi3ExitConfigurationMode(i: Instance) -> Status;
        fmi3GetIntervalDecimal(i: Instance, references: *const ValueReference, count: usize, intervals: *mut f64, qualifiers: *mut i32) -> Status;
        fmi3GetIntervalFraction(i: Instance, references: *const ValueReference, count: usize, counters: *mut u64, resolutions: *mut u64, qualifiers: *mut i32) -> Status;
        fmi3GetShiftDecimal(i: Instance, references: *const ValueReference, count: usize, shifts: *mut f64) -> Status;
        fmi3GetShiftFraction(i: Instance, references: *const ValueReference, count: usize, counters: *mut u64, resolutions: *mut u64) -> Status;
        fmi3SetIntervalDecimal(i: Instance, references: *const ValueReference, count: usize, intervals: *const f64) -> Status;
        fmi3SetIntervalFraction(i: Instance, references: *const ValueReference, count: usize, counters: *const u64, resolutions: *const u64) -> Status;
        fmi3SetShiftDecimal(i: Instance, references: *const ValueReference, count: usize, shifts: *const f64) -> Status;
        fmi3SetShiftFraction(i: Instance, references: *const ValueReference, count: usize, counters: *const u64, resolutions: *const u64) -> Status;
        fmi3EvaluateDiscreteStates(i: Instance) -> Status;
        fmi3UpdateDiscreteStates(i: Instance, need_update: *mut Boolean, terminate: *mut Boolean, nominals_changed: *mut Boolean, states_changed: *mut Boolean, next_event_time_defined: *mut Boolean, next_event_time: *mut f64) -> Status;
        fmi3EnterContinuousTimeMode(i: Instance) -> Status;
        fmi3CompletedIntegratorStep(i: Instance, no_set_prior: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean) -> Status;
        fmi3SetTime(i: Instance, time: f64) -> Status;
        fmi3SetContinuousStates(i: Instance, states: *const f64, count: usize) -> Status;
        fmi3GetContinuousStateDerivatives(i: Instance, derivatives: *mut f64, count: usize) -> Status;
        fmi3GetEventIndicators(i: Instance, indicators: *mut f64, count: usize) -> Status;
        fmi3GetContinuousStates(i: Instance, states: *mut f64, count: usize) -> Status;
        fmi3GetNominalsOfContinuousStates(i: Instance, nominals: *mut f64, count: usize) -> Status;
        fmi3GetNumberOfEventIndicators(i: Instance, count: *mut usize) -> Status;
        fmi3GetNumberOfContinuousStates(i: Instance, count: *mut usize) -> Status;
        fmi3EnterStepMode(i: Instance) -> Status;
        fmi3GetOutputDerivatives(i: Instance, references: *const ValueReference, count: usize, orders: *const i32, values: *mut f64, value_count: usize) -> Status;
        fmi3DoStep(i: Instance, time: f64, step: f64, no_set_prior: Boolean, event_handling_needed: *mut Boolean, terminate: *mut Boolean, early_return: *mut Boolean, last_successful_time: *mut f64) -> Status;
        fmi3ActivateModelPartition(i: Instance, clock: ValueReference, activation_time: f64) -> Status;
    }
}
