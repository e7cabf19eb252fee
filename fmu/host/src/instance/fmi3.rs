//! The functions of FMI 3.0.
#![allow(unsafe_code, reason = "functions of a library are called")]

use super::super::description::VariableType;
use super::super::library::{Functions, Library};
use super::call::{
    Answer, Base, Condition, NOWHERE, UNLOADING, ask, call, free_on_drop, function_number,
    functions_of_both,
};
use super::clock_update::{RunningActivation, WatchedClocks, clock_update, preemption};
use super::message::{Log, log_message, text};
use super::scratch::{Scratch3, get_through, set_through};
use super::setup::{Setup, c_text};
use super::unit::{Interval, Partitions, RawState, Steps, Unit};
use super::{ClockNews, InstanceError, StepOutcome, Stepped, Update, VariableGroup, group};
use octant_fmi::{fmi3, fmi3_types};
use std::ffi::{CString, c_char};
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
    /// True once it was said that the FMU's time contradicts the step.
    told_time: bool,
    scratch: Scratch3,
}

// SAFETY: the pointers are the FMU's handle; the log is shared behind a lock. The FMU is called by
// one thread after another, which the standard allows.
unsafe impl Send for Component {}

/// Interface with which the FMU is instantiated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    CoSimulation,
    ModelExchange,
    ScheduledExecution,
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
                    functions.fmi3InstantiateCoSimulation.ok_or_else(|| base.missing(function))?;
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
                    functions.fmi3InstantiateModelExchange.ok_or_else(|| base.missing(function))?;
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
            Use::ScheduledExecution => {
                let function = "fmi3InstantiateScheduledExecution";
                let instantiate = functions
                    .fmi3InstantiateScheduledExecution
                    .ok_or_else(|| base.missing(function))?;
                base.mark.set(function_number("fmi3InstantiateScheduledExecution"));
                // SAFETY: as above; the callbacks need nothing that ends before the instance.
                let instance = unsafe {
                    instantiate(
                        name.as_ptr(),
                        token.as_ptr(),
                        resources.as_ptr(),
                        0,
                        logging,
                        environment,
                        Some(log_message),
                        Some(clock_update),
                        Some(preemption),
                        Some(preemption),
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
            told_time: false,
            scratch: Scratch3::default(),
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

macro_rules! numbers {
    ($($kind:ident $value:ident: $get:ident $set:ident;)*) => {
        impl Component {
            /// Gets variables through a buffer of their type.
            fn get_numbers(
                &mut self,
                group: &VariableGroup,
                values: &mut [f64],
            ) -> Result<(), InstanceError> {
                match type_of(group.kind) {
                    $(VariableType::$kind => get_through!(self.$kind, group, values, $get, len),)*
                    _ => Err(self.unsupported_kind(group, "get")),
                }
            }

            /// Sets variables through a buffer of their type.
            fn set_numbers(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
                match type_of(group.kind) {
                    $(VariableType::$kind => set_through!(self.$kind, group, values, $set, len),)*
                    _ => Err(self.unsupported_kind(group, "set")),
                }
            }
        }
    };
}
fmi3_types!(numbers);

/// Type of the functions that access variables of a kind: an Enumeration is an Int64.
fn type_of(kind: VariableType) -> VariableType {
    if kind == VariableType::Enumeration { VariableType::Int64 } else { kind }
}

impl Unit for Component {
    functions_of_both! {
        fmi3ExitInitializationMode fmi3Terminate fmi3Reset fmi3EnterEventMode
        fmi3GetFMUState fmi3SetFMUState fmi3FreeFMUState
        fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState
    }

    fn enter_initialization(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), InstanceError> {
        call!(self.fmi3EnterInitializationMode(
            u8::from(tolerance.is_some()),
            tolerance.unwrap_or(0.0),
            start_s,
            u8::from(stop_s.is_some()),
            stop_s.unwrap_or(start_s),
        ))
    }

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
        group::expect_elements(&self.base, group, values.len())?;
        match group.kind {
            VariableType::Float64 => {
                let (references, count) = (group.references.as_ptr(), group.references.len());
                call!(self.fmi3SetFloat64(references, count, values.as_ptr(), values.len()))
            }
            VariableType::Clock => {
                group::expect_scalars(&self.base, group, values.len())?;
                set_through!(self.Boolean, group, values, fmi3SetClock)
            }
            _ => self.set_numbers(group, values),
        }
    }

    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError> {
        group::expect_elements(&self.base, group, values.len())?;
        match group.kind {
            VariableType::Float64 => {
                let (references, count) = (group.references.as_ptr(), group.references.len());
                call!(self.fmi3GetFloat64(references, count, values.as_mut_ptr(), values.len()))
            }
            VariableType::Clock => {
                group::expect_scalars(&self.base, group, values.len())?;
                get_through!(self.Boolean, group, values, fmi3GetClock)
            }
            _ => self.get_numbers(group, values),
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
        call!(self.fmi3SetString(
            group.references.as_ptr(),
            group.references.len(),
            pointers.as_ptr(),
            pointers.len()
        ))
    }

    fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError> {
        let mut pointers = vec![ptr::null(); group.elements];
        call!(self.fmi3GetString(
            group.references.as_ptr(),
            group.references.len(),
            pointers.as_mut_ptr(),
            pointers.len()
        ))?;
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
        call!(self.fmi3SetBinary(
            group.references.as_ptr(),
            group.references.len(),
            sizes.as_ptr(),
            pointers.as_ptr(),
            pointers.len()
        ))
    }

    fn get_binaries(&mut self, group: &VariableGroup) -> Result<Vec<Vec<u8>>, InstanceError> {
        let mut sizes = vec![0; group.elements];
        let mut pointers = vec![ptr::null(); group.elements];
        call!(self.fmi3GetBinary(
            group.references.as_ptr(),
            group.references.len(),
            sizes.as_mut_ptr(),
            pointers.as_mut_ptr(),
            pointers.len()
        ))?;
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
        call!(self.fmi3EnterConfigurationMode())
    }

    fn exit_configuration_mode(&mut self) -> Result<(), InstanceError> {
        call!(self.fmi3ExitConfigurationMode())
    }

    fn update_discrete_states(&mut self) -> Result<Update, InstanceError> {
        let mut flags = [0u8; 5];
        let mut next_event_time_s = 0.0;
        let [again, terminate, nominals, states, defined] = &mut flags;
        call!(self.fmi3UpdateDiscreteStates(
            again,
            terminate,
            nominals,
            states,
            defined,
            &mut next_event_time_s
        ))?;
        let [again, terminate, nominals_changed, states_changed, defined] =
            flags.map(|flag| flag != 0);
        let next_event_time_s = defined.then_some(next_event_time_s);
        Ok(Update { again, terminate, nominals_changed, states_changed, next_event_time_s })
    }
}

impl Steps for Component {
    fn has_event_mode(&self) -> bool {
        self.event_mode
    }

    fn enter_step_mode(&mut self) -> Result<(), InstanceError> {
        call!(self.fmi3EnterStepMode())
    }

    fn do_step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        let mut flags = [0u8; 3];
        let mut reached_s = time_s + step_s;
        let [event, terminate, early] = &mut flags;
        let keep = u8::from(!self.restorable);
        let answer =
            ask!(self.fmi3DoStep(time_s, step_s, keep, event, terminate, early, &mut reached_s))?;
        let [event, terminate, early] = flags.map(|flag| flag != 0);
        let outcome = match answer {
            Answer::Fine if early => StepOutcome::Early,
            Answer::Fine => StepOutcome::Done,
            Answer::Discard => StepOutcome::Discarded,
            Answer::Pending => return Err(self.base.failed("fmi3DoStep", "pending")),
        };
        let end_s = time_s + step_s;
        let close_s = 1e-9 * step_s + f64::EPSILON * end_s.abs();
        let from_s = if outcome == StepOutcome::Done { end_s } else { time_s };
        let is_told = (from_s - close_s..=end_s + close_s).contains(&reached_s);
        if !is_told && !self.told_time {
            self.told_time = true;
            self.base.note(&format!(
                "fmi3DoStep: lastSuccessfulTime is {reached_s} s after {} from {time_s} s to {end_s} s",
                match outcome {
                    StepOutcome::Done => "a whole step",
                    StepOutcome::Early => "an early return from a step",
                    StepOutcome::Discarded => "a discarded step",
                }
            ));
        }
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
        call!(self.fmi3GetIntervalDecimal(&clock, 1, &mut interval_s, &mut qualifier))?;
        Ok(match qualifier {
            fmi3::INTERVAL_CHANGED => Interval::Changed(interval_s),
            fmi3::INTERVAL_UNCHANGED => Interval::Unchanged(interval_s),
            _ => Interval::Unknown,
        })
    }

    fn activate(&mut self, clock: u32) -> Result<(), InstanceError> {
        call!(self.fmi3SetClock(&clock, 1, &1))
    }
}

impl Partitions for Component {
    fn activate_partition(
        &mut self,
        clock: u32,
        time_s: f64,
        watched: &Arc<WatchedClocks>,
    ) -> Result<ClockNews, InstanceError> {
        RunningActivation::begin(self.functions, self.instance, watched);
        let activated = call!(self.fmi3ActivateModelPartition(clock, time_s));
        let news = RunningActivation::end();
        activated?;
        match news {
            Ok(news) => Ok(news),
            Err((function, None)) => Err(self.base.missing(function)),
            Err((function, Some(status))) => {
                self.base.check(function, status)?;
                Ok(ClockNews::default())
            }
        }
    }
}

free_on_drop!(fmi3FreeInstance, library);
