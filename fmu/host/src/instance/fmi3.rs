//! The functions of FMI 3.0.
#![allow(unsafe_code, reason = "functions of a library are called")]

use super::super::description::VariableType;
use super::super::library::{Functions, Library};
use super::call::{Answer, Base, Condition, LOADING, NOWHERE, call, function_number};
use super::message::{Log, log_message, text};
use super::scratch::Scratch;
use super::setup::{Setup, c_text};
use super::unit::{Interval, RawState, Steps, Unit};
use super::{InstanceError, StepOutcome, Stepped, Update, VariableGroup, group};
use octant_fmi::fmi3;
use std::ffi::{CString, c_char, c_void};
use std::ptr;
use std::sync::Arc;

/// Longest text and longest bytes that a variable may have.
const VALUE_MAX: usize = 1 << 28;

/// An instance of FMI 3.0.
pub(crate) struct Component {
    /// Dropped before the objects that its code may still use.
    library: Arc<Library>,
    pub(crate) base: Base,
    pub(crate) functions: fmi3::Functions,
    pub(crate) instance: fmi3::Instance,
    /// True if the importer uses event mode.
    event_mode: bool,
    /// True if states may be restored: then the FMU is told to keep the data needed for it.
    pub(crate) restorable: bool,
    scratch: Scratch,
}

// SAFETY: the pointers are the FMU's handle; the log is shared behind a lock. The FMU is called by
// one thread after another, which the standard allows.
unsafe impl Send for Component {}

/// Interface with which the FMU is instantiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    CoSimulation,
    ModelExchange,
}

impl Component {
    /// Loads and instantiates.
    pub(crate) fn new(
        library: Arc<Library>,
        setup: &Setup,
        purpose: Use,
    ) -> Result<Self, InstanceError> {
        let Functions::Fmi3(functions) = library.functions else {
            return Err(InstanceError::load(&setup.name, "its library is not of FMI 3.0"));
        };
        let log = Log::new();
        let base = setup.base(&log);
        let name = c_text(&setup.name, "the instance's name", &setup.instance_name)?;
        let token = c_text(&setup.name, "the token", &setup.description.token)?;
        let resources = setup.resource_path()?;
        let environment: fmi3::Environment = Arc::as_ptr(&log).cast_mut().cast();
        let logging = u8::from(setup.log);
        let event_mode = setup.event_mode && setup.interface.event_mode;
        let (function, instance) = match purpose {
            Use::CoSimulation => {
                let function = "fmi3InstantiateCoSimulation";
                let instantiate =
                    functions.instantiate_co_simulation.ok_or_else(|| base.missing(function))?;
                base.mark.set(function_number("fmi3InstantiateCoSimulation"));
                // SAFETY: the texts live through the call, and the log as long as the instance.
                let instance = unsafe {
                    instantiate(
                        name.as_ptr(),
                        token.as_ptr(),
                        resources.as_ptr(),
                        0,
                        logging,
                        u8::from(event_mode),
                        u8::from(setup.early_return),
                        ptr::null(),
                        0,
                        environment,
                        Some(log_message),
                        Some(intermediate_update),
                    )
                };
                (function, instance)
            }
            Use::ModelExchange => {
                let function = "fmi3InstantiateModelExchange";
                let instantiate =
                    functions.instantiate_model_exchange.ok_or_else(|| base.missing(function))?;
                base.mark.set(function_number("fmi3InstantiateModelExchange"));
                // SAFETY: as above.
                let instance = unsafe {
                    instantiate(
                        name.as_ptr(),
                        token.as_ptr(),
                        resources.as_ptr(),
                        0,
                        logging,
                        environment,
                        Some(log_message),
                    )
                };
                (function, instance)
            }
        };
        base.mark.set(NOWHERE);
        if instance.is_null() {
            return Err(base.failed(function, "no instance"));
        }
        Ok(Self {
            library,
            base,
            functions,
            instance,
            event_mode,
            restorable: setup.interface.state,
            scratch: Scratch::default(),
        })
    }

    fn unsupported_kind(&self, group: &VariableGroup, what: &str) -> InstanceError {
        InstanceError::unsupported(
            &self.base.name,
            format!("{what} {}", group::element_name(&self.base.description, group, 0)),
            format!("{:?} is no type of numbers", group.kind),
        )
    }
}

/// Callback for an update between communication points: it sets and gets nothing, and the FMU
/// continues.
unsafe extern "C" fn intermediate_update(
    _environment: fmi3::Environment,
    _time: f64,
    _set_requested: fmi3::Boolean,
    _get_allowed: fmi3::Boolean,
    _step_finished: fmi3::Boolean,
    _can_return_early: fmi3::Boolean,
    early_return_requested: *mut fmi3::Boolean,
    _early_return_time: *mut f64,
) {
    if !early_return_requested.is_null() {
        // SAFETY: the FMU gives room for the answer.
        unsafe { *early_return_requested = 0 };
    }
}

/// Gets numbers through a buffer of their type.
macro_rules! get_through {
    ($unit:ident, $group:ident, $values:ident, $scratch:ident, $field:ident $name:literal) => {{
        let mut scratch = std::mem::take(&mut $unit.scratch.$scratch);
        scratch.clear();
        scratch.resize_with($values.len(), Default::default);
        let status = call!($unit.$field $name(
            $group.references.as_ptr(),
            $group.references.len(),
            scratch.as_mut_ptr().cast(),
            scratch.len(),
        ));
        let done = $unit.base.check($name, status).and_then(|()| {
            group::numbers_to_f64(&$unit.base, $group, &scratch, $values)
        });
        $unit.scratch.$scratch = scratch;
        done
    }};
}

/// Sets numbers through a buffer of their type.
macro_rules! set_through {
    ($unit:ident, $group:ident, $values:ident, $scratch:ident, $field:ident $name:literal) => {{
        let mut scratch = std::mem::take(&mut $unit.scratch.$scratch);
        group::numbers_from_f64(&$unit.base, $group, $values, &mut scratch)?;
        let status = call!($unit.$field $name(
            $group.references.as_ptr(),
            $group.references.len(),
            scratch.as_ptr().cast(),
            scratch.len(),
        ));
        $unit.scratch.$scratch = scratch;
        $unit.base.check($name, status)
    }};
}

impl Unit for Component {
    fn base(&self) -> &Base {
        &self.base
    }

    fn enter_initialization(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), InstanceError> {
        let status = call!(self.enter_initialization_mode "fmi3EnterInitializationMode"(
            u8::from(tolerance.is_some()),
            tolerance.unwrap_or(0.0),
            start_s,
            u8::from(stop_s.is_some()),
            stop_s.unwrap_or(start_s),
        ));
        self.base.check("fmi3EnterInitializationMode", status)
    }

    fn exit_initialization(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.exit_initialization_mode "fmi3ExitInitializationMode"());
        self.base.check("fmi3ExitInitializationMode", status)
    }

    fn terminate(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.terminate "fmi3Terminate"());
        self.base.check("fmi3Terminate", status)
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        let status = call!(mend self.reset "fmi3Reset"());
        self.base.check("fmi3Reset", status)?;
        self.base.condition = Condition::Sound;
        Ok(())
    }

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
        group::expect_elements(&self.base, group, values.len())?;
        match group.kind {
            VariableType::Float64 => {
                let (references, count) = (group.references.as_ptr(), group.references.len());
                let status = call!(self.set_float64 "fmi3SetFloat64"(
                    references, count, values.as_ptr(), values.len()));
                self.base.check("fmi3SetFloat64", status)
            }
            VariableType::Float32 => {
                set_through!(self, group, values, float32, set_float32 "fmi3SetFloat32")
            }
            VariableType::Int8 => set_through!(self, group, values, int8, set_int8 "fmi3SetInt8"),
            VariableType::UInt8 => {
                set_through!(self, group, values, uint8, set_uint8 "fmi3SetUInt8")
            }
            VariableType::Int16 => {
                set_through!(self, group, values, int16, set_int16 "fmi3SetInt16")
            }
            VariableType::UInt16 => {
                set_through!(self, group, values, uint16, set_uint16 "fmi3SetUInt16")
            }
            VariableType::Int32 => {
                set_through!(self, group, values, int32, set_int32 "fmi3SetInt32")
            }
            VariableType::UInt32 => {
                set_through!(self, group, values, uint32, set_uint32 "fmi3SetUInt32")
            }
            VariableType::Int64 | VariableType::Enumeration => {
                set_through!(self, group, values, int64, set_int64 "fmi3SetInt64")
            }
            VariableType::UInt64 => {
                set_through!(self, group, values, uint64, set_uint64 "fmi3SetUInt64")
            }
            VariableType::Boolean => {
                set_through!(self, group, values, truths, set_boolean "fmi3SetBoolean")
            }
            VariableType::Clock => {
                group::expect_scalars(&self.base, group, values.len())?;
                let mut clocks = std::mem::take(&mut self.scratch.truths);
                group::numbers_from_f64(&self.base, group, values, &mut clocks)?;
                let status = call!(self.set_clock "fmi3SetClock"(
                    group.references.as_ptr(), group.references.len(), clocks.as_ptr().cast()));
                self.scratch.truths = clocks;
                self.base.check("fmi3SetClock", status)
            }
            VariableType::String | VariableType::Binary => Err(self.unsupported_kind(group, "set")),
        }
    }

    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError> {
        group::expect_elements(&self.base, group, values.len())?;
        match group.kind {
            VariableType::Float64 => {
                let (references, count) = (group.references.as_ptr(), group.references.len());
                let status = call!(self.get_float64 "fmi3GetFloat64"(
                    references, count, values.as_mut_ptr(), values.len()));
                self.base.check("fmi3GetFloat64", status)
            }
            VariableType::Float32 => {
                get_through!(self, group, values, float32, get_float32 "fmi3GetFloat32")
            }
            VariableType::Int8 => get_through!(self, group, values, int8, get_int8 "fmi3GetInt8"),
            VariableType::UInt8 => {
                get_through!(self, group, values, uint8, get_uint8 "fmi3GetUInt8")
            }
            VariableType::Int16 => {
                get_through!(self, group, values, int16, get_int16 "fmi3GetInt16")
            }
            VariableType::UInt16 => {
                get_through!(self, group, values, uint16, get_uint16 "fmi3GetUInt16")
            }
            VariableType::Int32 => {
                get_through!(self, group, values, int32, get_int32 "fmi3GetInt32")
            }
            VariableType::UInt32 => {
                get_through!(self, group, values, uint32, get_uint32 "fmi3GetUInt32")
            }
            VariableType::Int64 | VariableType::Enumeration => {
                get_through!(self, group, values, int64, get_int64 "fmi3GetInt64")
            }
            VariableType::UInt64 => {
                get_through!(self, group, values, uint64, get_uint64 "fmi3GetUInt64")
            }
            VariableType::Boolean => {
                get_through!(self, group, values, truths, get_boolean "fmi3GetBoolean")
            }
            VariableType::Clock => {
                group::expect_scalars(&self.base, group, values.len())?;
                let mut clocks = std::mem::take(&mut self.scratch.truths);
                clocks.clear();
                clocks.resize_with(values.len(), Default::default);
                let status = call!(self.get_clock "fmi3GetClock"(
                    group.references.as_ptr(), group.references.len(),
                    clocks.as_mut_ptr().cast()));
                let done = self
                    .base
                    .check("fmi3GetClock", status)
                    .and_then(|()| group::numbers_to_f64(&self.base, group, &clocks, values));
                self.scratch.truths = clocks;
                done
            }
            VariableType::String | VariableType::Binary => Err(self.unsupported_kind(group, "get")),
        }
    }

    fn set_strings(
        &mut self,
        group: &VariableGroup,
        values: &[String],
    ) -> Result<(), InstanceError> {
        group::expect_elements(&self.base, group, values.len())?;
        let texts: Vec<CString> = values
            .iter()
            .map(|value| c_text(&self.base.name, "a text", value))
            .collect::<Result<_, _>>()?;
        let pointers: Vec<*const c_char> = texts.iter().map(|text| text.as_ptr()).collect();
        let status = call!(self.set_string "fmi3SetString"(
            group.references.as_ptr(), group.references.len(), pointers.as_ptr(), pointers.len()));
        self.base.check("fmi3SetString", status)
    }

    fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError> {
        let mut pointers = vec![ptr::null(); group.elements];
        let status = call!(self.get_string "fmi3GetString"(
            group.references.as_ptr(), group.references.len(),
            pointers.as_mut_ptr(), pointers.len()));
        self.base.check("fmi3GetString", status)?;
        // SAFETY: null or the FMU's text, which lives until the next call.
        Ok(pointers.into_iter().map(|pointer| unsafe { text(pointer, VALUE_MAX) }).collect())
    }

    fn set_binaries(
        &mut self,
        group: &VariableGroup,
        values: &[Vec<u8>],
    ) -> Result<(), InstanceError> {
        group::expect_elements(&self.base, group, values.len())?;
        let sizes: Vec<usize> = values.iter().map(Vec::len).collect();
        let pointers: Vec<*const u8> = values.iter().map(|bytes| bytes.as_ptr()).collect();
        let status = call!(self.set_binary "fmi3SetBinary"(
            group.references.as_ptr(), group.references.len(),
            sizes.as_ptr(), pointers.as_ptr(), pointers.len()));
        self.base.check("fmi3SetBinary", status)
    }

    fn get_binaries(&mut self, group: &VariableGroup) -> Result<Vec<Vec<u8>>, InstanceError> {
        let mut sizes = vec![0; group.elements];
        let mut pointers = vec![ptr::null(); group.elements];
        let status = call!(self.get_binary "fmi3GetBinary"(
            group.references.as_ptr(), group.references.len(),
            sizes.as_mut_ptr(), pointers.as_mut_ptr(), pointers.len()));
        self.base.check("fmi3GetBinary", status)?;
        let mut values = Vec::with_capacity(group.elements);
        for (size, pointer) in sizes.into_iter().zip(pointers) {
            if size > VALUE_MAX {
                return Err(self.base.failed("fmi3GetBinary", &format!("{size} bytes")));
            }
            values.push(if pointer.is_null() || size == 0 {
                Vec::new()
            } else {
                // SAFETY: the FMU says that so many bytes are there; they live until the next call.
                unsafe { std::slice::from_raw_parts(pointer, size) }.to_vec()
            });
        }
        Ok(values)
    }

    fn enter_configuration_mode(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.enter_configuration_mode "fmi3EnterConfigurationMode"());
        self.base.check("fmi3EnterConfigurationMode", status)
    }

    fn exit_configuration_mode(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.exit_configuration_mode "fmi3ExitConfigurationMode"());
        self.base.check("fmi3ExitConfigurationMode", status)
    }

    fn enter_event_mode(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.enter_event_mode "fmi3EnterEventMode"());
        self.base.check("fmi3EnterEventMode", status)
    }

    fn update_discrete_states(&mut self) -> Result<Update, InstanceError> {
        let mut flags = [0u8; 5];
        let mut next_event_time_s = 0.0;
        let [again, terminate, nominals, states, defined] = &mut flags;
        let status = call!(self.update_discrete_states "fmi3UpdateDiscreteStates"(
            again, terminate, nominals, states, defined, &mut next_event_time_s));
        self.base.check("fmi3UpdateDiscreteStates", status)?;
        let [again, terminate, nominals_changed, states_changed, defined] =
            flags.map(|flag| flag != 0);
        let next_event_time_s = defined.then_some(next_event_time_s);
        Ok(Update { again, terminate, nominals_changed, states_changed, next_event_time_s })
    }

    fn state(&mut self) -> Result<RawState, InstanceError> {
        let mut state = ptr::null_mut();
        let status = call!(self.get_fmu_state "fmi3GetFMUState"(&mut state));
        self.base.check("fmi3GetFMUState", status)?;
        Ok(state)
    }

    fn set_state(&mut self, state: RawState) -> Result<(), InstanceError> {
        let status = call!(mend self.set_fmu_state "fmi3SetFMUState"(state));
        self.base.check("fmi3SetFMUState", status)?;
        self.base.condition = Condition::Sound;
        Ok(())
    }

    fn free_state(&mut self, mut state: RawState) -> Result<(), InstanceError> {
        let status = call!(mend self.free_fmu_state "fmi3FreeFMUState"(&mut state));
        self.base.check("fmi3FreeFMUState", status)
    }

    fn serialize(&mut self, state: RawState) -> Result<Vec<u8>, InstanceError> {
        let mut size = 0;
        let status =
            call!(self.serialized_fmu_state_size "fmi3SerializedFMUStateSize"(state, &mut size));
        self.base.check("fmi3SerializedFMUStateSize", status)?;
        let mut bytes = self.base.state_buffer(size)?;
        let status = call!(self.serialize_fmu_state "fmi3SerializeFMUState"(
            state, bytes.as_mut_ptr(), size));
        self.base.check("fmi3SerializeFMUState", status)?;
        Ok(bytes)
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<RawState, InstanceError> {
        let mut state: *mut c_void = ptr::null_mut();
        let status = call!(self.deserialize_fmu_state "fmi3DeserializeFMUState"(
            bytes.as_ptr(), bytes.len(), &mut state));
        self.base.check("fmi3DeserializeFMUState", status)?;
        Ok(state)
    }
}

impl Steps for Component {
    fn has_event_mode(&self) -> bool {
        self.event_mode
    }

    fn enter_step_mode(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.enter_step_mode "fmi3EnterStepMode"());
        self.base.check("fmi3EnterStepMode", status)
    }

    fn do_step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        let mut flags = [0u8; 3];
        let mut reached_s = time_s + step_s;
        let [event, terminate, early] = &mut flags;
        let status = call!(self.do_step "fmi3DoStep"(
            time_s, step_s, u8::from(!self.restorable), event, terminate, early, &mut reached_s));
        let [event, terminate, early] = flags.map(|flag| flag != 0);
        let outcome = match self.base.answer("fmi3DoStep", status)? {
            Answer::Fine if early => StepOutcome::Early,
            Answer::Fine => StepOutcome::Done,
            Answer::Discard => StepOutcome::Discarded,
            Answer::Pending => return Err(self.base.failed("fmi3DoStep", "pending")),
        };
        let time_s = match outcome {
            StepOutcome::Done => time_s + step_s,
            // A reported time outside of the step means that no part of it was made.
            _ if reached_s >= time_s && reached_s <= time_s + step_s => reached_s,
            _ => time_s,
        };
        Ok(Stepped { time_s, outcome, event: event && self.event_mode, terminate })
    }

    fn interval(&mut self, clock: u32) -> Result<Interval, InstanceError> {
        let (mut interval_s, mut qualifier) = (0.0, fmi3::INTERVAL_NOT_YET_KNOWN);
        let status = call!(self.get_interval_decimal "fmi3GetIntervalDecimal"(
            &clock, 1, &mut interval_s, &mut qualifier));
        self.base.check("fmi3GetIntervalDecimal", status)?;
        Ok(match qualifier {
            fmi3::INTERVAL_CHANGED => Interval::Changed(interval_s),
            fmi3::INTERVAL_UNCHANGED => Interval::Unchanged(interval_s),
            _ => Interval::Unknown,
        })
    }

    fn activate(&mut self, clock: u32) -> Result<(), InstanceError> {
        let status = call!(self.set_clock "fmi3SetClock"(&clock, 1, &1));
        self.base.check("fmi3SetClock", status)
    }
}

impl Drop for Component {
    fn drop(&mut self) {
        if self.base.condition == Condition::Lost {
            // A lost FMU isn't called again, so that the objects it may still use have to stay.
            std::mem::forget((Arc::clone(&self.library), Arc::clone(&self.base.log)));
            return;
        }
        if let Some(free) = self.functions.free_instance {
            self.base.mark.set(function_number("fmi3FreeInstance"));
            // SAFETY: the instance is alive, and this is the last that is done with it.
            unsafe { free(self.instance) };
            // The library may be unloaded next, which runs its destructors.
            self.base.mark.set(LOADING);
        }
    }
}
