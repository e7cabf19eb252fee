//! The functions of FMI 2.0.
#![allow(unsafe_code, reason = "functions of a library are called")]

use super::super::description::VariableType;
use super::super::library::{Functions, Library};
use super::call::{Answer, Base, Condition, NOWHERE, call, function_number};
use super::message::{Log, callbacks, text};
use super::number::Truth;
use super::setup::{Setup, c_text};
use super::unit::{Interval, RawState, Steps, Unit};
use super::{InstanceError, StepOutcome, Stepped, Update, VariableGroup, group};
use octant_fmi::fmi2;
use std::ffi::{CString, c_char, c_void};
use std::ptr;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longest text that an FMU's String may have, bytes.
const STRING_MAX: usize = 1 << 24;

/// An instance of FMI 2.0.
pub(crate) struct Component {
    /// Dropped before the objects that its code may still use.
    library: Arc<Library>,
    callbacks: Arc<fmi2::CallbackFunctions>,
    pub(crate) base: Base,
    pub(crate) functions: fmi2::Functions,
    pub(crate) instance: fmi2::Component,
    /// Longest time of a pending step.
    time_limit: Duration,
    /// True if states may be restored: then the FMU is told to keep the data needed for it.
    pub(crate) restorable: bool,
    integers: Vec<i32>,
    truths: Vec<Truth<i32>>,
}

// SAFETY: the pointers are the FMU's handle and the callbacks, whose log is shared behind a lock.
// The FMU is called by one thread after another, which the standard allows.
unsafe impl Send for Component {}

impl Component {
    /// Loads and instantiates. `kind` is one of [`fmi2::CO_SIMULATION`], [`fmi2::MODEL_EXCHANGE`].
    pub(crate) fn new(
        library: Arc<Library>,
        setup: &Setup,
        kind: i32,
    ) -> Result<Self, InstanceError> {
        let Functions::Fmi2(functions) = library.functions else {
            return Err(InstanceError::load(&setup.name, "its library is not of FMI 2.0"));
        };
        let log = Log::new();
        let base = setup.base(&log);
        if let Some(platform) = functions.get_types_platform {
            base.mark.set(function_number("fmi2GetTypesPlatform"));
            // SAFETY: the function takes nothing and gives null or a text that stays.
            let platform = unsafe { text(platform(), STRING_MAX) };
            base.mark.set(NOWHERE);
            if platform != "default" {
                return Err(InstanceError::load(
                    &setup.name,
                    format!("its types are those of {platform:?}, expected \"default\""),
                ));
            }
        }
        let name = c_text(&setup.name, "the instance's name", &setup.instance_name)?;
        let token = c_text(&setup.name, "the guid", &setup.description.token)?;
        let resources = c_text(&setup.name, "the folder", &setup.resource_uri())?;
        #[allow(clippy::arc_with_non_send_sync, reason = "for its address, which has to stay")]
        let callbacks = Arc::new(callbacks(&log));
        let instantiate = functions.instantiate.ok_or_else(|| base.missing("fmi2Instantiate"))?;
        base.mark.set(function_number("fmi2Instantiate"));
        // SAFETY: the texts live through the call, and the callbacks as long as the instance.
        let instance = unsafe {
            instantiate(
                name.as_ptr(),
                kind,
                token.as_ptr(),
                resources.as_ptr(),
                Arc::as_ptr(&callbacks),
                fmi2::FALSE,
                i32::from(setup.log),
            )
        };
        base.mark.set(NOWHERE);
        if instance.is_null() {
            return Err(base.failed("fmi2Instantiate", "no instance"));
        }
        Ok(Self {
            library,
            callbacks,
            base,
            functions,
            instance,
            time_limit: setup.time_limit,
            restorable: setup.interface.state,
            integers: Vec::new(),
            truths: Vec::new(),
        })
    }

    /// Error for a type that is no number type in FMI 2.0.
    fn unsupported_kind(&self, group: &VariableGroup, what: &str) -> InstanceError {
        InstanceError::unsupported(
            &self.base.name,
            format!("{what} {}", group::element_name(&self.base.description, group, 0)),
            format!("{:?} is no type of numbers in FMI 2.0", group.kind),
        )
    }

    /// Waits for the end of a pending step.
    fn wait(&mut self) -> Result<Answer, InstanceError> {
        let until = Instant::now() + self.time_limit;
        loop {
            let mut status = fmi2::PENDING;
            let asked = call!(self.get_status "fmi2GetStatus"(fmi2::DO_STEP_STATUS, &mut status));
            self.base.check("fmi2GetStatus", asked)?;
            match self.base.answer("fmi2DoStep", status)? {
                Answer::Pending if Instant::now() < until => {
                    std::thread::sleep(Duration::from_micros(100));
                }
                Answer::Pending => {
                    let status = call!(self.cancel_step "fmi2CancelStep"());
                    self.base.check("fmi2CancelStep", status)?;
                    return Err(self.base.failed("fmi2DoStep", "pending beyond the time limit"));
                }
                answer => return Ok(answer),
            }
        }
    }

    /// Reads the result of a discarded step: the time reached, and whether the FMU requests the
    /// end.
    fn discarded(&mut self, time_s: f64) -> Result<Stepped, InstanceError> {
        let mut reached_s = time_s;
        let mut terminated = fmi2::FALSE;
        // Both functions are optional in practice: without them the FMU is assumed to have made no
        // step and to continue.
        if self.functions.get_real_status.is_some() {
            let status = call!(self.get_real_status "fmi2GetRealStatus"(
                fmi2::LAST_SUCCESSFUL_TIME, &mut reached_s));
            if self.base.answer("fmi2GetRealStatus", status)? != Answer::Fine
                || !reached_s.is_finite()
            {
                reached_s = time_s;
            }
        }
        if self.functions.get_boolean_status.is_some() {
            let status = call!(self.get_boolean_status "fmi2GetBooleanStatus"(
                fmi2::TERMINATED, &mut terminated));
            if self.base.answer("fmi2GetBooleanStatus", status)? != Answer::Fine {
                terminated = fmi2::FALSE;
            }
        }
        Ok(Stepped {
            time_s: reached_s,
            outcome: StepOutcome::Discarded,
            event: false,
            terminate: terminated != fmi2::FALSE,
        })
    }
}

/// Gets numbers of another type than f64 into `scratch` and from there into `values`.
macro_rules! get_through {
    ($unit:ident, $group:ident, $values:ident, $scratch:ident, $field:ident $name:literal) => {{
        let mut scratch = std::mem::take(&mut $unit.$scratch);
        scratch.clear();
        scratch.resize_with($values.len(), Default::default);
        let status = call!($unit.$field $name(
            $group.references.as_ptr(),
            $group.references.len(),
            scratch.as_mut_ptr().cast(),
        ));
        let done = $unit.base.check($name, status).and_then(|()| {
            group::numbers_to_f64(&$unit.base, $group, &scratch, $values)
        });
        $unit.$scratch = scratch;
        done
    }};
}

/// Sets numbers of another type than f64 from `values` through `scratch`.
macro_rules! set_through {
    ($unit:ident, $group:ident, $values:ident, $scratch:ident, $field:ident $name:literal) => {{
        let mut scratch = std::mem::take(&mut $unit.$scratch);
        group::numbers_from_f64(&$unit.base, $group, $values, &mut scratch)?;
        let status = call!($unit.$field $name(
            $group.references.as_ptr(),
            $group.references.len(),
            scratch.as_ptr().cast(),
        ));
        $unit.$scratch = scratch;
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
        let status = call!(self.setup_experiment "fmi2SetupExperiment"(
            i32::from(tolerance.is_some()),
            tolerance.unwrap_or(0.0),
            start_s,
            i32::from(stop_s.is_some()),
            stop_s.unwrap_or(start_s),
        ));
        self.base.check("fmi2SetupExperiment", status)?;
        let status = call!(self.enter_initialization_mode "fmi2EnterInitializationMode"());
        self.base.check("fmi2EnterInitializationMode", status)
    }

    fn exit_initialization(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.exit_initialization_mode "fmi2ExitInitializationMode"());
        self.base.check("fmi2ExitInitializationMode", status)
    }

    fn terminate(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.terminate "fmi2Terminate"());
        self.base.check("fmi2Terminate", status)
    }

    fn reset(&mut self) -> Result<(), InstanceError> {
        let status = call!(mend self.reset "fmi2Reset"());
        self.base.check("fmi2Reset", status)?;
        self.base.condition = Condition::Sound;
        Ok(())
    }

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
        group::expect_scalars(&self.base, group, values.len())?;
        match group.kind {
            VariableType::Float64 => {
                let (references, count) = (group.references.as_ptr(), group.references.len());
                let status = call!(self.set_real "fmi2SetReal"(references, count, values.as_ptr()));
                self.base.check("fmi2SetReal", status)
            }
            VariableType::Int32 | VariableType::Enumeration => {
                set_through!(self, group, values, integers, set_integer "fmi2SetInteger")
            }
            VariableType::Boolean => {
                set_through!(self, group, values, truths, set_boolean "fmi2SetBoolean")
            }
            _ => Err(self.unsupported_kind(group, "set")),
        }
    }

    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError> {
        group::expect_scalars(&self.base, group, values.len())?;
        match group.kind {
            VariableType::Float64 => {
                let (references, count) = (group.references.as_ptr(), group.references.len());
                let status =
                    call!(self.get_real "fmi2GetReal"(references, count, values.as_mut_ptr()));
                self.base.check("fmi2GetReal", status)
            }
            VariableType::Int32 | VariableType::Enumeration => {
                get_through!(self, group, values, integers, get_integer "fmi2GetInteger")
            }
            VariableType::Boolean => {
                get_through!(self, group, values, truths, get_boolean "fmi2GetBoolean")
            }
            _ => Err(self.unsupported_kind(group, "get")),
        }
    }

    fn set_strings(
        &mut self,
        group: &VariableGroup,
        values: &[String],
    ) -> Result<(), InstanceError> {
        group::expect_scalars(&self.base, group, values.len())?;
        let texts: Vec<CString> = values
            .iter()
            .map(|value| c_text(&self.base.name, "a text", value))
            .collect::<Result<_, _>>()?;
        let pointers: Vec<*const c_char> = texts.iter().map(|text| text.as_ptr()).collect();
        let status = call!(self.set_string "fmi2SetString"(
            group.references.as_ptr(), group.references.len(), pointers.as_ptr()));
        self.base.check("fmi2SetString", status)
    }

    fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError> {
        group::expect_scalars(&self.base, group, group.elements)?;
        let mut pointers = vec![ptr::null(); group.elements];
        let status = call!(self.get_string "fmi2GetString"(
            group.references.as_ptr(), group.references.len(), pointers.as_mut_ptr()));
        self.base.check("fmi2GetString", status)?;
        // SAFETY: null or the FMU's text, which lives until the next call.
        Ok(pointers.into_iter().map(|pointer| unsafe { text(pointer, STRING_MAX) }).collect())
    }

    fn set_binaries(&mut self, _: &VariableGroup, _: &[Vec<u8>]) -> Result<(), InstanceError> {
        Err(InstanceError::unsupported(&self.base.name, "set bytes", "FMI 2.0 has no Binary"))
    }

    fn get_binaries(&mut self, _: &VariableGroup) -> Result<Vec<Vec<u8>>, InstanceError> {
        Err(InstanceError::unsupported(&self.base.name, "get bytes", "FMI 2.0 has no Binary"))
    }

    fn enter_configuration_mode(&mut self) -> Result<(), InstanceError> {
        Err(InstanceError::unsupported(
            &self.base.name,
            "set a structural parameter",
            "FMI 2.0 has none",
        ))
    }

    fn exit_configuration_mode(&mut self) -> Result<(), InstanceError> {
        self.enter_configuration_mode()
    }

    fn enter_event_mode(&mut self) -> Result<(), InstanceError> {
        let status = call!(self.enter_event_mode "fmi2EnterEventMode"());
        self.base.check("fmi2EnterEventMode", status)
    }

    fn update_discrete_states(&mut self) -> Result<Update, InstanceError> {
        let mut info = fmi2::EventInfo::default();
        let status = call!(self.new_discrete_states "fmi2NewDiscreteStates"(&mut info));
        self.base.check("fmi2NewDiscreteStates", status)?;
        Ok(Update {
            again: info.new_discrete_states_needed != 0,
            terminate: info.terminate_simulation != 0,
            nominals_changed: info.nominals_of_continuous_states_changed != 0,
            states_changed: info.values_of_continuous_states_changed != 0,
            next_event_time_s: (info.next_event_time_defined != 0).then_some(info.next_event_time),
        })
    }

    fn state(&mut self) -> Result<RawState, InstanceError> {
        let mut state = ptr::null_mut();
        let status = call!(self.get_fmu_state "fmi2GetFMUstate"(&mut state));
        self.base.check("fmi2GetFMUstate", status)?;
        Ok(state)
    }

    fn set_state(&mut self, state: RawState) -> Result<(), InstanceError> {
        let status = call!(mend self.set_fmu_state "fmi2SetFMUstate"(state));
        self.base.check("fmi2SetFMUstate", status)?;
        self.base.condition = Condition::Sound;
        Ok(())
    }

    fn free_state(&mut self, mut state: RawState) -> Result<(), InstanceError> {
        let status = call!(mend self.free_fmu_state "fmi2FreeFMUstate"(&mut state));
        self.base.check("fmi2FreeFMUstate", status)
    }

    fn serialize(&mut self, state: RawState) -> Result<Vec<u8>, InstanceError> {
        let mut size = 0;
        let status =
            call!(self.serialized_fmu_state_size "fmi2SerializedFMUstateSize"(state, &mut size));
        self.base.check("fmi2SerializedFMUstateSize", status)?;
        let mut bytes = self.base.state_buffer(size)?;
        let status = call!(self.serialize_fmu_state "fmi2SerializeFMUstate"(
            state, bytes.as_mut_ptr().cast(), size));
        self.base.check("fmi2SerializeFMUstate", status)?;
        Ok(bytes)
    }

    fn deserialize(&mut self, bytes: &[u8]) -> Result<RawState, InstanceError> {
        let mut state: *mut c_void = ptr::null_mut();
        let status = call!(self.deserialize_fmu_state "fmi2DeSerializeFMUstate"(
            bytes.as_ptr().cast(), bytes.len(), &mut state));
        self.base.check("fmi2DeSerializeFMUstate", status)?;
        Ok(state)
    }
}

impl Steps for Component {
    fn has_event_mode(&self) -> bool {
        false
    }

    fn enter_step_mode(&mut self) -> Result<(), InstanceError> {
        Ok(())
    }

    fn do_step(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        let status = call!(self.do_step "fmi2DoStep"(time_s, step_s, i32::from(!self.restorable)));
        let mut answer = self.base.answer("fmi2DoStep", status)?;
        if answer == Answer::Pending {
            answer = self.wait()?;
        }
        if answer == Answer::Discard {
            return self.discarded(time_s);
        }
        Ok(Stepped {
            time_s: time_s + step_s,
            outcome: StepOutcome::Done,
            event: false,
            terminate: false,
        })
    }

    fn interval(&mut self, _: u32) -> Result<Interval, InstanceError> {
        Ok(Interval::Unknown)
    }

    fn activate(&mut self, _: u32) -> Result<(), InstanceError> {
        Err(InstanceError::unsupported(&self.base.name, "tick", "FMI 2.0 has no clocks"))
    }
}

impl Drop for Component {
    fn drop(&mut self) {
        if self.base.condition == Condition::Lost {
            // A lost FMU isn't called again, so that the objects it may still use have to stay.
            std::mem::forget((
                Arc::clone(&self.library),
                Arc::clone(&self.callbacks),
                Arc::clone(&self.base.log),
            ));
            return;
        }
        if let Some(free) = self.functions.free_instance {
            self.base.mark.set(function_number("fmi2FreeInstance"));
            // SAFETY: the instance is alive, and this is the last that is done with it.
            unsafe { free(self.instance) };
            // The library may be unloaded next, which runs its destructors.
            self.base.mark.set(super::call::LOADING);
        }
    }
}
