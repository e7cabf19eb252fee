//! Foreign FMUs in this process: their inputs, their outputs, and the order of calls. The FMUs are
//! strict: they fail if the order is wrong.

use super::foreign::{self, copy, without_clocks};
use std::path::{Path, PathBuf};

use octant_fmu_host::FmuOpenError;
use octant_fmu_host::description::Variable;
use octant_fmu_host::instance::{
    AccessPlan, Instance, InstanceError, InterfaceKind, OpenOptions, ProcessPlace, StepOutcome,
    Stepped, VariableGroup,
};

/// Returns options for code that runs in this process.
fn here() -> OpenOptions {
    OpenOptions { place: ProcessPlace::ThisProcess, ..OpenOptions::default() }
}

fn open_with(name: &str, options: &OpenOptions) -> Result<Box<dyn Instance>, FmuOpenError> {
    octant_fmu_host::open(&foreign::fmu(name), options)
}

fn open(name: &str) -> Box<dyn Instance> {
    open_with(name, &here()).unwrap()
}

fn variable(instance: &dyn Instance, name: &str) -> Variable {
    let found = instance.description().variables.iter().find(|variable| variable.name == name);
    found.unwrap_or_else(|| panic!("no variable {name}")).clone()
}

fn group(instance: &dyn Instance, name: &str) -> VariableGroup {
    VariableGroup::of(instance.description(), &variable(instance, name)).unwrap()
}

fn set(instance: &mut dyn Instance, name: &str, values: &[f64]) -> Result<(), InstanceError> {
    let group = group(instance, name);
    instance.set(&group, values)
}

fn get(instance: &mut dyn Instance, name: &str) -> Vec<f64> {
    let group = group(instance, name);
    let mut values = vec![f64::NAN; group.elements];
    instance.get(&group, &mut values).unwrap();
    values
}

fn start(instance: &mut dyn Instance) {
    instance.enter_initialization(0.0, None, None).unwrap();
    assert!(!instance.exit_initialization().unwrap());
}

fn plan(instance: &dyn Instance, names: &[&str]) -> AccessPlan {
    let variables: Vec<Variable> = names.iter().map(|name| variable(instance, name)).collect();
    AccessPlan::new(instance.description(), &variables.iter().collect::<Vec<_>>()).unwrap()
}

#[test]
fn fmi2_takes_and_gives_every_type() {
    let mut gain = open("gain_fmi2");
    let gain = &mut *gain;
    set(gain, "gain", &[3.0]).unwrap();
    let label = group(gain, "label");
    gain.set_strings(&label, &["Octant".into()]).unwrap();
    start(gain);
    set(gain, "u", &[0.5]).unwrap();
    set(gain, "n", &[-7.0]).unwrap();
    set(gain, "on", &[1.0]).unwrap();
    set(gain, "mode", &[2.0]).unwrap();
    let stepped = gain.step(0.0, 2.0).unwrap();
    let done = Stepped { time_s: 2.0, outcome: StepOutcome::Done, event: false, terminate: false };
    assert_eq!(stepped, done);
    assert_eq!(get(gain, "y"), [3.0]);
    assert_eq!(get(gain, "n_next"), [-6.0]);
    assert_eq!(get(gain, "off"), [0.0]);
    assert_eq!(get(gain, "mode"), [2.0]);
    let greeting = group(gain, "greeting");
    assert_eq!(gain.get_strings(&greeting).unwrap(), ["hello Octant"]);
    gain.terminate().unwrap();
}

#[test]
fn an_exchange_sets_steps_and_gets() {
    let mut gain = open("gain_fmi2");
    start(&mut *gain);
    let inputs = plan(&*gain, &["n", "u", "on", "mode"]);
    let outputs = plan(&*gain, &["off", "y", "n_next"]);
    assert_eq!(inputs.elements, 4);
    let mut set = [0.0; 4];
    for (place, value) in inputs.places.iter().zip([41.0, 0.25, 0.0, 1.0]) {
        set[place.start] = value;
    }
    let mut got = [f64::NAN; 3];
    for k in 0..4 {
        let time_s = f64::from(k);
        let stepped =
            gain.exchange(&inputs.groups, &set, time_s, 1.0, &outputs.groups, &mut got).unwrap();
        assert_eq!((stepped.time_s, stepped.outcome), (time_s + 1.0, StepOutcome::Done));
    }
    let got: Vec<f64> = outputs.places.iter().map(|place| got[place.start]).collect();
    assert_eq!(got, [1.0, 2.0, 42.0]);
    let error = gain.exchange(&inputs.groups, &set[..3], 4.0, 1.0, &[], &mut []).unwrap_err();
    assert!(error.to_string().contains("its variables have 4 elements"), "{error}");
}

#[test]
fn values_that_do_not_fit_are_refused() {
    let mut gain = open("gain_fmi2");
    let gain = &mut *gain;
    start(gain);
    for (name, value) in [("n", 0.5), ("n", 2_147_483_648.0), ("n", f64::NAN), ("on", 2.0)] {
        let error = set(gain, name, &[value]).unwrap_err();
        assert!(matches!(error, InstanceError::Value { .. }), "{error}");
        assert!(error.to_string().contains(&format!("{value} of {name}")), "{error}");
    }
    // After a refusal by the FMU itself it stays usable.
    let error = set(gain, "ratio", &[1.5]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "fmi2SetReal of gain_fmi2.fmu answered discard: 1.5 is no value of ratio, 50% is"
    );
    gain.step(0.0, 1.0).unwrap();
}

#[test]
fn messages_are_written_out_with_their_arguments() {
    let mut gain = open("gain_fmi2");
    let gain = &mut *gain;
    set(gain, "chatty", &[1.0]).unwrap();
    start(gain);
    let messages = gain.messages();
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert_eq!(messages[0].category, "logAll");
    let uri = messages[0].text.strip_prefix("resources are at ").unwrap();
    assert!(uri.starts_with("file:///") && uri.ends_with("/resources"), "{uri}");
    set(gain, "u", &[0.25]).unwrap();
    gain.step(0.0, 1.5).unwrap();
    let messages: Vec<String> = gain.messages().iter().map(ToString::to_string).collect();
    assert_eq!(messages, ["[ok] logAll: Gain at 1.500 s: u is +25 %, done."]);
    assert!(gain.messages().is_empty());
}

#[test]
fn nothing_is_logged_when_it_is_not_asked_for() {
    let mut gain = open_with("gain_fmi2", &OpenOptions { log: false, ..here() }).unwrap();
    set(&mut *gain, "chatty", &[1.0]).unwrap();
    start(&mut *gain);
    gain.step(0.0, 1.0).unwrap();
    assert!(gain.messages().is_empty());
}

#[test]
fn states_are_kept_restored_and_serialized() {
    for name in ["gain_fmi2", "signals_fmi3"] {
        let mut one = open(name);
        let one = &mut *one;
        start(one);
        let ones = vec![1.0; group(one, "u").elements];
        set(one, "u", &ones).unwrap();
        one.step(0.0, 0.1).unwrap();
        let kept = one.keep_state().unwrap();
        one.step(0.1, 0.1).unwrap();
        let expected = get(one, "y");
        one.restore_state(kept).unwrap();
        one.step(0.1, 0.1).unwrap();
        assert_eq!(get(one, "y"), expected, "{name}");
        let bytes = one.state_to_bytes(kept).unwrap();

        let mut other = open(name);
        let other = &mut *other;
        let state = other.state_from_bytes(&bytes).unwrap();
        other.restore_state(state).unwrap();
        other.step(0.1, 0.1).unwrap();
        assert_eq!(get(other, "y"), expected, "{name}");

        // Damaged, truncated or foreign bytes don't reach the FMU.
        let mut damaged = bytes.clone();
        *damaged.last_mut().unwrap() ^= 1;
        for wrong in [&damaged[..], &bytes[..bytes.len() - 1], &bytes[..20], b"", b"OCTFMU"] {
            let error = other.state_from_bytes(wrong).unwrap_err();
            assert!(matches!(error, InstanceError::State { .. }), "{error}");
        }
        one.forget_state(kept).unwrap();
        for error in [one.restore_state(kept), one.forget_state(kept)] {
            assert!(matches!(error, Err(InstanceError::State { .. })));
        }
    }
    let mut gain = open("gain_fmi2");
    let mut signals = open("signals_fmi3");
    let state = gain.keep_state().unwrap();
    let bytes = gain.state_to_bytes(state).unwrap();
    let error = signals.state_from_bytes(&bytes).unwrap_err();
    assert!(error.to_string().contains("is of another FMU, Gain"), "{error}");
}

#[test]
fn what_an_fmu_has_not_is_named() {
    let mut trouble = open("trouble_fmi2");
    let state = trouble.keep_state().unwrap();
    let error = trouble.state_to_bytes(state).unwrap_err();
    assert_eq!(
        error.to_string(),
        "trouble_fmi2.fmu can't call fmi2SerializedFMUstateSize: its library doesn't have this function"
    );
    let error = trouble.enter_event_mode().unwrap_err();
    assert!(matches!(error, InstanceError::Order { .. }), "{error}");
}

#[test]
fn calls_out_of_order_do_not_reach_the_fmu() {
    let mut signals = open("signals_fmi3");
    let error = signals.step(0.0, 0.1).unwrap_err();
    assert_eq!(
        error.to_string(),
        "signals_fmi3.fmu: a step isn't possible before the initialization"
    );
    assert!(signals.exit_initialization().is_err());
    assert!(signals.terminate().is_err());
    assert!(signals.update_discrete_states().is_err());
    start(&mut *signals);
    assert!(signals.enter_initialization(0.0, None, None).is_err());
    for step in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        assert!(signals.step(0.0, step).is_err());
    }
    signals.step(0.0, 0.1).unwrap();
    signals.terminate().unwrap();
    assert!(signals.step(0.1, 0.1).is_err());
    signals.reset().unwrap();
    start(&mut *signals);
    signals.step(0.0, 0.1).unwrap();
}

/// Name, values of the right length, and the output one event later.
const SIGNALS: [(&str, &[f64]); 11] = [
    ("f32", &[0.5, -1.25, 3e38_f32 as f64, 0.0]),
    ("i8", &[-128.0]),
    ("u8", &[255.0]),
    ("i16", &[-32768.0]),
    ("u16", &[65535.0]),
    ("i32", &[-2_147_483_648.0, 2_147_483_647.0]),
    ("u32", &[4_294_967_295.0]),
    ("i64", &[-9_223_372_036_854_775_808.0]),
    ("u64", &[9_007_199_254_740_992.0]),
    ("boolean", &[1.0]),
    ("mode", &[-2.0]),
];

#[test]
fn fmi3_takes_and_gives_every_type() {
    let folder = without_clocks();
    for event_mode in [true, false] {
        let options = OpenOptions { event_mode, ..here() };
        let mut signals = octant_fmu_host::open(folder.path(), &options).unwrap();
        let signals = &mut *signals;
        start(signals);
        for (name, values) in SIGNALS {
            set(signals, name, values).unwrap();
        }
        let (string, binary) = (group(signals, "string"), group(signals, "binary"));
        signals.set_strings(&string, &["größer".into()]).unwrap();
        signals.set_binaries(&binary, &[vec![1, 0, 255]]).unwrap();
        signals.step(0.0, 0.1).unwrap();
        for (name, values) in SIGNALS {
            assert_eq!(get(signals, &format!("{name}_out")), values, "{name} {event_mode}");
        }
        let (string, binary) = (group(signals, "string_out"), group(signals, "binary_out"));
        assert_eq!(signals.get_strings(&string).unwrap(), ["größer"]);
        assert_eq!(signals.get_binaries(&binary).unwrap(), [vec![255, 0, 1]]);
        for (name, value) in [("i8", 128.0), ("u8", -1.0), ("u16", 0.5), ("u64", 2e19)] {
            let error = set(signals, name, &[value]).unwrap_err();
            assert!(matches!(error, InstanceError::Value { .. }), "{error}");
        }
        // A number that f64 can't hold.
        assert!(matches!(
            set(signals, "f32", &[1e39, 0.0, 0.0, 0.0]),
            Err(InstanceError::Value { .. })
        ));
        assert!(set(signals, "u", &[1.0]).is_err(), "three are expected");
    }
}

/// A compiled FMU: texts and bytes that were set come back, between quotes and as digits.
#[test]
fn arrays_have_the_size_of_their_structural_parameter() {
    let mut signals = open("signals_fmi3");
    let signals = &mut *signals;
    set(signals, "size", &[5.0]).unwrap();
    let sized = |group: VariableGroup| VariableGroup { elements: 5, ..group };
    let (u, y) = (sized(group(signals, "u")), sized(group(signals, "y")));
    start(signals);
    signals.set(&u, &[1.0, 2.0, 3.0, 4.0, 5.0]).unwrap();
    signals.step(0.0, 0.125).unwrap();
    let mut values = [0.0; 5];
    signals.get(&y, &mut values).unwrap();
    assert_eq!(values, [0.125, 0.25, 0.375, 0.5, 0.625]);
    // Later it is fixed, and the FMU reports that.
    let error = set(signals, "size", &[4.0]).unwrap_err();
    assert!(error.to_string().contains("fixed after instantiation"), "{error}");
    // After the answer error, only a reset is possible.
    let error = signals.step(0.125, 0.1).unwrap_err();
    assert!(error.to_string().contains("after it answered error"), "{error}");
    signals.reset().unwrap();
    start(signals);
    signals.step(0.0, 0.1).unwrap();
}

#[test]
fn early_returns_come_at_events() {
    let mut signals = open("signals_fmi3");
    let signals = &mut *signals;
    start(signals);
    set(signals, "u", &[1.0; 3]).unwrap();
    let stepped = signals.step(0.0, 0.6).unwrap();
    assert_eq!((stepped.time_s, stepped.outcome, stepped.event), (0.25, StepOutcome::Early, true));
    // The clock ticks at the event.
    signals.enter_event_mode().unwrap();
    let mut updates = 0;
    loop {
        updates += 1;
        let update = signals.update_discrete_states().unwrap();
        assert_eq!(get(signals, "tick"), [1.0]);
        if !update.again {
            assert_eq!(update.next_event_time_s, Some(0.5));
            break;
        }
    }
    assert_eq!(updates, 2);
    signals.leave_event_mode().unwrap();
    assert_eq!(get(signals, "count"), [1.0]);
    assert_eq!(get(signals, "y"), [0.25; 3]);
    // The rest in one call: over the event at 0.5 s, to the end.
    let stepped = signals.advance(0.25, 0.35).unwrap();
    assert_eq!((stepped.time_s, stepped.outcome, stepped.event), (0.6, StepOutcome::Done, false));
    assert_eq!(get(signals, "count"), [2.0]);
    assert_eq!(get(signals, "event_time"), [0.5]);
}

#[test]
fn events_without_early_return_come_at_the_end_of_a_step_of_fixed_length() {
    let folder = copy("signals_fmi3", |text| {
        text.replace("canHandleVariableCommunicationStepSize=\"true\"", "")
    });
    let options = OpenOptions { early_return: false, ..here() };
    let mut signals = octant_fmu_host::open(folder.path(), &options).unwrap();
    start(&mut *signals);
    let stepped = signals.step(0.0, 0.6).unwrap();
    assert_eq!((stepped.time_s, stepped.outcome, stepped.event), (0.6, StepOutcome::Done, true));
    assert!(!signals.handle_events().unwrap());
    assert_eq!(get(&mut *signals, "count"), [2.0]);
    assert_eq!(get(&mut *signals, "event_time"), [0.6]);
}

#[test]
fn an_fmu_handles_its_events_itself_where_it_is_asked_to() {
    let folder = without_clocks();
    let options = OpenOptions { event_mode: false, ..here() };
    let mut signals = octant_fmu_host::open(folder.path(), &options).unwrap();
    start(&mut *signals);
    let stepped = signals.step(0.0, 0.6).unwrap();
    assert_eq!((stepped.time_s, stepped.outcome, stepped.event), (0.6, StepOutcome::Done, false));
    assert_eq!(get(&mut *signals, "count"), [2.0]);
    assert_eq!(get(&mut *signals, "event_time"), [0.5]);
    assert_eq!(get(&mut *signals, "updates"), [0.0]);
}

#[test]
fn a_clock_is_set_at_an_event() {
    let mut signals = open("signals_fmi3");
    start(&mut *signals);
    set(&mut *signals, "kick", &[1.0]).unwrap();
    signals.step(0.0, 0.1).unwrap();
    signals.step(0.1, 0.1).unwrap();
    assert_eq!(get(&mut *signals, "kicked"), [1.0]);
}

#[test]
fn a_discarded_step_says_how_far_it_came() {
    // Without steps of any length, so that it isn't split at time events.
    let folder = copy("signals_fmi3", |text| {
        text.replace("canHandleVariableCommunicationStepSize=\"true\"", "")
    });
    let mut signals = octant_fmu_host::open(folder.path(), &here()).unwrap();
    start(&mut *signals);
    let stepped = signals.step(0.0, 11.0).unwrap();
    assert_eq!((stepped.time_s, stepped.outcome), (0.0, StepOutcome::Discarded));
    assert_eq!(signals.messages().last().unwrap().text, "10 s at most");
    signals.step(0.0, 0.1).unwrap();

    let mut trouble = open("trouble_fmi2");
    start(&mut *trouble);
    demand(&mut *trouble, STEP, DISCARD);
    let stepped = trouble.step(1.0, 1.0).unwrap();
    assert_eq!((stepped.time_s, stepped.outcome), (1.25, StepOutcome::Discarded));
    assert!(!stepped.terminate);
    demand(&mut *trouble, STEP, TERMINATE);
    let stepped = trouble.step(1.0, 1.0).unwrap();
    assert!(stepped.terminate && stepped.outcome == StepOutcome::Discarded);
}

// Places and troubles of `trouble_fmi2`.
const INITIALIZATION: u8 = 2;
const STEP: u8 = 4;
const GET: u8 = 5;
const DISCARD: u8 = 7;
const FAIL: u8 = 8;
const FATAL: u8 = 9;
const FLOOD: u8 = 10;
const PENDING: u8 = 11;
const PENDING_FOREVER: u8 = 12;
const TERMINATE: u8 = 13;
const FORMAT: u8 = 14;
const UNKNOWN_STATUS: u8 = 17;

fn demand(trouble: &mut dyn Instance, place: u8, what: u8) {
    set(trouble, "trouble", &[f64::from(what)]).unwrap();
    set(trouble, "place", &[f64::from(place)]).unwrap();
}

#[test]
fn errors_carry_what_the_fmu_said() {
    let mut trouble = open("trouble_fmi2");
    let trouble = &mut *trouble;
    demand(trouble, INITIALIZATION, FAIL);
    let error = trouble.enter_initialization(0.0, None, None).unwrap_err();
    assert_eq!(
        error.to_string(),
        "fmi2EnterInitializationMode of trouble_fmi2.fmu answered error: it failed on demand"
    );
    trouble.reset().unwrap();
    start(trouble);
    let kept = trouble.keep_state().unwrap();
    demand(trouble, STEP, FAIL);
    assert!(trouble.step(0.0, 1.0).is_err());
    assert!(matches!(trouble.step(0.0, 1.0), Err(InstanceError::Order { .. })));
    trouble.restore_state(kept).unwrap();
    trouble.step(0.0, 1.0).unwrap();
}

#[test]
fn what_answered_fatal_is_not_touched_again() {
    for (what, status) in
        [(FATAL, "fatal"), (UNKNOWN_STATUS, "a status that the standard doesn't have")]
    {
        let mut trouble = open("trouble_fmi2");
        let trouble = &mut *trouble;
        start(trouble);
        let kept = trouble.keep_state().unwrap();
        demand(trouble, STEP, what);
        let error = trouble.step(0.0, 1.0).unwrap_err();
        let expected = format!("fmi2DoStep of trouble_fmi2.fmu answered {status}");
        assert!(error.to_string().starts_with(&expected), "{error}");
        for error in [trouble.reset(), trouble.restore_state(kept), trouble.terminate()] {
            let error = error.unwrap_err();
            assert!(
                error.to_string().ends_with("isn't possible after it answered fatal"),
                "{error}"
            );
        }
    }
}

#[test]
fn an_instance_that_is_none_is_said() {
    let options = OpenOptions { instance_name: Some(format!("instantiate {FAIL}")), ..here() };
    let error = open_with("trouble_fmi2", &options).map(|_| ()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "fmi2Instantiate of trouble_fmi2.fmu answered no instance: it failed on demand"
    );
    let folder = copy("gain_fmi2", |text| text.replace("{8a6f3c1e-gain}", "{another}"));
    let error = octant_fmu_host::open(folder.path(), &here()).map(|_| ()).unwrap_err();
    assert!(error.to_string().contains("guid {another} is not {8a6f3c1e-gain}"), "{error}");
}

#[test]
fn every_format_of_a_message_is_safe() {
    let mut trouble = open("trouble_fmi2");
    start(&mut *trouble);
    demand(&mut *trouble, STEP, FORMAT);
    trouble.step(0.0, 1.0).unwrap();
    let messages = trouble.messages();
    let texts: Vec<&str> = messages.iter().map(|message| message.text.as_str()).collect();
    assert_eq!(texts[0], "-7| 3.14|text|c|1234567890123|(nil)|%|42  |ff|1.500000e+00");
    assert_eq!(texts[1].len(), 65535);
    assert_eq!(texts[2], "writes %d%n");
    assert_eq!((texts[3], messages[3].category.as_str()), ("no category", ""));
    assert_eq!(texts[4], "\u{fffd}\u{fffd}");
    assert_eq!(messages[4].status, "a status that the standard doesn't have");
    assert_eq!(texts.len(), 5, "{texts:?}");
}

#[test]
fn a_flood_of_messages_is_bounded() {
    let mut trouble = open("trouble_fmi2");
    start(&mut *trouble);
    demand(&mut *trouble, STEP, FLOOD);
    trouble.step(0.0, 1.0).unwrap();
    let messages = trouble.messages();
    assert_eq!(messages.len(), 1001);
    assert_eq!(messages[1000].text, "99000 more messages were dropped");
}

#[test]
fn a_pending_step_is_waited_for_up_to_the_limit() {
    let time_limit = std::time::Duration::from_secs(2);
    let mut trouble = open_with("trouble_fmi2", &OpenOptions { time_limit, ..here() }).unwrap();
    start(&mut *trouble);
    demand(&mut *trouble, STEP, PENDING);
    assert_eq!(trouble.step(0.0, 1.0).unwrap().outcome, StepOutcome::Done);
    demand(&mut *trouble, STEP, PENDING_FOREVER);
    let error = trouble.step(1.0, 1.0).unwrap_err();
    assert!(error.to_string().contains("pending beyond the time limit"), "{error}");
}

#[test]
fn an_exchange_stops_where_a_get_fails() {
    let mut trouble = open("trouble_fmi2");
    start(&mut *trouble);
    let outputs = plan(&*trouble, &["y"]);
    demand(&mut *trouble, GET, FAIL);
    let error = trouble.exchange(&[], &[], 0.0, 1.0, &outputs.groups, &mut [0.0]).unwrap_err();
    assert!(
        error.to_string().starts_with("fmi2GetReal of trouble_fmi2.fmu answered error for y"),
        "{error}"
    );
}

/// Returns the only file of its library.
fn library(folder: &Path) -> PathBuf {
    let platform = std::fs::read_dir(folder.join("binaries")).unwrap().next().unwrap().unwrap();
    std::fs::read_dir(platform.path()).unwrap().next().unwrap().unwrap().path()
}

fn refusal(folder: &Path) -> String {
    octant_fmu_host::open(folder, &here()).map(|_| ()).unwrap_err().to_string()
}

#[test]
fn what_cannot_be_loaded_is_said() {
    let folder = copy("gain_fmi2", str::to_owned);
    let file = library(folder.path());
    let name = folder.path().file_name().unwrap().to_str().unwrap();

    std::fs::write(&file, "no library").unwrap();
    let error = refusal(folder.path());
    assert!(error.starts_with(&format!("load {name}: ")), "{error}");
    assert!(error.contains("gain_fmi2"), "{error}");

    // Library of the other standard.
    std::fs::copy(library(&foreign::unpacked("signals_fmi3")), &file).unwrap();
    let error = refusal(folder.path());
    assert!(error.contains("lacks fmi2Instantiate, fmi2FreeInstance"), "{error}");

    std::fs::rename(file.parent().unwrap(), folder.path().join("binaries/vax64")).unwrap();
    let error = refusal(folder.path());
    assert!(
        error.starts_with(&format!(
            "load {name}: it has no library for this platform: expected binaries/"
        )),
        "{error}"
    );
    assert!(error.ends_with("found vax64"), "{error}");
    std::fs::remove_dir_all(folder.path().join("binaries")).unwrap();
    assert!(refusal(folder.path()).ends_with("found no binaries"));

    for identifier in ["../gain_fmi2", "a/b", ".hidden"] {
        let folder = copy("gain_fmi2", |text| {
            text.replace("modelIdentifier=\"gain_fmi2", &format!("modelIdentifier=\"{identifier}"))
        });
        let error = refusal(folder.path());
        assert!(error.contains("is no name of a file"), "{error}");
    }
    let exchange = OpenOptions { interface: InterfaceKind::ModelExchange, ..here() };
    let error =
        octant_fmu_host::open(&foreign::fmu("gain_fmi2"), &exchange).map(|_| ()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "gain_fmi2.fmu can't run by model exchange: it has co-simulation"
    );
}

#[test]
fn clocks_tick_when_they_are_due() {
    // Steps that divide no interval, one that is an interval, and one over many ticks.
    for step_s in [0.07, 0.3, 2.5] {
        let mut clocks = open("clocks_fmi3");
        let clocks = &mut *clocks;
        start(clocks);
        let mut time_s = 0.0;
        while time_s < 4.9 {
            let stepped = clocks.step(time_s, step_s).unwrap();
            assert_eq!(stepped.outcome, StepOutcome::Done);
            time_s = stepped.time_s;
            // From 0.1 s on, each 0.3 s.
            let fixed = ((time_s + 1e-9 - 0.1) / 0.3).floor() + 1.0;
            assert_eq!(get(clocks, "fixed_ticks"), [fixed.max(0.0)], "{time_s}");
            // At 0, then after 0.1, 0.2, 0.3 … s: at 0.1 n (n + 1) / 2.
            let changing = (0..).take_while(|n| 0.05 * f64::from(n * (n + 1)) <= time_s + 1e-9);
            let changing = changing.count() as f64;
            assert_eq!(get(clocks, "changing_ticks"), [changing], "{time_s}");
            let last_s = get(clocks, "changing_last")[0];
            assert!((last_s - 0.05 * changing * (changing - 1.0)).abs() < 1e-9, "{last_s}");
        }
        assert_eq!(get(clocks, "countdown_ticks"), [0.0]);
        // A countdown begins at the event at which it is requested.
        set(clocks, "arm", &[1.0]).unwrap();
        clocks.step(time_s, 0.24).unwrap();
        assert_eq!(get(clocks, "countdown_ticks"), [0.0]);
        clocks.step(time_s + 0.24, 1.0).unwrap();
        assert_eq!(get(clocks, "countdown_ticks"), [1.0]);
        let ticked_s = get(clocks, "countdown_last")[0];
        assert!((ticked_s - time_s - 0.25).abs() < 1e-9, "{ticked_s} {time_s}");
    }
}

#[test]
fn clocks_are_kept_with_the_state() {
    let mut clocks = open("clocks_fmi3");
    let clocks = &mut *clocks;
    start(clocks);
    clocks.step(0.0, 0.35).unwrap();
    set(clocks, "arm", &[1.0]).unwrap();
    clocks.step(0.35, 0.1).unwrap();
    let kept = clocks.keep_state().unwrap();
    let to_the_end = |clocks: &mut dyn Instance| {
        clocks.step(0.45, 2.0).unwrap();
        let names = ["fixed_ticks", "changing_ticks", "countdown_ticks", "countdown_last"];
        names.map(|name| get(clocks, name)[0])
    };
    let expected = to_the_end(clocks);
    assert_eq!(expected[2], 1.0);
    clocks.restore_state(kept).unwrap();
    assert_eq!(to_the_end(clocks), expected);
}

#[test]
fn clocks_need_event_mode() {
    let error = open_with("clocks_fmi3", &OpenOptions { event_mode: false, ..here() });
    let error = error.map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("has clocks"), "{error}");
}

#[test]
fn what_runs_once_a_process_runs_once() {
    let once = |text: &str| {
        text.replace(
            "<CoSimulation ",
            "<CoSimulation canBeInstantiatedOnlyOncePerProcess=\"true\" ",
        )
    };
    let folder = copy("gain_fmi2", once);
    let first = octant_fmu_host::open(folder.path(), &here()).unwrap();
    let error = refusal(folder.path());
    assert!(error.ends_with("there is one already, and it can be there only once"), "{error}");
    drop(first);
    octant_fmu_host::open(folder.path(), &here()).unwrap();
}
