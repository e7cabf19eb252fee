//! The functions of FMI 2.0.

#![allow(unsafe_code, reason = "functions of a C interface")]
#![allow(non_snake_case, reason = "names of the standard")]

use super::access::Arrays;
use super::call::{call, free, instantiate, no_instance, ok, put};
use super::instance::{Instance, Options};
use super::log::{self, Callback, Outlet};
use super::mode::{self, Modes, Refusal, ServedStandard};
use super::types::{Boolean as BooleanOf, Integer2, Real2, Type};
use core::ffi::{CStr, c_void};
use octant_fmi::fmi2::{
    Boolean, Byte, CO_SIMULATION, CallbackFunctions, Component, DISCARD, EventInfo, FALSE,
    LAST_SUCCESSFUL_TIME, OK, State, Status, String, TERMINATED, ValueReference, WARNING,
    signature,
};

const TYPES_PLATFORM: &CStr = c"default";
const VERSION: &CStr = c"2.0";

#[inline]
fn enter(
    handle: *mut c_void,
    function: &'static str,
    work: impl FnOnce(&mut Instance) -> Result<Status, Refusal>,
) -> Status {
    call(handle, ServedStandard::Fmi2, function, work)
}

/// Answers a function that is exported but that no model supports.
fn unsupported(handle: *mut c_void, function: &'static str, modes: Modes, why: &str) -> Status {
    enter(handle, function, |instance| {
        instance.require(modes)?;
        Err(Refusal::error(why))
    })
}

const NO_MODEL_EXCHANGE: &str = "there is no model exchange, only co-simulation";
const NO_DERIVATIVES: &str = "the model is sampled: its variables have no derivatives";

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
    GetTypesPlatform: fn fmi2GetTypesPlatform() -> String {
        TYPES_PLATFORM.as_ptr()
    }

    /// Returns the version of the standard.
    GetVersion: fn fmi2GetVersion() -> String {
        VERSION.as_ptr()
    }

    /// Makes an instance of the model with this GUID; null: the log has the reason.
    Instantiate: fn fmi2Instantiate(
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
            return no_instance(function, outlet, NO_MODEL_EXCHANGE);
        }
        // SAFETY: null, or strings.
        let (name, guid) = unsafe { (log::string(name), log::string(guid)) };
        let options = Options::default();
        instantiate(ServedStandard::Fmi2, function, name, guid, options, outlet, logging != FALSE)
    }

    /// Ends an instance.
    FreeInstance: fn fmi2FreeInstance(c: Component) {
        free(c, ServedStandard::Fmi2);
    }

    /// Switches categories of messages.
    SetDebugLogging: fn fmi2SetDebugLogging(
        c: Component,
        on: Boolean,
        count: usize,
        categories: *const String,
    ) -> Status {
        enter(c, "fmi2SetDebugLogging", |instance| {
            // SAFETY: null, or so many strings.
            unsafe { instance.set_debug_logging(on != FALSE, count, categories) }
        })
    }

    /// Announces the simulation: its start, and its end if it is known.
    SetupExperiment: fn fmi2SetupExperiment(
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
    EnterInitializationMode: fn fmi2EnterInitializationMode(c: Component) -> Status {
        enter(c, "fmi2EnterInitializationMode", |instance| ok(instance.enter_initialization()))
    }

    /// Ends the initialization: the model is made from its parameters.
    ExitInitializationMode: fn fmi2ExitInitializationMode(c: Component) -> Status {
        enter(c, "fmi2ExitInitializationMode", |instance| ok(instance.exit_initialization()))
    }

    /// Ends the simulation.
    Terminate: fn fmi2Terminate(c: Component) -> Status {
        enter(c, "fmi2Terminate", |instance| ok(instance.terminate()))
    }

    /// Returns to the state after instantiation.
    Reset: fn fmi2Reset(c: Component) -> Status {
        enter(c, "fmi2Reset", |instance| ok(instance.reset()))
    }

    /// Gets Reals; counts are whole numbers.
    GetReal: fn fmi2GetReal(
        c: Component, references: *const ValueReference, count: usize, values: *mut f64,
    ) -> Status {
        get::<Real2>(c, "fmi2GetReal", references, count, values)
    }

    /// Gets Integers and enumerations.
    GetInteger: fn fmi2GetInteger(
        c: Component, references: *const ValueReference, count: usize, values: *mut i32,
    ) -> Status {
        get::<Integer2>(c, "fmi2GetInteger", references, count, values)
    }

    /// Gets Booleans.
    GetBoolean: fn fmi2GetBoolean(
        c: Component, references: *const ValueReference, count: usize, values: *mut Boolean,
    ) -> Status {
        get::<BooleanOf<Boolean>>(c, "fmi2GetBoolean", references, count, values)
    }

    /// Gets Strings, of which there are none.
    GetString: fn fmi2GetString(
        c: Component, references: *const ValueReference, count: usize, _values: *mut String,
    ) -> Status {
        no_variables(c, "fmi2GetString", mode::get(ServedStandard::Fmi2), references, count)
    }

    /// Sets Reals; counts are whole numbers.
    SetReal: fn fmi2SetReal(
        c: Component, references: *const ValueReference, count: usize, values: *const f64,
    ) -> Status {
        set::<Real2>(c, "fmi2SetReal", references, count, values)
    }

    /// Sets Integers and enumerations.
    SetInteger: fn fmi2SetInteger(
        c: Component, references: *const ValueReference, count: usize, values: *const i32,
    ) -> Status {
        set::<Integer2>(c, "fmi2SetInteger", references, count, values)
    }

    /// Sets Booleans.
    SetBoolean: fn fmi2SetBoolean(
        c: Component, references: *const ValueReference, count: usize, values: *const Boolean,
    ) -> Status {
        set::<BooleanOf<Boolean>>(c, "fmi2SetBoolean", references, count, values)
    }

    /// Sets Strings, of which there are none.
    SetString: fn fmi2SetString(
        c: Component, references: *const ValueReference, count: usize, _values: *const String,
    ) -> Status {
        no_variables(c, "fmi2SetString", mode::SET, references, count)
    }

    /// Stores the state.
    GetFmuState: fn fmi2GetFMUstate(c: Component, state: *mut State) -> Status {
        enter(c, "fmi2GetFMUstate", |instance| ok(instance.get_state(state)))
    }

    /// Continues from a stored state.
    SetFmuState: fn fmi2SetFMUstate(c: Component, state: State) -> Status {
        enter(c, "fmi2SetFMUstate", |instance| ok(instance.set_state(state)))
    }

    /// Frees a stored state.
    FreeFmuState: fn fmi2FreeFMUstate(c: Component, state: *mut State) -> Status {
        enter(c, "fmi2FreeFMUstate", |instance| ok(instance.free_state(state)))
    }

    /// Returns the number of bytes of a stored state.
    SerializedFmuStateSize: fn fmi2SerializedFMUstateSize(
        c: Component, state: State, size: *mut usize,
    ) -> Status {
        enter(c, "fmi2SerializedFMUstateSize", |instance| {
            ok(put(size, instance.state_bytes(state)?.len(), "the size"))
        })
    }

    /// Writes a stored state as bytes.
    SerializeFmuState: fn fmi2SerializeFMUstate(
        c: Component, state: State, bytes: *mut Byte, size: usize,
    ) -> Status {
        enter(c, "fmi2SerializeFMUstate", |instance| {
            ok(instance.serialize_state(state, bytes.cast(), size))
        })
    }

    /// Stores a state given as bytes.
    DeserializeFmuState: fn fmi2DeSerializeFMUstate(
        c: Component, bytes: *const Byte, size: usize, state: *mut State,
    ) -> Status {
        enter(c, "fmi2DeSerializeFMUstate", |instance| {
            ok(instance.deserialize_state(bytes.cast(), size, state))
        })
    }

    /// Fails: there are no directional derivatives.
    GetDirectionalDerivative: fn fmi2GetDirectionalDerivative(
        c: Component,
        _unknowns: *const ValueReference,
        _unknown_count: usize,
        _knowns: *const ValueReference,
        _known_count: usize,
        _seed: *const f64,
        _sensitivity: *mut f64,
    ) -> Status {
        unsupported(c, "fmi2GetDirectionalDerivative", mode::ALIVE, NO_DERIVATIVES)
    }

    /// Fails: inputs are not interpolated.
    SetRealInputDerivatives: fn fmi2SetRealInputDerivatives(
        c: Component,
        _references: *const ValueReference,
        _count: usize,
        _orders: *const i32,
        _values: *const f64,
    ) -> Status {
        unsupported(c, "fmi2SetRealInputDerivatives", mode::ALIVE, NO_DERIVATIVES)
    }

    /// Fails: outputs have no derivatives.
    GetRealOutputDerivatives: fn fmi2GetRealOutputDerivatives(
        c: Component,
        _references: *const ValueReference,
        _count: usize,
        _orders: *const i32,
        _values: *mut f64,
    ) -> Status {
        unsupported(c, "fmi2GetRealOutputDerivatives", mode::ALIVE, NO_DERIVATIVES)
    }

    /// Makes one communication step. Discard: none, or a part of the step was made; see
    /// [`fmi2GetRealStatus`].
    DoStep: fn fmi2DoStep(c: Component, time: f64, step: f64, _no_set_prior: Boolean) -> Status {
        enter(c, "fmi2DoStep", |instance| {
            let done = instance.agree(time, step).and_then(|agreed| {
                for _ in 0..agreed.periods {
                    instance.step_period()?;
                }
                Ok(OK)
            });
            if done.as_ref().is_err_and(|refusal| refusal.status == DISCARD) {
                instance.step_failed();
            }
            done
        })
    }

    /// Fails: no step is ever pending.
    CancelStep: fn fmi2CancelStep(c: Component) -> Status {
        unsupported(c, "fmi2CancelStep", mode::NEVER, "no step is under way")
    }

    /// Answers with Discard: there are no asynchronous steps.
    GetStatus: fn fmi2GetStatus(c: Component, _kind: i32, value: *mut Status) -> Status {
        no_status(c, "fmi2GetStatus", value.is_null())
    }

    /// Returns the time that the last step has reached.
    GetRealStatus: fn fmi2GetRealStatus(c: Component, kind: i32, value: *mut f64) -> Status {
        if kind != LAST_SUCCESSFUL_TIME {
            return no_status(c, "fmi2GetRealStatus", value.is_null());
        }
        enter(c, "fmi2GetRealStatus", |instance| {
            instance.require(mode::STATUS)?;
            ok(put(value, instance.time_s(), "the status"))
        })
    }

    /// Answers with Discard: there is no such status.
    GetIntegerStatus: fn fmi2GetIntegerStatus(c: Component, _kind: i32, value: *mut i32) -> Status {
        no_status(c, "fmi2GetIntegerStatus", value.is_null())
    }

    /// Returns whether the model wants the simulation to end: never.
    GetBooleanStatus: fn fmi2GetBooleanStatus(
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
    GetStringStatus: fn fmi2GetStringStatus(
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

/// Functions of model exchange.
macro_rules! model_exchange {
    ($($alias:ident: fn $name:ident($($argument:ident: $kind:ty),*);)*) => {
        export! {$(
            /// Fails: there is no model exchange.
            $alias: fn $name(c: Component $(, $argument: $kind)*) -> Status {
                $(let _ = $argument;)*
                unsupported(c, stringify!($name), mode::NEVER, NO_MODEL_EXCHANGE)
            }
        )*}
    };
}

model_exchange! {
    EnterEventMode: fn fmi2EnterEventMode();
    NewDiscreteStates: fn fmi2NewDiscreteStates(info: *mut EventInfo);
    EnterContinuousTimeMode: fn fmi2EnterContinuousTimeMode();
    CompletedIntegratorStep: fn fmi2CompletedIntegratorStep(
        no_set_prior: Boolean, enter_event_mode: *mut Boolean, terminate: *mut Boolean
    );
    SetTime: fn fmi2SetTime(time: f64);
    SetContinuousStates: fn fmi2SetContinuousStates(states: *const f64, count: usize);
    GetDerivatives: fn fmi2GetDerivatives(derivatives: *mut f64, count: usize);
    GetEventIndicators: fn fmi2GetEventIndicators(indicators: *mut f64, count: usize);
    GetContinuousStates: fn fmi2GetContinuousStates(states: *mut f64, count: usize);
    GetNominalsOfContinuousStates: fn fmi2GetNominalsOfContinuousStates(
        nominals: *mut f64, count: usize
    );
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
