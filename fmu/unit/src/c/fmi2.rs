//! The functions of FMI 2.0.

#![allow(unsafe_code, reason = "functions of a C interface")]
#![allow(non_snake_case, reason = "names of the standard")]

use super::access::Arrays;
use super::call::{call, free, instantiate, no_instance, ok, put};
use super::instance::{Instance, InstanceOptions};
use super::log::{self, Callback, Outlet};
use super::mode::{self, Modes, Refusal, ServedStandard};
use super::types::{BooleanOf, Integer2, Real2, Type};
use core::ffi::{CStr, c_void};
use octant_fmi::fmi2::{
    Boolean, Byte, CO_SIMULATION, CallbackFunctions, Component, DISCARD, EventInfo, FALSE,
    LAST_SUCCESSFUL_TIME, OK, State, Status, String, TERMINATED, ValueReference, WARNING,
    signature,
};

const TYPES_PLATFORM: &CStr = c"default";
const VERSION: &CStr = c"2.0";
const STANDARD: ServedStandard = ServedStandard::Fmi2;

#[inline]
fn enter(
    handle: *mut c_void,
    function: &'static str,
    work: impl FnOnce(&mut Instance) -> Result<Status, Refusal>,
) -> Status {
    call(handle, STANDARD, function, work)
}

fn get<T: Type>(
    c: Component,
    function: &'static str,
    references: *const ValueReference,
    count: usize,
    values: *mut T::Value,
) -> Status {
    enter(c, function, |instance| {
        ok(instance.get::<T, false>(Arrays { references, count, values, value_count: count }))
    })
}

fn set<T: Type>(
    c: Component,
    function: &'static str,
    references: *const ValueReference,
    count: usize,
    values: *const T::Value,
) -> Status {
    enter(c, function, |instance| {
        ok(instance.set::<T, false>(Arrays { references, count, values, value_count: count }))
    })
}

/// Answers for variables of a type that no model has.
fn no_variables(
    c: Component,
    function: &'static str,
    modes: Modes,
    references: *const ValueReference,
    count: usize,
) -> Status {
    enter(c, function, |instance| {
        instance.require(modes)?;
        if count == 0 {
            return Ok(OK);
        }
        let given = if references.is_null() { "a null pointer" } else { "value references" };
        Err(Refusal::error(format!("there are no variables of type String, {given} were given")))
    })
}

export! {
    /// Returns the platform of the types: the default one.
    fn fmi2GetTypesPlatform() -> String {
        TYPES_PLATFORM.as_ptr()
    }

    /// Returns the version of the standard.
    fn fmi2GetVersion() -> String {
        VERSION.as_ptr()
    }

    /// Makes an instance of the model with this GUID; null: the log has the reason.
    fn fmi2Instantiate(
        name: String,
        kind: i32,
        guid: String,
        _resources: String,
        functions: *const CallbackFunctions,
        _visible: Boolean,
        logging: Boolean,
    ) -> Component {
        // SAFETY: null, or as the standard has it.
        let functions = (!functions.is_null()).then(|| unsafe { functions.read_unaligned() });
        let outlet = Outlet {
            name: Default::default(),
            callback: functions.and_then(|functions| functions.logger).map(Callback::Fmi2),
            environment: functions.map_or(core::ptr::null_mut(), |f| f.environment),
        };
        let function = "fmi2Instantiate";
        if kind != CO_SIMULATION {
            return no_instance(function, outlet, mode::NO_MODEL_EXCHANGE);
        }
        // SAFETY: null, or strings.
        let (name, guid) = unsafe { (log::string(name), log::string(guid)) };
        let options = InstanceOptions::default();
        instantiate(ServedStandard::Fmi2, function, name, guid, options, outlet, logging != FALSE)
    }

    /// Announces the simulation: its start, and its end if it is known.
    fn fmi2SetupExperiment(
        c: Component,
        _tolerance_defined: Boolean,
        _tolerance: f64,
        start: f64,
        stop_defined: Boolean,
        stop: f64,
    ) -> Status {
        enter(c, "fmi2SetupExperiment", |instance| {
            ok(instance.setup_experiment(start, (stop_defined != FALSE).then_some(stop)))
        })
    }

    /// Starts the initialization.
    fn fmi2EnterInitializationMode(c: Component) -> Status {
        enter(c, "fmi2EnterInitializationMode", |instance| ok(instance.enter_initialization()))
    }

    /// Gets Strings, of which there are none.
    fn fmi2GetString(
        c: Component, references: *const ValueReference, count: usize, _values: *mut String,
    ) -> Status {
        no_variables(c, "fmi2GetString", mode::get(ServedStandard::Fmi2), references, count)
    }

    /// Sets Strings, of which there are none.
    fn fmi2SetString(
        c: Component, references: *const ValueReference, count: usize, _values: *const String,
    ) -> Status {
        no_variables(c, "fmi2SetString", mode::SET, references, count)
    }

    /// Makes one communication step. Discard: none, or a part of the step was made; see
    /// [`fmi2GetRealStatus`].
    fn fmi2DoStep(c: Component, time: f64, step: f64, _no_set_prior: Boolean) -> Status {
        enter(c, "fmi2DoStep", |instance| {
            let done = instance.agree(time, step).and_then(|agreed| {
                for period in 0..agreed.periods {
                    instance.step_period(period == 0)?;
                }
                Ok(OK)
            });
            if let Err(refusal) = &done
                && refusal.status == DISCARD
            {
                instance.step_failed(refusal);
            }
            done
        })
    }

    /// Answers with Discard: there are no asynchronous steps.
    fn fmi2GetStatus(c: Component, _kind: i32, value: *mut Status) -> Status {
        no_status(c, "fmi2GetStatus", value.is_null())
    }

    /// Returns the time that the last step has reached.
    fn fmi2GetRealStatus(c: Component, kind: i32, value: *mut f64) -> Status {
        if kind != LAST_SUCCESSFUL_TIME {
            return no_status(c, "fmi2GetRealStatus", value.is_null());
        }
        enter(c, "fmi2GetRealStatus", |instance| {
            instance.require(mode::STATUS)?;
            ok(put(value, instance.time_s(), "the status"))
        })
    }

    /// Answers with Discard: there is no such status.
    fn fmi2GetIntegerStatus(c: Component, _kind: i32, value: *mut i32) -> Status {
        no_status(c, "fmi2GetIntegerStatus", value.is_null())
    }

    /// Returns whether the model wants the simulation to end: never.
    fn fmi2GetBooleanStatus(
        c: Component, kind: i32, value: *mut Boolean,
    ) -> Status {
        if kind != TERMINATED {
            return no_status(c, "fmi2GetBooleanStatus", value.is_null());
        }
        enter(c, "fmi2GetBooleanStatus", |instance| {
            instance.require(mode::STATUS)?;
            ok(put(value, FALSE, "the status"))
        })
    }

    /// Answers with Discard: no step is ever pending.
    fn fmi2GetStringStatus(
        c: Component, _kind: i32, value: *mut String,
    ) -> Status {
        no_status(c, "fmi2GetStringStatus", value.is_null())
    }
}

/// Answers for a status that isn't available: the standard requires Discard.
fn no_status(c: Component, function: &'static str, missing: bool) -> Status {
    enter(c, function, |instance| {
        instance.require(mode::STATUS)?;
        if missing {
            return Err(Refusal::error("the place for the status is a null pointer"));
        }
        Err(Refusal::discard("there is no such status: steps are never asynchronous"))
    })
}

functions_of_both! {
    fmi2FreeInstance fmi2SetDebugLogging fmi2ExitInitializationMode fmi2Terminate fmi2Reset
    fmi2GetFMUstate fmi2SetFMUstate fmi2FreeFMUstate
    fmi2SerializedFMUstateSize fmi2SerializeFMUstate fmi2DeSerializeFMUstate(Byte)
}

macro_rules! types {
    ($($type:ty, $value:ty: $get:ident $set:ident;)*) => {
        export! {$(
            /// Gets variables of the type.
            fn $get(
                c: Component, references: *const ValueReference, count: usize, values: *mut $value,
            ) -> Status {
                get::<$type>(c, stringify!($get), references, count, values)
            }

            /// Sets variables of the type.
            fn $set(
                c: Component, references: *const ValueReference, count: usize, values: *const $value,
            ) -> Status {
                set::<$type>(c, stringify!($set), references, count, values)
            }
        )*}
    };
}

types! {
    Real2, f64: fmi2GetReal fmi2SetReal;
    Integer2, i32: fmi2GetInteger fmi2SetInteger;
    BooleanOf<Boolean>, Boolean: fmi2GetBoolean fmi2SetBoolean;
}

refused! {
    mode::ALIVE, mode::NO_DERIVATIVES =>
        fmi2GetDirectionalDerivative(
            *const ValueReference, usize, *const ValueReference, usize, *const f64, *mut f64)
        fmi2SetRealInputDerivatives(*const ValueReference, usize, *const i32, *const f64)
        fmi2GetRealOutputDerivatives(*const ValueReference, usize, *const i32, *mut f64);
    mode::NEVER, "no step is under way" => fmi2CancelStep();
    mode::NEVER, mode::NO_MODEL_EXCHANGE =>
        fmi2EnterEventMode()
        fmi2NewDiscreteStates(*mut EventInfo)
        fmi2EnterContinuousTimeMode()
        fmi2CompletedIntegratorStep(Boolean, *mut Boolean, *mut Boolean)
        fmi2SetTime(f64)
        fmi2SetContinuousStates(*const f64, usize)
        fmi2GetDerivatives(*mut f64, usize)
        fmi2GetEventIndicators(*mut f64, usize)
        fmi2GetContinuousStates(*mut f64, usize)
        fmi2GetNominalsOfContinuousStates(*mut f64, usize);
}

impl Instance {
    /// Switches categories; no category: all of them. Unknown categories are reported, and
    /// otherwise ignored.
    ///
    /// # Safety
    /// `categories` has to be null, or lead to `count` strings or null pointers.
    pub(super) unsafe fn set_debug_logging(
        &mut self,
        on: bool,
        count: usize,
        categories: *const *const core::ffi::c_char,
    ) -> Result<Status, Refusal> {
        self.require(mode::LOGGING)?;
        if count == 0 {
            self.log.switch(on, None);
            return Ok(OK);
        }
        if categories.is_null() {
            return Err(Refusal::error("the categories are a null pointer"));
        }
        if count > CATEGORIES_MAX {
            return Err(Refusal::error(format!("{count} categories are more than there are")));
        }
        let mut names = Vec::new();
        for i in 0..count {
            // SAFETY: the caller's.
            let name = unsafe { log::string(categories.add(i).read_unaligned()) };
            names.push(name.ok_or_else(|| Refusal::error("a category is a null pointer"))?);
        }
        let unknown = self.log.switch(on, Some(&names));
        if unknown.is_empty() {
            return Ok(OK);
        }
        let known: Vec<_> = log::CATEGORIES.iter().map(|(name, _)| *name).collect();
        let text = format!("no categories: {}; there are {}", unknown.join(", "), known.join(", "));
        self.log.say(WARNING, text);
        Ok(WARNING)
    }
}

/// Largest number of names of categories accepted, far beyond any use.
const CATEGORIES_MAX: usize = 1024;
