//! The interface with a model that panics, fails and makes several periods on demand.
#![allow(unsafe_code, reason = "C functions are called")]

mod counter;

use core::ffi::{CStr, c_char, c_void};
use core::ptr::{from_mut, null, null_mut};
use counter::*;
use octant_fmi::fmi2::{DISCARD, ERROR, FATAL, OK, WARNING};
use octant_fmi::fmi3::{IntermediateUpdate, LogMessage};
use octant_fmu::c::fmi2::*;
use octant_fmu::c::fmi3::*;
use octant_fmu::c::{InstanceOptions, ServedStandard, instance_of};
use std::sync::Mutex;

/// Messages as (status, category, text).
type Heard = Mutex<Vec<(i32, String, String)>>;

unsafe extern "C" fn hear(
    environment: *mut c_void,
    status: i32,
    category: *const c_char,
    text: *const c_char,
) {
    // SAFETY: the environment is the list that the instance was made with, and strings are strings.
    let (heard, category, text) =
        unsafe { (&*environment.cast::<Heard>(), CStr::from_ptr(category), CStr::from_ptr(text)) };
    let owned = |text: &CStr| text.to_string_lossy().into_owned();
    heard.lock().unwrap().push((status, owned(category), owned(text)));
}

fn new(
    standard: ServedStandard,
    options: InstanceOptions,
    environment: *mut c_void,
) -> *mut c_void {
    let callback = Some(hear as LogMessage).filter(|_| !environment.is_null());
    instance_of(&MAKER, standard, options, callback, environment, true).unwrap()
}

fn environment(heard: &Heard) -> *mut c_void {
    core::ptr::from_ref(heard).cast_mut().cast()
}

fn stepping2() -> *mut c_void {
    let c = new(ServedStandard::Fmi2, InstanceOptions::default(), null_mut());
    // SAFETY: a handle and no pointers.
    unsafe {
        assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(fmi2EnterInitializationMode(c), OK);
        assert_eq!(fmi2ExitInitializationMode(c), OK);
    }
    c
}

fn stepping3(options: InstanceOptions, environment: *mut c_void) -> *mut c_void {
    let i = new(ServedStandard::Fmi3, options, environment);
    // SAFETY: a handle and no pointers.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(i, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(fmi3ExitInitializationMode(i), OK);
        if options.event_mode_used {
            assert_eq!(fmi3EnterStepMode(i), OK);
        }
    }
    i
}

fn real(c: *mut c_void, slot: usize) -> f64 {
    let mut value = f64::NAN;
    // SAFETY: one reference, one value.
    unsafe { assert_eq!(fmi2GetReal(c, &(slot as u32), 1, &mut value), OK) };
    value
}

fn set_trouble(c: *mut c_void, value: i32) {
    // SAFETY: one reference, one value.
    unsafe { assert_eq!(fmi2SetInteger(c, &(TROUBLE as u32), 1, &value), OK) };
}

/// Makes a step; returns status, eventHandlingNeeded, earlyReturn, lastSuccessfulTime.
fn step3(i: *mut c_void, time_s: f64, step_s: f64) -> (i32, u8, u8, f64) {
    let (mut event, mut terminate, mut early, mut last_s) = (9, 9, 9, f64::NAN);
    // SAFETY: a handle and places.
    let status = unsafe {
        fmi3DoStep(i, time_s, step_s, 0, &mut event, &mut terminate, &mut early, &mut last_s)
    };
    if status == OK || status == WARNING {
        assert_eq!(terminate, 0);
    }
    (status, event, early, last_s)
}

fn set_trouble3(i: *mut c_void, value: i32) {
    // SAFETY: one reference, one value.
    unsafe { assert_eq!(fmi3SetInt32(i, &(TROUBLE as u32), 1, &value, 1), OK) };
}

#[test]
fn a_panic_ends_its_instance_alone() {
    let heard = Heard::default();
    let i = stepping3(InstanceOptions::default(), environment(&heard));
    let other = stepping3(InstanceOptions::default(), null_mut());
    set_trouble3(i, 1);
    assert_eq!(step3(i, 0.0, PERIOD_S).0, FATAL);
    let messages = std::mem::take(&mut *heard.lock().unwrap());
    let text = "fmi3DoStep: the model panicked: trouble was asked for".to_owned();
    assert_eq!(messages, [(FATAL, "logStatusFatal".to_owned(), text)]);
    // SAFETY: handles and null pointers.
    unsafe {
        assert_eq!(fmi3Reset(i), FATAL);
        assert_eq!(fmi3SetDebugLogging(i, 1, 0, null()), FATAL);
        assert_eq!(fmi3GetFloat64(i, null(), 0, null_mut(), 0), FATAL);
        assert_eq!(step3(i, 0.0, PERIOD_S).0, FATAL);
        assert_eq!(step3(other, 0.0, PERIOD_S), (OK, 0, 0, PERIOD_S));
        fmi3FreeInstance(i);
        assert_eq!(fmi3Reset(i), ERROR);
        fmi3FreeInstance(other);
    }
}

#[test]
fn a_panic_at_the_end_is_fatal_too() {
    let c = stepping2();
    set_trouble(c, 4);
    // SAFETY: a handle.
    unsafe {
        assert_eq!(fmi2Terminate(c), FATAL);
        fmi2FreeInstance(c);
    }
}

#[test]
fn a_step_of_several_periods_is_as_good_as_several_steps() {
    let (one, many) = (stepping2(), stepping2());
    // SAFETY: handles, one reference, one value.
    unsafe {
        for c in [one, many] {
            assert_eq!(fmi2SetReal(c, &(U as u32), 1, &0.1), OK);
        }
        assert_eq!(fmi2DoStep(many, 0.0, 4.0 * PERIOD_S, 0), OK);
        for k in 0..4 {
            assert_eq!(fmi2DoStep(one, f64::from(k) * PERIOD_S, PERIOD_S, 0), OK);
        }
        for slot in [0, Y, COUNT] {
            assert_eq!(real(one, slot).to_bits(), real(many, slot).to_bits());
        }
        // Neither five periods nor two and a half.
        for periods in [5.0, 2.5] {
            assert_eq!(fmi2DoStep(many, 0.04, periods * PERIOD_S, 0), DISCARD);
            // After a discarded step only a stored state or a reset leads on; there is no stored
            // state.
            assert_eq!(fmi2DoStep(many, 0.04, PERIOD_S, 0), ERROR);
            assert_eq!(fmi2Reset(many), OK);
            assert_eq!(fmi2SetupExperiment(many, 0, 0.0, 0.04, 0, 0.0), OK);
            assert_eq!(fmi2EnterInitializationMode(many), OK);
            assert_eq!(fmi2ExitInitializationMode(many), OK);
        }
        fmi2FreeInstance(one);
        fmi2FreeInstance(many);
    }
}

#[test]
fn a_discarded_step_says_how_far_it_came() {
    let c = stepping2();
    let mut state = null_mut();
    set_trouble(c, 3);
    // SAFETY: handles and places.
    unsafe {
        assert_eq!(fmi2GetFMUstate(c, &mut state), OK);
        assert_eq!(fmi2DoStep(c, 0.0, 4.0 * PERIOD_S, 0), DISCARD);
        let (mut reached_s, mut ended) = (f64::NAN, 9);
        let last = octant_fmi::fmi2::LAST_SUCCESSFUL_TIME;
        assert_eq!(fmi2GetRealStatus(c, last, &mut reached_s), OK);
        assert_eq!(reached_s, PERIOD_S);
        assert_eq!(fmi2GetBooleanStatus(c, octant_fmi::fmi2::TERMINATED, &mut ended), OK);
        assert_eq!(ended, 0);
        assert_eq!(real(c, COUNT), 1.0);
        // Continues from the stored state with other inputs.
        assert_eq!(fmi2SetFMUstate(c, state), OK);
        assert_eq!(real(c, COUNT), 0.0);
        set_trouble(c, 0);
        assert_eq!(fmi2DoStep(c, 0.0, 4.0 * PERIOD_S, 0), OK);
        assert_eq!(real(c, COUNT), 4.0);
        fmi2FreeInstance(c);
    }
}

#[test]
fn fmi_3_discards_what_was_not_begun_and_returns_early_from_what_was() {
    let heard = Heard::default();
    let i = stepping3(InstanceOptions::default(), environment(&heard));
    set_trouble3(i, 2);
    assert_eq!(step3(i, 0.0, 4.0 * PERIOD_S).0, DISCARD);
    // The instance is unchanged: another step can be tried.
    set_trouble3(i, 0);
    assert_eq!(step3(i, 0.0, 4.0 * PERIOD_S), (OK, 0, 0, 4.0 * PERIOD_S));
    set_trouble3(i, 3);
    assert_eq!(step3(i, 0.04, 4.0 * PERIOD_S).0, ERROR, "one period was done");
    let options = InstanceOptions { early_return_allowed: true, ..InstanceOptions::default() };
    let early = stepping3(options, environment(&heard));
    set_trouble3(early, 3);
    assert_eq!(step3(early, 0.0, 4.0 * PERIOD_S), (WARNING, 0, 1, PERIOD_S));
    let texts: Vec<_> = heard.lock().unwrap().iter().map(|(.., text)| text.clone()).collect();
    assert_eq!(
        texts,
        [
            "fmi3DoStep: trouble is 2",
            "fmi3DoStep: trouble is 3",
            "fmi3DoStep: returned early: trouble is 3"
        ]
    );
    // SAFETY: handles.
    unsafe {
        fmi3FreeInstance(i);
        fmi3FreeInstance(early);
    }
}

/// Instructions for a callback between the periods, and its record.
struct Between {
    instance: *mut c_void,
    act: fn(*mut c_void),
    early_at_s: Option<f64>,
    times_s: Vec<f64>,
}

unsafe extern "C" fn between(
    environment: *mut c_void,
    time_s: f64,
    set_requested: u8,
    get_allowed: u8,
    finished: u8,
    can_return_early: u8,
    early: *mut u8,
    early_s: *mut f64,
) {
    // SAFETY: the environment is what the instance was made with.
    let this = unsafe { &mut *environment.cast::<Between>() };
    assert_eq!((set_requested, get_allowed, finished, can_return_early), (0, 0, 1, 1));
    this.times_s.push(time_s);
    (this.act)(this.instance);
    if let Some(wanted_s) = this.early_at_s {
        // SAFETY: places of the caller.
        unsafe {
            *early = 1;
            *early_s = wanted_s;
        }
    }
}

fn with_callback(between_periods: &mut Between) -> *mut c_void {
    let options = InstanceOptions {
        early_return_allowed: true,
        intermediate_update: Some(between as IntermediateUpdate),
        event_mode_used: false,
    };
    let environment = from_mut(between_periods).cast();
    let i = instance_of(&MAKER, ServedStandard::Fmi3, options, None, environment, false).unwrap();
    between_periods.instance = i;
    // SAFETY: a handle.
    unsafe {
        assert_eq!(fmi3EnterInitializationMode(i, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(fmi3ExitInitializationMode(i), OK);
    }
    i
}

#[test]
fn the_importer_is_asked_between_periods() {
    let quiet =
        Between { instance: null_mut(), act: |_| (), early_at_s: None, times_s: Vec::new() };
    let mut seen = Between { ..quiet };
    let i = with_callback(&mut seen);
    assert_eq!(step3(i, 0.0, 4.0 * PERIOD_S), (OK, 0, 0, 4.0 * PERIOD_S));
    assert_eq!(seen.times_s, [0.01, 0.02, 0.03]);
    // Early returns, at once and a period later.
    for (wanted_s, reached_s) in [(0.0, 0.05), (0.05, 0.05), (0.06, 0.06), (1.0, 0.08)] {
        let mut state = null_mut();
        seen.early_at_s = Some(wanted_s);
        // SAFETY: handles and places.
        unsafe { assert_eq!(fmi3GetFMUState(i, &mut state), OK) };
        let (status, _, early, last_s) = step3(i, 0.04, 4.0 * PERIOD_S);
        assert_eq!((status, early), (OK, u8::from(reached_s < 0.08)), "{wanted_s}");
        assert!((last_s - reached_s).abs() < 1e-12, "{wanted_s}: {last_s}");
        // SAFETY: handles.
        unsafe { assert_eq!(fmi3SetFMUState(i, state), OK) };
    }
    // SAFETY: a handle.
    unsafe { fmi3FreeInstance(i) };
}

#[test]
fn a_callback_that_does_what_it_must_not_ends_the_step() {
    let get: fn(*mut c_void) = |i| {
        let mut value = 0.0;
        // SAFETY: one reference, one value.
        unsafe { assert_eq!(fmi3GetFloat64(i, &(Y as u32), 1, &mut value, 1), ERROR) };
    };
    let step: fn(*mut c_void) = |i| assert_eq!(step3(i, 0.01, PERIOD_S).0, ERROR);
    // SAFETY: a handle.
    let reset: fn(*mut c_void) = |i| unsafe { assert_eq!(fmi3Reset(i), ERROR) };
    // SAFETY: a handle.
    let free: fn(*mut c_void) = |i| unsafe { fmi3FreeInstance(i) };
    for act in [get, step, reset, free] {
        let mut seen = Between { instance: null_mut(), act, early_at_s: None, times_s: Vec::new() };
        let i = with_callback(&mut seen);
        assert_eq!(step3(i, 0.0, 4.0 * PERIOD_S).0, ERROR);
        assert_eq!(seen.times_s.len(), 1);
        // SAFETY: a handle.
        unsafe { fmi3FreeInstance(i) };
    }
}

#[test]
fn outputs_that_change_are_events_where_the_importer_handles_them() {
    let options = InstanceOptions { event_mode_used: true, ..InstanceOptions::default() };
    let i = stepping3(options, null_mut());
    assert_eq!(step3(i, 0.0, PERIOD_S), (OK, 1, 0, PERIOD_S));
    let (mut flags, mut next_s) = ([9u8; 5], f64::NAN);
    // SAFETY: handles and places.
    unsafe {
        assert_eq!(fmi3EnterEventMode(i), OK);
        assert_eq!(fmi3EnterEventMode(i), ERROR, "it is there already");
        assert_eq!(fmi3Reset(i), OK);
        fmi3FreeInstance(i);
        let i = stepping3(InstanceOptions { early_return_allowed: true, ..options }, null_mut());
        // An event in the first of four periods ends the step.
        assert_eq!(step3(i, 0.0, 4.0 * PERIOD_S), (OK, 1, 1, PERIOD_S));
        assert_eq!(fmi3EnterEventMode(i), OK);
        let [need, terminate, nominals, states, defined] = flags.each_mut();
        let update = fmi3UpdateDiscreteStates;
        assert_eq!(update(i, need, terminate, nominals, states, defined, &mut next_s), OK);
        assert_eq!((flags, next_s), ([0, 0, 0, 0, 1], 2.0 * PERIOD_S));
        assert_eq!(fmi3EvaluateDiscreteStates(i), OK);
        assert_eq!(fmi3SetFloat64(i, &(U as u32), 1, [1.0, 2.0].as_ptr(), 2), OK);
        assert_eq!(step3(i, 0.01, PERIOD_S).0, ERROR, "not in event mode");
        fmi3FreeInstance(i);
        let without = stepping3(InstanceOptions::default(), null_mut());
        assert_eq!(fmi3EnterEventMode(without), ERROR);
        fmi3FreeInstance(without);
    }
}

#[test]
fn what_can_be_set_depends_on_the_variable_and_on_the_time() {
    let c = stepping2();
    // SAFETY: one reference, one value each.
    unsafe {
        assert_eq!(fmi2SetReal(c, &(GAIN as u32), 1, &3.0), OK, "tunable");
        let references = [U as u32, GAIN as u32];
        assert_eq!(fmi2SetReal(c, references.as_ptr(), 2, [5.0, 13.0].as_ptr()), DISCARD);
        assert_eq!((real(c, U), real(c, GAIN)), (0.0, 3.0), "all or nothing");
        assert_eq!(fmi2SetReal(c, &(ANYTHING as u32), 1, &f64::NAN), OK);
        assert_eq!(fmi2SetReal(c, &(U as u32), 1, &f64::INFINITY), DISCARD);
        assert_eq!(real(c, U), 0.0);
        assert_eq!(fmi2SetInteger(c, &(LEVEL_SLOT as u32), 1, &3), DISCARD, "between two items");
        assert_eq!(fmi2SetInteger(c, &(LEVEL_SLOT as u32), 1, &5), OK);
        assert_eq!(fmi2SetInteger(c, &(TROUBLE as u32), 1, &10), DISCARD);
        assert_eq!(fmi2SetBoolean(c, &(ON as u32), 1, &2), DISCARD);
        assert_eq!(fmi2SetBoolean(c, &(ON as u32), 1, &1), OK);
        // All or nothing.
        let references = [U as u32, U as u32 + 1];
        assert_eq!(fmi2SetReal(c, references.as_ptr(), 2, [5.0, f64::NAN].as_ptr()), DISCARD);
        assert_eq!(real(c, U), 0.0);
        for (slot, why) in [(LIMIT, "fixed"), (Y, "an output"), (0, "time")] {
            assert_eq!(fmi2SetReal(c, &(slot as u32), 1, &1.0), ERROR, "{why}");
            assert_eq!(fmi2Reset(c), OK);
            assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0), OK);
            assert_eq!(fmi2EnterInitializationMode(c), OK);
            for (value, status) in [(2.5, DISCARD), (0.0, DISCARD), (-1.0, DISCARD), (7.0, OK)] {
                assert_eq!(fmi2SetReal(c, &(LIMIT as u32), 1, &value), status, "{value}");
            }
            assert_eq!(real(c, LIMIT), 7.0);
            assert_eq!(fmi2ExitInitializationMode(c), OK);
        }
        fmi2FreeInstance(c);
    }
}

#[test]
fn outputs_of_the_initialization_follow_from_the_parameters() {
    let c = new(ServedStandard::Fmi2, InstanceOptions::default(), null_mut());
    let mut value = f64::NAN;
    // SAFETY: one reference, one value each.
    unsafe {
        assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(fmi2EnterInitializationMode(c), OK);
        assert_eq!(real(c, Y), -1.0);
        assert_eq!(fmi2SetReal(c, &(LIMIT as u32), 1, &13.0), OK);
        assert_eq!(real(c, LIMIT), 13.0, "a parameter needs no model");
        assert_eq!(fmi2GetReal(c, &(Y as u32), 1, &mut value), ERROR);
        assert_eq!(fmi2ExitInitializationMode(c), ERROR);
        // Second attempt.
        assert_eq!(fmi2Reset(c), OK);
        assert_eq!(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0), OK);
        assert_eq!(fmi2EnterInitializationMode(c), OK);
        assert_eq!(fmi2ExitInitializationMode(c), OK);
        assert_eq!(fmi2Terminate(c), OK);
        assert_eq!(real(c, Y), 1000.0, "what only the end brings");
        fmi2FreeInstance(c);
    }
}

#[test]
fn dependencies_are_those_of_the_table() {
    let i = new(ServedStandard::Fmi3, InstanceOptions::default(), null_mut());
    let count = |slot: usize| {
        let mut count = 99;
        // SAFETY: a place.
        let status = unsafe { fmi3GetNumberOfVariableDependencies(i, slot as u32, &mut count) };
        (status, count)
    };
    assert_eq!(count(Y), (OK, 2));
    assert_eq!(count(COUNT), (OK, 0));
    assert_eq!(count(0), (OK, 0));
    let (mut of, mut on, mut independents, mut kinds) = ([9; 2], [9; 2], [0; 2], [0; 2]);
    // SAFETY: places for two.
    unsafe {
        let (of, on) = (of.as_mut_ptr(), on.as_mut_ptr());
        let (independents, kinds) = (independents.as_mut_ptr(), kinds.as_mut_ptr());
        let get = fmi3GetVariableDependencies;
        assert_eq!(get(i, Y as u32, of, independents, on, kinds, 2), OK);
        assert_eq!(get(i, Y as u32, of, independents, on, kinds, 1), ERROR);
    }
    assert_eq!((of, on, independents, kinds), ([0; 2], [0; 2], [U as u32, ON as u32], [5; 2]));
    assert_eq!(count(U + 1).0, ERROR, "the second element is no variable");
    // SAFETY: a handle.
    unsafe { fmi3FreeInstance(i) };
}

#[test]
fn states_as_bytes_go_on_in_another_instance() {
    let (c, other) =
        (stepping2(), new(ServedStandard::Fmi2, InstanceOptions::default(), null_mut()));
    let (mut state, mut copy, mut size) = (null_mut(), null_mut(), 0);
    // SAFETY: handles, places and bytes.
    unsafe {
        assert_eq!(fmi2SetReal(c, &(U as u32), 1, &0.3), OK);
        assert_eq!(fmi2DoStep(c, 0.0, 3.0 * PERIOD_S, 0), OK);
        assert_eq!(fmi2GetFMUstate(c, &mut state), OK);
        assert_eq!(fmi2SerializedFMUstateSize(c, state, &mut size), OK);
        let mut bytes = vec![0; size];
        assert_eq!(fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr(), size - 1), ERROR);
        assert_eq!(fmi2SetFMUstate(c, state), OK, "a kept state leads out of an error");
        assert_eq!(fmi2SerializeFMUstate(c, state, bytes.as_mut_ptr(), size), OK);
        assert_eq!(fmi2DeSerializeFMUstate(other, bytes.as_ptr(), size, &mut copy), OK);
        assert_eq!(fmi2SetFMUstate(other, copy), OK);
        for c in [c, other] {
            assert_eq!(fmi2DoStep(c, 0.03, PERIOD_S, 0), OK);
            assert_eq!(real(c, COUNT), 4.0);
        }
        assert_eq!(real(c, Y).to_bits(), real(other, Y).to_bits());
        // Damaged, of another standard, cut short.
        for i in [0, 9, size / 2, size - 1] {
            bytes[i] ^= 1;
            assert_eq!(fmi2DeSerializeFMUstate(c, bytes.as_ptr(), size, &mut copy), ERROR, "{i}");
            assert_eq!(fmi2SetFMUstate(c, state), OK);
            bytes[i] ^= 1;
        }
        assert_eq!(fmi2DeSerializeFMUstate(c, bytes.as_ptr(), size - 1, &mut copy), ERROR);
        let three = new(ServedStandard::Fmi3, InstanceOptions::default(), null_mut());
        assert_eq!(fmi3DeserializeFMUState(three, bytes.as_ptr().cast(), size, &mut copy), ERROR);
        for c in [c, other] {
            fmi2FreeInstance(c);
        }
        fmi3FreeInstance(three);
    }
}
