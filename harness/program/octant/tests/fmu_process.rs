//! FMUs in processes of their own: the same answers as in this process, and clear errors where they
//! crash, hang, end the process or print.

use crate::common::foreign;
use crate::common::program::{OCTANT, passes_as_process, program, test_as_process};
use octant_fmu_host::FmuOpenError;
use octant_fmu_host::instance::{
    AccessPlan, Instance, InstanceError, OpenOptions, ProcessPlace, StepOutcome, VariableGroup,
};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::{Duration, Instant};

fn apart() -> OpenOptions {
    let program = Some(PathBuf::from(OCTANT));
    OpenOptions { place: ProcessPlace::OwnProcess, program, ..OpenOptions::default() }
}

fn here() -> OpenOptions {
    OpenOptions { place: ProcessPlace::ThisProcess, ..OpenOptions::default() }
}

fn try_open(name: &str, options: &OpenOptions) -> Result<Box<dyn Instance>, FmuOpenError> {
    octant_fmu_host::open(&foreign::fmu(name), options)
}

fn open(name: &str) -> Box<dyn Instance> {
    try_open(name, &apart()).unwrap()
}

fn group(instance: &dyn Instance, name: &str) -> VariableGroup {
    let description = instance.description();
    VariableGroup::of(description, description.variable(name).unwrap()).unwrap()
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
    let description = instance.description();
    let variables: Vec<_> = names.iter().map(|name| description.variable(name).unwrap()).collect();
    AccessPlan::new(description, &variables).unwrap()
}

// Places and troubles of `trouble_fmi2`.
const INSTANTIATE: u8 = 1;
const INITIALIZATION: u8 = 2;
const SET: u8 = 3;
const STEP: u8 = 4;
const GET: u8 = 5;
const STATE: u8 = 6;
const FREE: u8 = 7;
const CRASH: u8 = 1;
const ABORT: u8 = 2;
const EXIT: u8 = 3;
const HANG: u8 = 4;
const OVERFLOW: u8 = 5;
const PRINT: u8 = 6;
const DISCARD: u8 = 7;
const FAIL: u8 = 8;
const FLOOD: u8 = 10;
const CLOSE: u8 = 15;
const BUSY: u8 = 16;

fn demand(trouble: &mut dyn Instance, place: u8, what: u8) {
    set(trouble, "trouble", &[f64::from(what)]).unwrap();
    set(trouble, "place", &[f64::from(place)]).unwrap();
}

/// Collects an instance's answers to every possible call, as text.
fn play(instance: &mut dyn Instance, inputs: &[&str], outputs: &[&str]) -> Vec<String> {
    let mut said = vec![instance.name().to_owned()];
    let mut say = |what: &dyn std::fmt::Debug| said.push(format!("{what:?}"));
    say(&instance.step(0.0, 0.1));
    start(instance);
    let inputs = plan(instance, inputs);
    let outputs = plan(instance, outputs);
    let mut got = vec![0.0; outputs.elements];
    for k in 0..60u32 {
        let values: Vec<f64> =
            (0..inputs.elements).map(|i| f64::from((k + i as u32) % 2)).collect();
        let time_s = 0.1 * f64::from(k);
        let stepped =
            instance.exchange(&inputs.groups, &values, time_s, 0.1, &outputs.groups, &mut got);
        say(&(stepped, got.iter().map(|value| value.to_bits()).collect::<Vec<_>>()));
        if k % 20 == 7 {
            // A saved state, two steps, and back.
            let kept = instance.keep_state().unwrap();
            let bytes = instance.state_to_bytes(kept).unwrap();
            say(&instance.step(time_s + 0.1, 0.05));
            let again = instance.state_from_bytes(&bytes).unwrap();
            instance.restore_state(again).unwrap();
            say(&instance.step(time_s + 0.1, 0.05));
            instance.restore_state(kept).unwrap();
            say(&(instance.forget_state(kept), instance.forget_state(again)));
            say(&instance.forget_state(again));
            say(&instance.state_from_bytes(&bytes[1..]));
        }
    }
    say(&instance.exchange(&inputs.groups, &[], 6.0, 0.1, &[], &mut []));
    say(&instance.exchange(&[], &[], 6.0, 0.1, &outputs.groups, &mut []));
    say(&instance.handle_events());
    say(&(instance.enter_event_mode(), instance.update_discrete_states()));
    say(&(instance.update_discrete_states(), instance.leave_event_mode()));
    say(&instance.messages());
    say(&(instance.terminate(), instance.terminate(), instance.reset()));
    start(instance);
    say(&instance.step(0.0, 0.1));
    said
}

#[test]
fn answers_are_the_same_as_in_this_process() {
    let signals = ["u", "i32", "boolean", "f32", "u64", "mode"];
    let echoes = ["y", "i32_out", "boolean_out", "f32_out", "u64_out", "mode_out", "count"];
    for (name, inputs, outputs) in [
        ("gain_fmi2", &["u", "n", "on", "chatty"][..], &["y", "n_next", "off"][..]),
        ("signals_fmi3", &signals, &echoes),
        ("ball_fmi3", &[], &["h", "v", "bounces"]),
        ("dahlquist_fmi3", &["u"], &["x"]),
    ] {
        // The same folder, because the messages name it.
        let folder = foreign::unpacked(name);
        let mut one = octant_fmu_host::open(&folder, &apart()).unwrap();
        let mut other = octant_fmu_host::open(&folder, &here()).unwrap();
        let one = play(&mut *one, inputs, outputs);
        let other = play(&mut *other, inputs, outputs);
        for (one, other) in one.iter().zip(&other) {
            assert_eq!(one, other, "{name}");
        }
        assert_eq!(one.len(), other.len());
    }
}

#[test]
fn texts_and_bytes_cross() {
    let mut signals = open("signals_fmi3");
    let signals = &mut *signals;
    start(signals);
    let (string, binary) = (group(signals, "string"), group(signals, "binary"));
    signals.set_strings(&string, &["größer".into()]).unwrap();
    signals.set_binaries(&binary, &[vec![1, 0, 255]]).unwrap();
    signals.step(0.0, 0.1).unwrap();
    let (string, binary) = (group(signals, "string_out"), group(signals, "binary_out"));
    assert_eq!(signals.get_strings(&string).unwrap(), ["größer"]);
    assert_eq!(signals.get_binaries(&binary).unwrap(), [vec![255, 0, 1]]);
}

#[test]
fn more_numbers_than_shared_memory_was_made_for() {
    let mut gain = open("gain_fmi2");
    let gain = &mut *gain;
    start(gain);
    let u = group(gain, "u");
    let many = VariableGroup { references: vec![u.references[0]; 5000], elements: 5000, ..u };
    let y = plan(gain, &["y"]);
    let mut values = vec![0.0; 5000];
    values[4999] = 0.5;
    let mut got = [0.0];
    gain.exchange(&[many], &values, 0.0, 1.0, &y.groups, &mut got).unwrap();
    assert_eq!(got, [1.0]);
    // More different exchanges than are planned for.
    for n in 1..100 {
        let u = group(gain, "u");
        let some = VariableGroup { references: vec![u.references[0]; n], elements: n, ..u };
        let time_s = n as f64;
        gain.exchange(&[some], &values[5000 - n..], time_s, 1.0, &y.groups, &mut got).unwrap();
        assert_eq!(got, [1.0 + time_s]);
    }
}

/// Triggers a trouble, and returns the error.
fn meet(place: u8, what: u8, options: &OpenOptions) -> String {
    let options = if place == INSTANTIATE {
        OpenOptions { instance_name: Some(format!("instantiate {what}")), ..options.clone() }
    } else {
        options.clone()
    };
    let mut trouble = match try_open("trouble_fmi2", &options) {
        Ok(trouble) => trouble,
        Err(error) => return error.to_string(),
    };
    let trouble = &mut *trouble;
    if place == INITIALIZATION {
        demand(trouble, place, what);
        return trouble.enter_initialization(0.0, None, None).unwrap_err().to_string();
    }
    start(trouble);
    let (inputs, outputs) = (plan(trouble, &["u"]), plan(trouble, &["y"]));
    let mut got = [0.0];
    for k in 0..5 {
        let time_s = f64::from(k);
        trouble.exchange(&inputs.groups, &[1.0], time_s, 1.0, &outputs.groups, &mut got).unwrap();
    }
    demand(trouble, place, what);
    let error = if place == STATE {
        trouble.keep_state().unwrap_err()
    } else {
        let mut step = |time_s| {
            trouble.exchange(&inputs.groups, &[1.0], time_s, 1.0, &outputs.groups, &mut got)
        };
        let mut stepped = step(5.0);
        // A process that closes its end may answer before that is noticed.
        for k in 6..2000 {
            if what != CLOSE || stepped.is_err() {
                break;
            }
            std::thread::sleep(Duration::from_millis(5));
            stepped = step(f64::from(k));
        }
        stepped.unwrap_err()
    };
    // The process stays gone, with the same error.
    if matches!(error, InstanceError::Process { .. }) {
        assert_eq!(trouble.step(6.0, 1.0).unwrap_err(), error);
        assert_eq!(trouble.keep_state().unwrap_err(), error);
        assert!(trouble.messages().is_empty());
    }
    error.to_string()
}

#[test]
fn a_crash_is_an_error_with_signal_and_function() {
    for (place, what, expected) in [
        (STEP, CRASH, "was ended by SIGSEGV in fmi2DoStep"),
        (STEP, ABORT, "was ended by SIGABRT in fmi2DoStep"),
        (STEP, EXIT, "ended by itself with exit status 0 in fmi2DoStep"),
        (SET, CRASH, "was ended by SIGSEGV in fmi2SetReal"),
        (GET, ABORT, "was ended by SIGABRT in fmi2GetReal"),
        (STATE, CRASH, "was ended by SIGSEGV in fmi2GetFMUstate"),
        (INITIALIZATION, EXIT, "ended by itself with exit status 0 in fmi2EnterInitializationMode"),
        (INSTANTIATE, CRASH, "was ended by SIGSEGV in fmi2Instantiate"),
        (INSTANTIATE, EXIT, "ended by itself with exit status 0 in fmi2Instantiate"),
    ] {
        let expected = format!("the process of trouble_fmi2.fmu {expected}");
        assert_eq!(meet(place, what, &apart()), expected);
    }
    // At the end of a stack, either the operating system or the runtime notices.
    let error = meet(STEP, OVERFLOW, &apart());
    let ends = ["SIGSEGV", "SIGABRT"].map(|signal| {
        format!("the process of trouble_fmi2.fmu was ended by {signal} in fmi2DoStep")
    });
    assert!(ends.contains(&error), "{error}");
}

#[test]
fn a_hang_ends_at_the_limit() {
    // The FMU hangs for ever: any answer shows that the time limit was kept.
    let options = OpenOptions { time_limit: Duration::from_secs(5), ..apart() };
    for what in [HANG, BUSY] {
        assert_eq!(
            meet(STEP, what, &options),
            "the process of trouble_fmi2.fmu gave no answer to fmi2DoStep for 5 s, and was ended; \
             --time-limit, or time_limit in a scenario, sets another limit"
        );
    }
    let options = OpenOptions { start_limit: Duration::from_secs(5), ..apart() };
    for place in [INSTANTIATE, INITIALIZATION] {
        let error = meet(place, HANG, &options);
        assert!(error.contains("for 5 s, and was ended"), "{error}");
    }
}

#[test]
fn a_hang_in_its_end_holds_nobody_up_for_longer() {
    // The FMU hangs for ever: the return of `drop` shows that the time limit was kept.
    let options = OpenOptions { time_limit: Duration::from_secs(5), ..apart() };
    for what in [HANG, CRASH, EXIT] {
        let mut trouble = try_open("trouble_fmi2", &options).unwrap();
        start(&mut *trouble);
        demand(&mut *trouble, FREE, what);
        drop(trouble);
    }
}

#[test]
fn a_failure_is_not_the_end_of_the_process() {
    let mut trouble = open("trouble_fmi2");
    let trouble = &mut *trouble;
    start(trouble);
    let (inputs, outputs) = (plan(trouble, &["u"]), plan(trouble, &["y"]));
    let mut got = [0.0];
    demand(trouble, STEP, DISCARD);
    let stepped =
        trouble.exchange(&inputs.groups, &[1.0], 0.0, 1.0, &outputs.groups, &mut got).unwrap();
    assert_eq!((stepped.time_s, stepped.outcome), (0.25, StepOutcome::Discarded));
    demand(trouble, STEP, FAIL);
    let kept = trouble.keep_state().unwrap();
    let error =
        trouble.exchange(&inputs.groups, &[1.0], 0.0, 1.0, &outputs.groups, &mut got).unwrap_err();
    assert_eq!(
        error.to_string(),
        "fmi2DoStep of trouble_fmi2.fmu answered error: it failed on demand"
    );
    trouble.restore_state(kept).unwrap();
    demand(trouble, STEP, 0);
    for k in 0..100 {
        let time_s = f64::from(k);
        trouble
            .exchange(&inputs.groups, &[time_s], time_s, 1.0, &outputs.groups, &mut got)
            .unwrap();
        assert_eq!(got, [time_s]);
    }
    demand(trouble, STEP, FLOOD);
    trouble.step(100.0, 1.0).unwrap();
    let messages = trouble.messages();
    assert_eq!(messages.last().unwrap().text, "99000 more messages were dropped");
    assert!(trouble.messages().is_empty());
}

#[test]
#[ignore = "run by what_an_fmu_prints_goes_to_standard_error"]
fn prints() {
    let mut trouble = open("trouble_fmi2");
    start(&mut *trouble);
    demand(&mut *trouble, STEP, PRINT);
    for k in 0..3 {
        trouble.step(f64::from(k), 1.0).unwrap();
    }
    assert_eq!(get(&mut *trouble, "y"), [0.0]);
}

#[test]
fn what_an_fmu_prints_goes_to_standard_error() {
    let output = passes_as_process("fmu_process::prints");
    let (out, error) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(!out.contains("noise"), "{out}");
    let noise = "noise on standard output, of a foreign FMU";
    // Once through C's streams and once past them, in each of three steps.
    assert_eq!(error.matches(noise).count(), 6, "{error}");
    assert_eq!(error.matches("noise on standard error").count(), 3, "{error}");
}

#[test]
fn an_fmu_that_closes_everything_is_lost_alone() {
    let error = meet(STEP, CLOSE, &apart());
    assert!(error.starts_with("the process of trouble_fmi2.fmu "), "{error}");
}

/// Returns the ids of the processes with this parent.
fn children_of(parent: u32) -> Vec<u32> {
    let stat = |path: &Path| -> Option<(u32, u32)> {
        let text = std::fs::read_to_string(path.join("stat")).ok()?;
        let pid = text.split(' ').next()?.parse().ok()?;
        let parent = text.rsplit(')').next()?.split_whitespace().nth(1)?.parse().ok()?;
        Some((pid, parent))
    };
    std::fs::read_dir("/proc")
        .unwrap()
        .filter_map(|entry| stat(&entry.unwrap().path()))
        .filter(|(_, of)| *of == parent)
        .map(|(pid, _)| pid)
        .collect()
}

#[test]
#[ignore = "run by nothing_is_left_behind"]
fn opens_and_closes() {
    let open_files = || std::fs::read_dir("/proc/self/fd").unwrap().count();
    let own = std::process::id();
    open("gain_fmi2");
    let before = open_files();
    for k in 0..20 {
        let mut gain = open("gain_fmi2");
        start(&mut *gain);
        gain.step(0.0, 1.0).unwrap();
        if k % 2 == 0 {
            drop(gain);
            let options = OpenOptions { time_limit: Duration::from_secs(3), ..apart() };
            meet(STEP, if k % 4 == 0 { CRASH } else { HANG }, &options);
        }
    }
    assert_eq!(open_files(), before);
    assert_eq!(children_of(own), [0; 0]);
}

#[test]
fn nothing_is_left_behind() {
    passes_as_process("fmu_process::opens_and_closes");
}

#[test]
#[ignore = "run by the_process_ends_with_the_one_that_it_serves, which ends it"]
fn hangs_for_long() {
    let options = OpenOptions { time_limit: Duration::from_mins(10), ..apart() };
    let mut idle = try_open("gain_fmi2", &options).unwrap();
    start(&mut *idle);
    meet(STEP, BUSY, &options);
}

#[test]
fn the_process_ends_with_the_one_that_it_serves() {
    let mut parent = octant_test_processes::start(
        test_as_process("fmu_process::hangs_for_long").stdout(Stdio::null()),
    );
    let until = Instant::now() + octant_test_processes::HANGS;
    let children = loop {
        let children = children_of(parent.id());
        if children.len() == 2 || Instant::now() > until {
            break children;
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    assert_eq!(children.len(), 2);
    // Until one of them hangs and the other waits.
    std::thread::sleep(Duration::from_millis(300));
    parent.kill().unwrap();
    parent.wait().unwrap();
    let until = Instant::now() + octant_test_processes::HANGS;
    let lives = |pid: &u32| Path::new("/proc").join(pid.to_string()).join("exe").exists();
    while children.iter().any(lives) {
        assert!(Instant::now() < until, "{children:?} live on");
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn several_run_at_once() {
    let threads: Vec<_> = (0..8u32)
        .map(|n| {
            std::thread::spawn(move || {
                let mut gain = open("gain_fmi2");
                let gain = &mut *gain;
                start(gain);
                let (inputs, outputs) = (plan(gain, &["u"]), plan(gain, &["y"]));
                let mut got = [0.0];
                for k in 0..200 {
                    let (time_s, u) = (f64::from(k), f64::from(n));
                    gain.exchange(&inputs.groups, &[u], time_s, 1.0, &outputs.groups, &mut got)
                        .unwrap();
                    assert_eq!(got, [2.0 * u * (time_s + 1.0)]);
                }
            })
        })
        .collect();
    for thread in threads {
        thread.join().unwrap();
    }
}

#[test]
fn an_instance_may_outlive_the_thread_that_made_it() {
    let mut gain = std::thread::spawn(|| open("gain_fmi2")).join().unwrap();
    std::thread::sleep(Duration::from_millis(50));
    start(&mut *gain);
    gain.step(0.0, 1.0).unwrap();
}

#[test]
fn a_program_that_is_none_is_said() {
    let no_such = OpenOptions { program: Some("/no/such/octant".into()), ..apart() };
    let error = try_open("gain_fmi2", &no_such).map(|_| ()).unwrap_err().to_string();
    assert!(
        error.starts_with("the process of gain_fmi2.fmu can't be started: /no/such/octant: "),
        "{error}"
    );
    let other = OpenOptions { program: Some("/bin/true".into()), ..apart() };
    let error = try_open("gain_fmi2", &other).map(|_| ()).unwrap_err().to_string();
    assert_eq!(error, "the process of gain_fmi2.fmu ended by itself with exit status 0");
}

#[test]
fn what_cannot_be_opened_is_said_as_it_is_here() {
    let said = |options: &OpenOptions| {
        let options = OpenOptions { instance_name: Some("nul\0".into()), ..options.clone() };
        try_open("gain_fmi2", &options).map(|_| ()).unwrap_err().to_string()
    };
    assert_eq!(said(&apart()), said(&here()));
}

#[test]
fn the_host_is_not_for_people() {
    // The guard, and the process that holds the FMU.
    for more in [&[][..], &["--unguarded"]] {
        let mut command = program(&["fmu", "host"]);
        let output = command.args(more).stdin(Stdio::null()).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(error.contains("octant fmu host is started by octant itself"), "{error}");
    }
}
