//! Faults in scenarios: their parsing, and the program's messages about invalid ones.

use octant_earth::units::DEG_PER_HOUR;
use octant_faults::catalogue::{Acts, Dimension};
use octant_faults::trigger::{Repeat, Signal, ThresholdSide, Trigger};
use octant_faults::{Channels, Station, Value, kinds};
use octant_sample::Mode;
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{Place, Problem, Scenario, fault_example};
use std::path::Path;

/// Four hours in eight positions and one of navigation, 200 Hz; with six positions as the baseline.
const HEAD: &str =
    "schema = 1\n[procedure.calibration]\n[procedure.navigation]\nduration = \"1 h\"\n";
/// Number of lines of the head.
const LINES: usize = 4;
const SPIKE: &str = "[[faults]]\nid = \"a\"\nkind = \"spike\"\nchannels = \"gyro x\"\n\
                     amplitude = \"10 deg/h\"\n";

fn parse(text: &str) -> Result<Scenario, Vec<Problem>> {
    Scenario::parse(text, "f.toml", Path::new(""), &[]).map_err(|error| error.problems)
}

/// Renders a spike with these lines after its own five.
fn spike(more: &str) -> String {
    format!("{HEAD}{SPIKE}{more}\n")
}

#[track_caller]
fn read(text: &str) -> Scenario {
    parse(text).unwrap_or_else(|problems| panic!("{text}: {problems:?}"))
}

#[track_caller]
fn trigger(trigger: &str) -> Trigger {
    let scenario = read(&spike(&format!("trigger = {{ {trigger} }}\nduration = \"1 s\"")));
    scenario.faults[0].spec.schedule.trigger.clone()
}

#[test]
fn every_form_of_a_trigger_is_read_into_epochs() {
    let (calibrating, navigating) = (Mode::Calibrating, Mode::Navigating);
    for (text, expected) in [
        ("at = \"5050 s\"", Trigger::Epoch(1_010_001)),
        ("at = \"0 s\"", Trigger::Epoch(1)),
        ("sample = 1010000", Trigger::Epoch(1_010_000)),
        (
            "position = 4, after = \"2 s\"",
            Trigger::Position { stop: 3, mode: calibrating, delay: 400 },
        ),
        (
            "moving_to = 5, after = \"7 samples\", phase = \"navigation\"",
            Trigger::Move { stop: 4, mode: navigating, delay: 7 },
        ),
        ("mode = \"navigating\"", Trigger::Mode { mode: navigating, delay: 0 }),
        (
            "when = \"nis above 25\"",
            Trigger::Condition {
                signal: Signal::Nis,
                comparison: ThresholdSide::Above,
                value: 25.0,
                delay: 0,
            },
        ),
        (
            "every = \"60 s\", from = \"10 s\", until = \"1 h\"",
            Trigger::Periodic { first: 2001, period: 12_000, last: Some(720_001) },
        ),
        ("poisson = \"6 min\"", Trigger::Poisson { first: 1, last: None, mean: 72_000.0 }),
        ("manual = true", Trigger::Manual),
    ] {
        assert_eq!(trigger(text), expected, "{text}");
    }
    // A rate instead of a mean time: 0.01 Hz is once in 100 s.
    let Trigger::Poisson { mean, .. } = trigger("poisson = \"0.01 Hz\"") else { panic!() };
    assert!((mean - 20_000.0).abs() < 1e-9, "{mean}");
}

#[test]
fn a_position_is_the_stop_of_its_first_visit() {
    let (mode, delay) = (Mode::Calibrating, 0);
    for (text, expected) in [
        // (180°, 90°) is the fifth position again: the first visit is (0°, 270°), the fifth stop.
        ("position = 5, counted = \"positions\"", Trigger::Position { stop: 4, mode, delay }),
        ("position = 6, counted = \"positions\"", Trigger::Position { stop: 7, mode, delay }),
        ("moving_to = 8, counted = \"positions\"", Trigger::Move { stop: 16, mode, delay }),
        ("position = 6, counted = \"stops\"", Trigger::Position { stop: 5, mode, delay }),
        (
            "position = 2, counted = \"positions\", phase = \"navigation\"",
            Trigger::Position { stop: 1, mode: Mode::Navigating, delay },
        ),
    ] {
        assert_eq!(trigger(text), expected, "{text}");
    }
    let more = "trigger = { position = 9, counted = \"positions\" }";
    let reason = ["found position 9", "the calibration has 8 positions"];
    assert_problem(more, (1, 24), ".trigger.position", &reason);
    let more = "trigger = { moving_to = 3, counted = \"positions\", phase = \"navigation\" }";
    let reason = ["found position 3", "the rotation in navigation has 2 positions"];
    assert_problem(more, (1, 25), ".trigger.moving_to", &reason);

    // Both methods have one schedule: the fifth position of the six is (90°, 90°), their seventh stop.
    let with_six = |trigger: &str| {
        spike(&format!("trigger = {{ {trigger} }}")) + "[baseline]\npositions = \"six\"\n"
    };
    let (.., message) = problem(&with_six("position = 5, counted = \"positions\""));
    for part in [
        "found position 5, which the calibration visits first at stop 5",
        "the calibration of the baseline at stop 7",
        "expected the number of a stop",
    ] {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }
    let (.., message) = problem(&with_six("position = 7, counted = \"positions\""));
    assert!(message.contains("the calibration of the baseline has 6 positions"), "{message}");
    let scenario = read(&with_six("position = 1, counted = \"positions\""));
    let first = Trigger::Position { stop: 0, mode, delay };
    assert_eq!(scenario.faults[0].spec.schedule.trigger, first);
}

#[test]
fn values_are_si_and_what_is_left_out_is_filled_in() {
    let text = format!(
        "{HEAD}[[faults]]\nid = \"first\"\nkind = \"spike\"\nchannels = [\"gyro x\", \"gyro z\"]\n\
         amplitude = \"10 deg/h\"\ntrigger = {{ at = \"10 s\" }}\nduration = \"20 samples\"\n\
         repeat = {{ times = 3, every = \"10 s\" }}\n\
         [[faults]]\nid = \"second\"\nkind = \"spike\"\nchannels = \"accelerometer\"\n\
         amplitude = \"1 g\"\ntrigger = {{ after_fault = \"first\", after = \"1 s\" }}\n"
    );
    let scenario = read(&text);
    let [first, second] = &scenario.faults[..] else { panic!() };
    let gyros = Channels::gyro(0).union(Channels::gyro(2));
    assert_eq!(first.spec.values.channels("channels"), Ok(gyros));
    assert_eq!(
        first.spec.values.get("amplitude"),
        Some(Value::Quantity(10.0 * DEG_PER_HOUR, Dimension::GyroBias))
    );
    assert_eq!(first.spec.schedule.duration, Some(20));
    assert_eq!(first.spec.schedule.repeat, Repeat::Times { times: 3, every: 2000 });
    assert_eq!(
        second.spec.values.get("amplitude"),
        Some(Value::Quantity(9.80665, Dimension::AccelBias))
    );
    let after = Trigger::After { fault: "first".to_owned(), delay: 200 };
    assert_eq!((&second.spec.schedule.trigger, second.spec.schedule.duration), (&after, None));
    assert_eq!(second.place, Place::File { line: LINES + 9, column: 1 });
}

#[test]
fn the_resolved_scenario_has_the_same_faults() {
    let text = format!(
        "{}\n{}[[faults]]\nid = \"b\"\nkind = \"spike\"\nchannels = \"gyro\"\namplitude = \"1 deg/s\"\n\
         trigger = {{ position = 4 }}\nduration = \"1 s\"\nrepeat = \"every time\"\n",
        spike("trigger = { every = \"60 s\" }\nduration = \"0.1 s\""),
        ""
    );
    let scenario = read(&text);
    let resolved =
        |scenario: &Scenario| scenario.to_resolved_toml(1, &DrawnValues::of(scenario, &Seeded(1)));
    let first = resolved(&scenario);
    // Defaults are written out, in the order in which faults act.
    assert!(first.contains("trigger = { position = 4, after = \"0 s\", phase = \"calibration\" }"));
    let again = read(&first);
    assert_eq!(resolved(&again), first);
    assert_eq!(again.faults.len(), 2);
    for (a, b) in scenario.faults.iter().zip(&again.faults) {
        assert_eq!((&a.spec.id, a.spec.kind.name), (&b.spec.id, b.spec.kind.name));
        assert_eq!(a.spec.values, b.spec.values);
        assert_eq!(a.spec.schedule, b.spec.schedule);
    }
}

#[test]
fn every_kind_has_an_example_that_parses_and_builds() {
    let mut wrong = Vec::new();
    for kind in kinds::all() {
        let example = fault_example(kind.name).unwrap();
        // Faults of the wire need one; their name tells which.
        let port = if kind.name.starts_with("can-") { "can:can0" } else { "serial:/dev/ttyUSB0" };
        let endpoint = format!("[endpoint]\nuri = {port:?}\n");
        let supply = "[power]\nport = \"tcp:psu\"\nvoltage = \"24 V\"\ncurrent_limit = \"2 A\"\n";
        let powered = format!("{endpoint}{supply}");
        let more = match kind.acts {
            Acts::Wire => endpoint.as_str(),
            // Without the clock nothing can be late.
            Acts::Host => "[realtime]\npace = \"clock\"\n",
            Acts::Power => powered.as_str(),
            _ => "",
        };
        let scenario = match parse(&format!("{HEAD}{more}{example}")) {
            Ok(scenario) => scenario,
            Err(problems) => {
                wrong.push(format!("{example}{problems:?}"));
                continue;
            }
        };
        let spec = &scenario.faults[0].spec;
        assert_eq!(spec.kind.name, kind.name);
        for parameter in kind.parameters {
            assert!(example.contains(&format!("\n{} = ", parameter.name)), "{example}");
            assert!(spec.values.get(parameter.name).is_some(), "{example}");
        }
        Station::new(std::slice::from_ref(spec), &scenario.fault_setup(1)).unwrap();
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

/// Returns the only problem of a text: line, column, path and message.
#[track_caller]
fn problem(text: &str) -> (usize, usize, String, String) {
    let problems = match parse(text) {
        Ok(_) => panic!("no problem was found in {text}"),
        Err(problems) => problems,
    };
    assert_eq!(problems.len(), 1, "{text}: {problems:?}");
    let Problem { place, path, message } = problems.into_iter().next().unwrap();
    let Place::File { line, column } = place else { panic!("{place:?}") };
    (line, column, path, message)
}

/// Checks the problem of a spike with lines after its own: the line among those (-4: the fault's
/// first), column, path and message.
#[track_caller]
fn assert_problem(more: &str, at: (i64, usize), path: &str, expected: &[&str]) {
    let (line, column, found, message) = problem(&spike(more));
    assert_eq!((line as i64 - LINES as i64 - 5, column), at, "{more}: {message}");
    assert_eq!(found, format!("faults[0]{path}"), "{message}");
    for part in expected {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }
}

#[test]
fn mistakes_are_told_where_they_are() {
    let at = "trigger = { at = \"5 s\" }\n";
    for (more, place, path, expected) in [
        ("duration = \"1 s\"", (-4, 1), ".trigger", &["missing", "at, sample, position"][..]),
        (
            "trigger = \"5 s\"",
            (1, 11),
            ".trigger",
            &["found \"5 s\", expected a table with one of"],
        ),
        ("trigger = { }", (1, 11), ".trigger", &["found no trigger", "at, sample"]),
        ("trigger = { att = \"5 s\" }", (1, 13), ".trigger.att", &["did you mean \"at\"?"]),
        (
            "trigger = { at = \"5 s\", sample = 7 }",
            (1, 11),
            ".trigger",
            &["found at and sample", "exactly one"],
        ),
        (
            "trigger = { at = \"5 s\", after = \"1 s\" }",
            (1, 25),
            ".trigger.after",
            &["unknown key", "known here: at"],
        ),
        (
            "trigger = { position = 4, from = \"1 s\" }",
            (1, 27),
            ".trigger.from",
            &["unknown key", "position, after, phase"],
        ),
        ("trigger = { at = \"5 deg\" }", (1, 18), ".trigger.at", &["an angle; expected a time"]),
        ("trigger = { sample = 0 }", (1, 22), ".trigger.sample", &["found 0", "of 1 or more"]),
        (
            "trigger = { when = \"lattitude error above 1 deg\" }",
            (1, 20),
            ".trigger.when",
            &["unknown signal \"lattitude error\"", "did you mean \"latitude error\"?"],
        ),
        ("trigger = { manual = false }", (1, 22), ".trigger.manual", &["expected true"]),
        (
            "trigger = { every = \"60 s\", from = \"20 s\", until = \"10 s\" }\nduration = \"1 s\"",
            (1, 52),
            ".trigger.until",
            &["before from"],
        ),
    ] {
        assert_problem(more, place, path, expected);
    }
    for (more, place, path, expected) in [
        ("chanels = \"gyro x\"", (2, 1), ".chanels", &["did you mean \"channels\"?"][..]),
        ("duration = \"0 s\"", (2, 12), ".duration", &["above 0"]),
        ("duration = \"1 ms\"", (2, 12), ".duration", &["less than a sample of 0.005 s"]),
        ("duration = \"1.5 samples\"", (2, 12), ".duration", &["whole number of samples"]),
        ("recovery = \"1 s\"", (2, 12), ".recovery", &["doesn't fade"]),
        ("repeat = \"often\"", (2, 10), ".repeat", &["found \"often\"", "possible: every time"]),
        ("repeat = \"every time\"", (2, 10), ".repeat", &["a time comes once"]),
        (
            "repeat = { times = 3, every = \"10 s\" }",
            (-4, 1),
            ".duration",
            &["without it the fault lasts to the end of the run"],
        ),
        (
            "duration = \"10 s\"\nrepeat = { times = 3, every = \"10 s\" }",
            (3, 10),
            ".repeat",
            &["every 10 s comes before the fault is over"],
        ),
        (
            "repeat = { times = 1, every = \"10 s\" }\nduration = \"1 s\"",
            (2, 20),
            ".repeat.times",
            &["found 1"],
        ),
    ] {
        assert_problem(&format!("{at}{more}"), place, path, expected);
    }
}

#[test]
fn kinds_and_their_values_are_checked() {
    let fault = |lines: &str| {
        problem(&format!("{HEAD}[[faults]]\nid = \"a\"\n{lines}\ntrigger = {{ at = \"5 s\" }}\n"))
    };
    let (line, column, path, message) = fault("kind = \"spik\"");
    assert_eq!((line, column, path.as_str()), (LINES + 3, 8, "faults[0].kind"));
    assert!(message.contains("did you mean \"spike\"?"), "{message}");
    let (line, column, path, message) = fault("");
    assert_eq!((line, column, path.as_str()), (LINES + 1, 1, "faults[0].kind"));
    assert!(message.starts_with("missing, expected one of"), "{message}");
    let (line, column, _, message) =
        fault("kind = \"spike\"\nchannels = [\"gyro x\", \"gyro w\"]\namplitude = \"1 deg/h\"");
    assert_eq!((line, column), (LINES + 4, 23));
    assert!(message.contains("possible: gyro x"), "{message}");
    let (line, column, _, message) =
        fault("kind = \"spike\"\nchannels = \"gyro x\"\namplitude = \"0 deg/h\"");
    assert_eq!((line, column), (LINES + 5, 13));
    assert!(message.contains("other than 0"), "{message}");
    // The kind's own check of combined values, at the value that it names.
    let (line, column, path, message) =
        fault("kind = \"spike\"\nchannels = \"gyro x\"\namplitude = \"1 ug\"");
    assert_eq!((line, column, path.as_str()), (LINES + 5, 13, "faults[0].amplitude"));
    assert!(message.contains("gyros are among the channels"), "{message}");
    let (line, column, path, message) = problem(&format!(
        "{}{SPIKE}trigger = {{ at = \"6 s\" }}\n",
        spike("trigger = { at = \"5 s\" }")
    ));
    assert_eq!((line, column, path.as_str()), (LINES + 8, 6, "faults[1].id"));
    assert!(message.contains("a second time"), "{message}");
}

#[test]
fn a_fault_that_cannot_fire_is_refused_with_the_reason() {
    for (trigger, column, key, expected) in [
        ("at = \"6 h\"", 18, ".at", &["would set in at 21600 s", "the run ends at 18000 s"][..]),
        ("sample = 3600001", 22, ".sample", &["the run ends at 18000 s"]),
        ("position = 20", 24, ".position", &["stop 20", "has 19 stops"]),
        ("moving_to = 1", 25, ".moving_to", &["at stop 1 already"]),
        ("position = 40, phase = \"navigation\"", 24, ".position", &["the run ends at 18000 s"]),
        ("position = 19, after = \"5 h\"", 24, ".position", &["at the earliest"]),
        ("mode = \"aligning\"", 20, ".mode", &["its attitude is handed over"]),
        ("every = \"1 s\", from = \"5 h\"", 21, ".every", &["the run ends at 18000 s"]),
        ("after_fault = \"b\"", 27, ".after_fault", &["found \"b\"", "faults: a"]),
        ("after_fault = \"a\"", 27, ".after_fault", &["lasts to the end of the run"]),
        ("manual = true, fire = [\"9 h\"]", 35, ".fire", &["found 32400 s"]),
        ("manual = true, fire = [\"1 s\", \"9 s\"]", 11, "", &["needs repeat = \"every time\""]),
    ] {
        let more = format!("trigger = {{ {trigger} }}");
        let more = if key == ".every" { format!("{more}\nduration = \"0.5 s\"") } else { more };
        assert_problem(&more, (1, column), &format!(".trigger{key}"), expected);
    }
    let navigation = "[procedure.navigation]\nduration = \"1 h\"\n";
    let text = spike("trigger = { mode = \"navigating\" }").replace(navigation, "");
    let (.., message) = problem(&text);
    assert!(message.contains("the run never is navigating, it has no navigation"), "{message}");
    // The baseline has six positions, 17 stops.
    let text = spike("trigger = { position = 18 }") + "[baseline]\npositions = \"six\"\n";
    let (.., message) = problem(&text);
    assert!(message.contains("the calibration of the baseline has 17 stops"), "{message}");
    let circle = format!(
        "{}{}trigger = {{ after_fault = \"a\" }}\nduration = \"1 s\"\n",
        spike("trigger = { after_fault = \"b\" }\nduration = \"1 s\""),
        SPIKE.replace("\"a\"", "\"b\"")
    );
    let (.., message) = problem(&circle);
    assert!(message.contains("wait for each other and nothing starts them"), "{message}");
    let itself = spike("trigger = { after_fault = \"a\" }\nduration = \"1 s\"");
    let (.., message) = problem(&itself);
    assert!(message.contains("nothing starts"), "{message}");
    // Delay that no buffer holds: 4096 samples are 20.48 s.
    let late = |delay: &str| {
        format!(
            "{HEAD}[[faults]]\nid = \"a\"\nkind = \"late-delivery\"\ndelay = \"{delay}\"\n\
             trigger = {{ at = \"5 s\" }}\nduration = \"1 min\"\n"
        )
    };
    read(&late("20 s"));
    let (line, column, path, message) = problem(&late("30 s"));
    assert_eq!((line, column, path.as_str()), (LINES + 4, 9, "faults[0].delay"), "{message}");
    // In a replay nothing inside the instrument can be changed any more.
    let text =
        format!("{HEAD}{}[source]\nuri = \"replay:x.mcap\"\n", fault_example("shock").unwrap());
    let (line, column, path, message) = problem(&text);
    assert_eq!((line, column, path.as_str()), (LINES + 3, 8, "faults[0].kind"));
    assert!(message.contains("acts inside the simulated instrument"), "{message}");
    // A recording has no truth.
    let text = spike("trigger = { when = \"true azimuth above 10 deg\" }")
        + "[source]\nuri = \"replay:x.mcap\"\n";
    let (.., path, message) = problem(&text);
    assert_eq!(path, "faults[0].trigger.when");
    assert!(message.contains("the source is a recording"), "{message}");
}

#[test]
fn a_manual_fault_is_fired_from_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.toml");
    std::fs::write(&path, spike("trigger = { manual = true }\nduration = \"1 s\"")).unwrap();
    let load = |fires: &[&str]| {
        let fires: Vec<String> = fires.iter().map(|fire| (*fire).to_owned()).collect();
        Scenario::load_fired(&path, &[], &fires)
    };
    let silent = load(&[]).unwrap();
    assert!(silent.faults[0].fires.is_empty());
    assert!(silent.warnings()[0].contains("no --fire a=TIME does"), "{:?}", silent.warnings());
    let fired = load(&["a=10 s"]).unwrap();
    assert_eq!((&fired.faults[0].fires[..], fired.warnings().len()), (&[2001][..], 0));
    // The resolved scenario states it, and makes the same run.
    let resolved = fired.to_resolved_toml(1, &DrawnValues::of(&fired, &Seeded(1)));
    assert_eq!(read(&resolved).faults[0].fires, [2001]);
    for (fire, expected) in [
        ("a", "--fire a: expected ID=TIME"),
        ("b=10 s", "no fault has the id \"b\", faults: a"),
        ("a=10", "--fire a=10: faults[0].trigger.fire[0]: found the bare number 10"),
        ("a=10 h", "the run ends at 18000 s"),
    ] {
        let error = load(&[fire]).unwrap_err().to_string();
        assert!(error.contains(expected), "{fire}: {error}");
    }
    std::fs::write(&path, spike("trigger = { at = \"1 s\" }")).unwrap();
    let error = load(&["a=10 s"]).unwrap_err().to_string();
    assert!(error.contains("the trigger of fault \"a\" is not manual"), "{error}");
}
