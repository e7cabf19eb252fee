//! Entry into an instance and exit from it, for every function of both standards.

#![allow(unsafe_code, reason = "pointers of the importer are written")]

use super::instance::{Instance, InstanceOptions};
use super::log::{Callback, Message, Outlet};
use super::mode::{Mode, Refusal, ServedStandard};
use super::models::{self, Maker};
use super::registry::{INSTANCES_MAX, NoInstance, Registry};
use core::ffi::c_void;
use core::panic::AssertUnwindSafe;
use octant_fmi::fmi2::{DISCARD, ERROR, FATAL, OK, Status};
use octant_fmi::fmi3::LogMessage;
use std::ffi::CString;
use std::panic::catch_unwind;

/// All instances of both standards.
static REGISTRY: Registry<Instance> = Registry::new();

/// Executes a function in its instance. A refusal is logged and answered with its status, an error
/// ends the simulation; a panic ends the instance, and nothing unwinds out of here.
#[inline]
pub(super) fn call(
    handle: *mut c_void,
    standard: ServedStandard,
    function: &'static str,
    work: impl FnOnce(&mut Instance) -> Result<Status, Refusal>,
) -> Status {
    // Messages are delivered when the instance is free again: the callback may call into it.
    let mut said = None;
    let entered = REGISTRY.with(handle, |instance| {
        if instance.standard() != standard {
            // A handle of the other standard is treated as foreign.
            return ERROR;
        }
        let status = guarded(instance, function, work);
        if !instance.log.is_silent() {
            said = Some(Box::new((instance.log.take(), instance.outlet.clone())));
        }
        status
    });
    if let Some(said) = said {
        deliver(&said.0, &said.1);
    }
    match entered {
        Ok(status) => status,
        Err(NoInstance::Unknown | NoInstance::InUse) => ERROR,
    }
}

#[cold]
fn deliver(messages: &[Message], outlet: &Outlet) {
    outlet.deliver(messages);
}

#[inline]
fn guarded(
    instance: &mut Instance,
    function: &'static str,
    work: impl FnOnce(&mut Instance) -> Result<Status, Refusal>,
) -> Status {
    match catch_unwind(AssertUnwindSafe(|| work(instance))) {
        Ok(Ok(status)) => status,
        Ok(Err(refusal)) => refused(instance, function, refusal),
        Err(panic) => died(instance, function, &*panic),
    }
}

#[cold]
fn refused(instance: &mut Instance, function: &'static str, refusal: Refusal) -> Status {
    let Refusal { status, reason, always_said } = refusal;
    if instance.mode() == Mode::Fatal {
        // A dead instance stays dead.
        return FATAL;
    }
    if status != DISCARD {
        instance.run.mode = Mode::Error;
    }
    let text = format!("{function}: {reason}");
    if always_said {
        instance.log.insist(status, text);
    } else {
        instance.log.say(status, text);
    }
    status
}

#[cold]
fn died(
    instance: &mut Instance,
    function: &'static str,
    panic: &(dyn core::any::Any + Send),
) -> Status {
    let reason = panic
        .downcast_ref::<&str>()
        .copied()
        .or_else(|| panic.downcast_ref::<String>().map(String::as_str))
        .unwrap_or("it didn't say why");
    instance.run.mode = Mode::Fatal;
    // The component may be inconsistent after the panic.
    instance.run.component = None;
    instance.log.say(FATAL, format!("{function}: the model panicked: {reason}"));
    FATAL
}

/// Makes an instance; null: the reason has been logged.
pub(super) fn instantiate(
    standard: ServedStandard,
    function: &'static str,
    name: Option<String>,
    token: Option<String>,
    options: InstanceOptions,
    mut outlet: Outlet,
    logging: bool,
) -> *mut c_void {
    let unwound = catch_unwind(AssertUnwindSafe(|| {
        let name = name.unwrap_or_default();
        outlet.name = CString::new(name.replace('\0', " ")).unwrap_or_default();
        match model(standard, &name, token) {
            Ok(maker) => insert(Instance::new(standard, maker, options, outlet.clone(), logging)),
            Err(reason) => Err(reason),
        }
        .unwrap_or_else(|reason| {
            outlet.deliver_failure(format!("{function}: {reason}"));
            core::ptr::null_mut()
        })
    }));
    unwound.unwrap_or(core::ptr::null_mut())
}

fn model(
    standard: ServedStandard,
    name: &str,
    token: Option<String>,
) -> Result<&'static Maker, String> {
    if name.trim().is_empty() {
        return Err("the instance has no name".to_owned());
    }
    let token = token.ok_or("the token of the description is a null pointer")?;
    models::find(standard, &token).ok_or_else(|| {
        format!("this library isn't the one that the description with the token {token} is of")
    })
}

/// Makes an instance of a model that the library doesn't list, and returns its handle for the functions of
/// its standard; `None`: there are too many instances. The environment goes to the callbacks.
#[must_use]
pub fn instance_of(
    maker: &'static Maker,
    standard: ServedStandard,
    options: InstanceOptions,
    callback: Option<LogMessage>,
    environment: *mut c_void,
    logging: bool,
) -> Option<*mut c_void> {
    let callback = callback.map(Callback::Fmi3);
    let outlet = Outlet { name: CString::default(), callback, environment };
    insert(Instance::new(standard, maker, options, outlet, logging)).ok()
}

/// Registers an instance and returns its handle.
pub(super) fn insert(instance: Instance) -> Result<*mut c_void, String> {
    REGISTRY
        .insert(Box::new(instance))
        .ok_or_else(|| format!("there are {INSTANCES_MAX} instances already"))
}

/// Refuses an instance of a kind that isn't supported.
pub(super) fn no_instance(function: &'static str, mut outlet: Outlet, reason: &str) -> *mut c_void {
    outlet.name = CString::default();
    outlet.deliver_failure(format!("{function}: {reason}"));
    core::ptr::null_mut()
}

/// Ends an instance; a null or foreign handle, or an instance in use, is ignored.
pub(super) fn free(handle: *mut c_void, standard: ServedStandard) {
    // A handle of the other standard is treated as foreign.
    let own = REGISTRY.with(handle, |instance| instance.standard() == standard);
    if own == Ok(true) {
        // Dropped outside of the registry; a component that panics on drop must not take the host
        // with it.
        let removed = REGISTRY.remove(handle);
        let _ = catch_unwind(AssertUnwindSafe(move || drop(removed)));
    }
}

/// Turns the result of work without a status of its own into OK.
#[inline]
pub(super) fn ok(result: Result<(), Refusal>) -> Result<Status, Refusal> {
    result.map(|()| OK)
}

/// Writes a result to the importer's pointer; `what` names the pointer if it is null.
#[inline]
pub(super) fn put<T>(to: *mut T, value: T, what: &str) -> Result<(), Refusal> {
    if to.is_null() {
        return Err(Refusal::error(format!("the place for {what} is a null pointer")));
    }
    // SAFETY: it isn't null, and the importer vouches for the rest.
    unsafe { to.write_unaligned(value) };
    Ok(())
}
