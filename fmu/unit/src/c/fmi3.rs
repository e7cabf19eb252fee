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
use super::instance::InstanceOptions;
use super::log::{self, Callback, Outlet};
use super::mode::{self, Mode, Refusal, ServedStandard};
use core::ffi::{CStr, c_void};
use entry::enter;
use octant_fmi::fmi3::{
    Boolean, ClockUpdate, DependencyKind, Environment, FALSE, Instance as Handle,
    IntermediateUpdate, LogMessage, OK, Preemption, State, Status, String, TRUE, ValueReference,
    signature,
};
use step::{Places, do_step};

const VERSION: &CStr = c"3.0";
const STANDARD: ServedStandard = ServedStandard::Fmi3;

/// `fmi3Dependent`: the kind of all dependencies.
const DEPENDENT: DependencyKind = 5;

fn outlet(environment: Environment, log: Option<LogMessage>) -> Outlet {
    Outlet { name: Default::default(), callback: log.map(Callback::Fmi3), environment }
}

export! {
    /// Returns the version of the standard.
    fn fmi3GetVersion() -> String {
        VERSION.as_ptr()
    }

    /// Fails: there is no model exchange.
    fn fmi3InstantiateModelExchange(
        _name: String,
        _token: String,
        _resources: String,
        _visible: Boolean,
        _logging: Boolean,
        environment: Environment,
        log: Option<LogMessage>,
    ) -> Handle {
        let function = "fmi3InstantiateModelExchange";
        no_instance(function, outlet(environment, log), mode::NO_MODEL_EXCHANGE)
    }

    /// Makes an instance of the model with this token; null: the log has the reason.
    fn fmi3InstantiateCoSimulation(
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
        let options = InstanceOptions {
            event_mode_used: event_mode_used != FALSE,
            early_return_allowed: early_return_allowed != FALSE,
            intermediate_update,
        };
        instantiate(ServedStandard::Fmi3, function, name, token, options, outlet, logging != FALSE)
    }

    /// Fails: there is no scheduled execution.
    fn fmi3InstantiateScheduledExecution(
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

    /// Starts the initialization.
    fn fmi3EnterInitializationMode(
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

    /// Changes from Step Mode to Event Mode.
    fn fmi3EnterEventMode(i: Handle) -> Status {
        enter(i, "fmi3EnterEventMode", |instance| {
            instance.require(mode::STEP)?;
            if !instance.options.event_mode_used {
                return Err(Refusal::error("the instance was made without event mode"));
            }
            instance.run.mode = Mode::Event;
            Ok(OK)
        })
    }

    /// Changes from Event Mode to Step Mode.
    fn fmi3EnterStepMode(i: Handle) -> Status {
        enter(i, "fmi3EnterStepMode", |instance| {
            instance.require(mode::EVENT)?;
            instance.end_ticks()?;
            instance.run.mode = Mode::Step;
            Ok(OK)
        })
    }

    /// Returns the number of variables on which a variable depends.
    fn fmi3GetNumberOfVariableDependencies(
        i: Handle, reference: ValueReference, count: *mut usize,
    ) -> Status {
        enter(i, "fmi3GetNumberOfVariableDependencies", |instance| {
            instance.require(mode::ALIVE)?;
            ok(put(count, instance.dependencies(reference)?.len(), "the number"))
        })
    }

    /// Returns the variables on which a variable depends, all elements on all elements.
    fn fmi3GetVariableDependencies(
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
            Ok(OK)
        })
    }

    /// Does nothing: no discrete state is evaluated before the update.
    fn fmi3EvaluateDiscreteStates(i: Handle) -> Status {
        enter(i, "fmi3EvaluateDiscreteStates", |instance| ok(instance.require(mode::EVENT)))
    }

    /// Ends an event: the data of the clocks that ticked is taken, and the next event is the next
    /// sample.
    fn fmi3UpdateDiscreteStates(
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
    fn fmi3DoStep(
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

functions_of_both! {
    fmi3FreeInstance fmi3SetDebugLogging fmi3ExitInitializationMode fmi3Terminate fmi3Reset
    fmi3GetFMUState fmi3SetFMUState fmi3FreeFMUState
    fmi3SerializedFMUStateSize fmi3SerializeFMUState fmi3DeserializeFMUState(u8)
}
