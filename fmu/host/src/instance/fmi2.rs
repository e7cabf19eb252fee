//! The functions of FMI 2.0.
#![allow(unsafe_code, reason = "functions of a library are called")]

use super::super::description::VariableType;
use super::super::library::{Functions, Library};
use super::call::{
    Answer, Base, Condition, NOWHERE, UNLOADING, ask, call, free_on_drop, function_number,
    functions_of_both,
};
use super::message::{Log, callbacks, text};
use super::scratch::{Scratch2, get_through, set_through};
use super::setup::{Setup, c_text};
use super::unit::{Interval, RawState, Steps, Unit};
use super::{InstanceError, StepOutcome, Stepped, Update, VariableGroup, group};
use octant_fmi::fmi2;
use std::ffi::{CString, c_char};
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
    /// True once it was said that the FMU's time contradicts the step.
    told_time: bool,
    scratch: Scratch2,
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
        if let Some(platform) = functions.fmi2GetTypesPlatform {
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
        let instantiate =
            functions.fmi2Instantiate.ok_or_else(|| base.missing("fmi2Instantiate"))?;
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
            told_time: false,
            scratch: Scratch2::default(),
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
            call!(self.fmi2GetStatus(fmi2::DO_STEP_STATUS, &mut status))?;
            match self.base.answer("fmi2DoStep", status)? {
                Answer::Pending if Instant::now() < until => {
                    std::thread::sleep(Duration::from_micros(100));
                }
                Answer::Pending => {
                    call!(self.fmi2CancelStep())?;
                    return Err(self.base.failed("fmi2DoStep", "pending beyond the time limit"));
                }
                answer => return Ok(answer),
            }
        }
    }

    /// Reads the result of a discarded step: the time reached, and whether the FMU requests the
    /// end.
    fn discarded(&mut self, time_s: f64, step_s: f64) -> Result<Stepped, InstanceError> {
        let mut reached_s = time_s;
        let mut terminated = fmi2::FALSE;
        // Both functions are optional in practice: without them the FMU is assumed to have made no
        // step and to continue.
        if self.functions.fmi2GetRealStatus.is_some() {
            let kind = fmi2::LAST_SUCCESSFUL_TIME;
            let answer = ask!(self.fmi2GetRealStatus(kind, &mut reached_s))?;
            let end_s = time_s + step_s;
            if answer != Answer::Fine {
                reached_s = time_s;
            } else if !(reached_s >= time_s && reached_s <= end_s) {
                if !self.told_time {
                    self.told_time = true;
                    self.base.note(&format!(
                        "fmi2GetRealStatus: lastSuccessfulTime is {reached_s} s after a discarded step from {time_s} s \
                         to {end_s} s"
                    ));
                }
                reached_s = time_s;
            }
        }
        if self.functions.fmi2GetBooleanStatus.is_some() {
            let kind = fmi2::TERMINATED;
            if ask!(self.fmi2GetBooleanStatus(kind, &mut terminated))? != Answer::Fine {
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

impl Unit for Component {
    functions_of_both! {
        fmi2ExitInitializationMode fmi2Terminate fmi2Reset fmi2EnterEventMode
        fmi2GetFMUstate fmi2SetFMUstate fmi2FreeFMUstate
        fmi2SerializedFMUstateSize fmi2SerializeFMUstate fmi2DeSerializeFMUstate
    }

    fn enter_initialization(
        &mut self,
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    ) -> Result<(), InstanceError> {
        call!(self.fmi2SetupExperiment(
            i32::from(tolerance.is_some()),
            tolerance.unwrap_or(0.0),
            start_s,
            i32::from(stop_s.is_some()),
            stop_s.unwrap_or(start_s),
        ))?;
        call!(self.fmi2EnterInitializationMode())
    }

    fn set(&mut self, group: &VariableGroup, values: &[f64]) -> Result<(), InstanceError> {
        group::expect_scalars(&self.base, group, values.len())?;
        match group.kind {
            VariableType::Float64 => {
                let (references, count) = (group.references.as_ptr(), group.references.len());
                call!(self.fmi2SetReal(references, count, values.as_ptr()))
            }
            VariableType::Int32 | VariableType::Enumeration => {
                set_through!(self.Integer, group, values, fmi2SetInteger)
            }
            VariableType::Boolean => set_through!(self.Boolean, group, values, fmi2SetBoolean),
            _ => Err(self.unsupported_kind(group, "set")),
        }
    }

    fn get(&mut self, group: &VariableGroup, values: &mut [f64]) -> Result<(), InstanceError> {
        group::expect_scalars(&self.base, group, values.len())?;
        match group.kind {
            VariableType::Float64 => {
                let (references, count) = (group.references.as_ptr(), group.references.len());
                call!(self.fmi2GetReal(references, count, values.as_mut_ptr()))
            }
            VariableType::Int32 | VariableType::Enumeration => {
                get_through!(self.Integer, group, values, fmi2GetInteger)
            }
            VariableType::Boolean => get_through!(self.Boolean, group, values, fmi2GetBoolean),
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
        call!(self.fmi2SetString(
            group.references.as_ptr(),
            group.references.len(),
            pointers.as_ptr()
        ))
    }

    fn get_strings(&mut self, group: &VariableGroup) -> Result<Vec<String>, InstanceError> {
        group::expect_scalars(&self.base, group, group.elements)?;
        let mut pointers = vec![ptr::null(); group.elements];
        call!(self.fmi2GetString(
            group.references.as_ptr(),
            group.references.len(),
            pointers.as_mut_ptr()
        ))?;
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

    fn update_discrete_states(&mut self) -> Result<Update, InstanceError> {
        let mut info = fmi2::EventInfo::default();
        call!(self.fmi2NewDiscreteStates(&mut info))?;
        Ok(Update {
            again: info.new_discrete_states_needed != 0,
            terminate: info.terminate_simulation != 0,
            nominals_changed: info.nominals_of_continuous_states_changed != 0,
            states_changed: info.values_of_continuous_states_changed != 0,
            next_event_time_s: (info.next_event_time_defined != 0).then_some(info.next_event_time),
        })
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
        let mut answer = ask!(self.fmi2DoStep(time_s, step_s, i32::from(!self.restorable)))?;
        if answer == Answer::Pending {
            answer = self.wait()?;
        }
        if answer == Answer::Discard {
            return self.discarded(time_s, step_s);
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

free_on_drop!(fmi2FreeInstance, library, callbacks);
