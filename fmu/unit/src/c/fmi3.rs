//! The functions of FMI 3.0.

#![allow(unsafe_code, reason = "functions of a C interface")]
#![allow(non_snake_case, reason = "names of the standard")]

mod clocked;
mod entry;
mod step;
mod types;
mod unsupported;

pub use clocked::*;
pub use types::*;
pub use unsupported::*;

use super::call::{free, instantiate, no_instance, ok, put};
use super::instance::Options;
use super::log::{self, Callback, Outlet};
use super::mode::{self, Mode, Refusal, ServedStandard};
use core::ffi::CStr;
use entry::{FALSE, TRUE, enter};
use octant_fmi::fmi3::{
    Boolean, ClockUpdate, DependencyKind, Environment, Instance as Handle, IntermediateUpdate,
    LogMessage, Preemption, State, Status, String, ValueReference, signature,
};
use step::{Places, do_step};

const VERSION: &CStr = c"3.0";

/// `fmi3Dependent`: the kind of all dependencies.
const DEPENDENT: DependencyKind = 5;

fn outlet(environment: Environment, log: Option<LogMessage>) -> Outlet {
    Outlet { name: Default::default(), callback: log.map(Callback::Fmi3), environment }
}

export! {
    /// Returns the version of the standard.
    GetVersion: fn fmi3GetVersion() -> String {
        VERSION.as_ptr()
    }

    /// Fails: there is no model exchange.
    InstantiateModelExchange: fn fmi3InstantiateModelExchange(
        _name: String,
        _token: String,
        _resources: String,
        _visible: Boolean,
        _logging: Boolean,
        environment: Environment,
        log: Option<LogMessage>,
    ) -> Handle {
        let reason = "there is no model exchange, only co-simulation";
        no_instance("fmi3InstantiateModelExchange", outlet(environment, log), reason)
    }

    /// Makes an instance of the model with this token; null: the log has the reason.
    InstantiateCoSimulation: fn fmi3InstantiateCoSimulation(
        name: String,
        token: String,
        _resources: String,
        _visible: Boolean,
        logging: Boolean,
        event_mode_used: Boolean,
        early_return_allowed: Boolean,
        _required: *const ValueReference,
        required_count: usize,
        environment: Environment,
        log: Option<LogMessage>,
        intermediate_update: Option<IntermediateUpdate>,
    ) -> Handle {
        let function = "fmi3InstantiateCoSimulation";
        let outlet = outlet(environment, log);
        if required_count > 0 {
            let reason = "variables are required in intermediate updates, none is available there";
            return no_instance(function, outlet, reason);
        }
        // SAFETY: null, or strings.
        let (name, token) = unsafe { (log::string(name), log::string(token)) };
        let options = Options {
            event_mode_used: event_mode_used != FALSE,
            early_return_allowed: early_return_allowed != FALSE,
            intermediate_update,
        };
        instantiate(ServedStandard::Fmi3, function, name, token, options, outlet, logging != FALSE)
    }

    /// Fails: there is no scheduled execution.
    InstantiateScheduledExecution: fn fmi3InstantiateScheduledExecution(
        _name: String,
        _token: String,
        _resources: String,
        _visible: Boolean,
        _logging: Boolean,
        environment: Environment,
        log: Option<LogMessage>,
        _clock_update: Option<ClockUpdate>,
        _lock: Option<Preemption>,
        _unlock: Option<Preemption>,
    ) -> Handle {
        let reason = "there is no scheduled execution, only co-simulation";
        no_instance("fmi3InstantiateScheduledExecution", outlet(environment, log), reason)
    }

    /// Ends an instance.
    FreeInstance: fn fmi3FreeInstance(i: Handle) {
        free(i, ServedStandard::Fmi3);
    }

    /// Switches categories of messages.
    SetDebugLogging: fn fmi3SetDebugLogging(
        i: Handle, on: Boolean, count: usize, categories: *const String,
    ) -> Status {
        enter(i, "fmi3SetDebugLogging", |instance| {
            // SAFETY: null, or so many strings.
            unsafe { instance.set_debug_logging(on != FALSE, count, categories) }
        })
    }

    /// Starts the initialization.
    EnterInitializationMode: fn fmi3EnterInitializationMode(
        i: Handle,
        _tolerance_defined: Boolean,
        _tolerance: f64,
        start: f64,
        stop_defined: Boolean,
        stop: f64,
    ) -> Status {
        enter(i, "fmi3EnterInitializationMode", |instance| {
            instance.setup_experiment(start, (stop_defined != FALSE).then_some(stop))?;
            ok(instance.enter_initialization())
        })
    }

    /// Ends the initialization: the model is made from its parameters.
    ExitInitializationMode: fn fmi3ExitInitializationMode(i: Handle) -> Status {
        enter(i, "fmi3ExitInitializationMode", |instance| ok(instance.exit_initialization()))
    }

    /// Changes from Step Mode to Event Mode.
    EnterEventMode: fn fmi3EnterEventMode(i: Handle) -> Status {
        enter(i, "fmi3EnterEventMode", |instance| {
            instance.require(mode::STEP)?;
            if !instance.options.event_mode_used {
                return Err(Refusal::error("the instance was made without event mode"));
            }
            instance.run.mode = Mode::Event;
            Ok(octant_fmi::fmi3::OK)
        })
    }

    /// Changes from Event Mode to Step Mode.
    EnterStepMode: fn fmi3EnterStepMode(i: Handle) -> Status {
        enter(i, "fmi3EnterStepMode", |instance| {
            instance.require(mode::EVENT)?;
            instance.end_ticks()?;
            instance.run.mode = Mode::Step;
            Ok(octant_fmi::fmi3::OK)
        })
    }

    /// Ends the simulation.
    Terminate: fn fmi3Terminate(i: Handle) -> Status {
        enter(i, "fmi3Terminate", |instance| ok(instance.terminate()))
    }

    /// Returns to the state after instantiation.
    Reset: fn fmi3Reset(i: Handle) -> Status {
        enter(i, "fmi3Reset", |instance| ok(instance.reset()))
    }

    /// Stores the state.
    GetFmuState: fn fmi3GetFMUState(i: Handle, state: *mut State) -> Status {
        enter(i, "fmi3GetFMUState", |instance| ok(instance.get_state(state)))
    }

    /// Continues from a stored state.
    SetFmuState: fn fmi3SetFMUState(i: Handle, state: State) -> Status {
        enter(i, "fmi3SetFMUState", |instance| ok(instance.set_state(state)))
    }

    /// Frees a stored state.
    FreeFmuState: fn fmi3FreeFMUState(i: Handle, state: *mut State) -> Status {
        enter(i, "fmi3FreeFMUState", |instance| ok(instance.free_state(state)))
    }

    /// Returns the number of bytes of a stored state.
    SerializedFmuStateSize: fn fmi3SerializedFMUStateSize(
        i: Handle, state: State, size: *mut usize,
    ) -> Status {
        enter(i, "fmi3SerializedFMUStateSize", |instance| {
            ok(put(size, instance.state_bytes(state)?.len(), "the size"))
        })
    }

    /// Writes a stored state as bytes.
    SerializeFmuState: fn fmi3SerializeFMUState(
        i: Handle, state: State, bytes: *mut u8, size: usize,
    ) -> Status {
        enter(i, "fmi3SerializeFMUState", |instance| {
            ok(instance.serialize_state(state, bytes, size))
        })
    }

    /// Stores a state given as bytes.
    DeserializeFmuState: fn fmi3DeserializeFMUState(
        i: Handle, bytes: *const u8, size: usize, state: *mut State,
    ) -> Status {
        enter(i, "fmi3DeserializeFMUState", |instance| {
            ok(instance.deserialize_state(bytes, size, state))
        })
    }

    /// Returns the number of variables on which a variable depends.
    GetNumberOfVariableDependencies: fn fmi3GetNumberOfVariableDependencies(
        i: Handle, reference: ValueReference, count: *mut usize,
    ) -> Status {
        enter(i, "fmi3GetNumberOfVariableDependencies", |instance| {
            instance.require(mode::ALIVE)?;
            ok(put(count, instance.dependencies(reference)?.len(), "the number"))
        })
    }

    /// Returns the variables on which a variable depends, all elements on all elements.
    GetVariableDependencies: fn fmi3GetVariableDependencies(
        i: Handle,
        dependent: ValueReference,
        dependent_elements: *mut usize,
        independents: *mut ValueReference,
        independent_elements: *mut usize,
        kinds: *mut DependencyKind,
        count: usize,
    ) -> Status {
        enter(i, "fmi3GetVariableDependencies", |instance| {
            instance.require(mode::ALIVE)?;
            let found = instance.dependencies(dependent)?;
            if found.len() != count {
                let expected = found.len();
                return Err(Refusal::error(format!(
                    "there is room for {count} dependencies, there are {expected}"
                )));
            }
            for (k, reference) in found.into_iter().enumerate() {
                put(dependent_elements.wrapping_add(k), 0, "the elements")?;
                put(independents.wrapping_add(k), reference, "the independents")?;
                put(independent_elements.wrapping_add(k), 0, "the elements")?;
                put(kinds.wrapping_add(k), DEPENDENT, "the kinds")?;
            }
            Ok(octant_fmi::fmi3::OK)
        })
    }

    /// Does nothing: no discrete state is evaluated before the update.
    EvaluateDiscreteStates: fn fmi3EvaluateDiscreteStates(i: Handle) -> Status {
        enter(i, "fmi3EvaluateDiscreteStates", |instance| ok(instance.require(mode::EVENT)))
    }

    /// Ends an event: the data of the clocks that ticked is taken, and the next event is the next
    /// sample.
    UpdateDiscreteStates: fn fmi3UpdateDiscreteStates(
        i: Handle,
        need_update: *mut Boolean,
        terminate: *mut Boolean,
        nominals_changed: *mut Boolean,
        states_changed: *mut Boolean,
        next_event_time_defined: *mut Boolean,
        next_event_time: *mut f64,
    ) -> Status {
        enter(i, "fmi3UpdateDiscreteStates", |instance| {
            instance.require(mode::EVENT)?;
            for (flag, what) in [
                (need_update, "discreteStatesNeedUpdate"),
                (terminate, "terminateSimulation"),
                (nominals_changed, "nominalsOfContinuousStatesChanged"),
                (states_changed, "valuesOfContinuousStatesChanged"),
            ] {
                put(flag, FALSE, what)?;
            }
            let next_s = instance.next_event_s();
            let defined = if next_s.is_some() { TRUE } else { FALSE };
            put(next_event_time_defined, defined, "nextEventTimeDefined")?;
            put(next_event_time, next_s.unwrap_or_default(), "nextEventTime")?;
            ok(instance.end_ticks())
        })
    }

    /// Makes one communication step. Discard: no part of it was made.
    DoStep: fn fmi3DoStep(
        i: Handle,
        time: f64,
        step: f64,
        _no_set_prior: Boolean,
        event_handling_needed: *mut Boolean,
        terminate: *mut Boolean,
        early_return: *mut Boolean,
        last_successful_time: *mut f64,
    ) -> Status {
        let places = Places { event_handling_needed, terminate, early_return, last_successful_time };
        do_step(i, time, step, &places)
    }
}
