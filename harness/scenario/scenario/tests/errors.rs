//! Messages about invalid scenarios: place, path, found, expected.

use octant_scenario::{Place, Problem, Scenario};
use proptest::prelude::*;
use std::path::Path;

const HEAD: &str = "schema = 1\n[procedure.calibration]\n";

fn problems_with(text: &str, overrides: &[&str]) -> Vec<Problem> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    match Scenario::parse(text, "test.toml", Path::new(""), &overrides) {
        Ok(_) => Vec::new(),
        Err(error) => error.problems,
    }
}

/// Returns the only problem of a text: place, path and message.
fn problem(text: &str) -> (Place, String, String) {
    let problems = problems_with(text, &[]);
    assert_eq!(problems.len(), 1, "{text}: {problems:?}");
    let Problem { place, path, message } = problems.into_iter().next().unwrap();
    (place, path, message)
}

fn at(line: usize, column: usize) -> Place {
    Place::File { line, column }
}

#[track_caller]
fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }
}

#[test]
fn a_key_that_is_unknown_is_told_with_the_nearest_and_the_list() {
    let (place, path, message) = problem(&format!("{HEAD}  durration = \"12 h\"\n"));
    assert_eq!((place, path.as_str()), (at(3, 3), "procedure.calibration.durration"));
    assert_says(
        &message,
        &["unknown key", "did you mean \"duration\"?", "positions, stops, name, passes"],
    );
}

#[test]
fn a_quantity_of_another_dimension_is_told_with_the_unit_expected() {
    let (place, path, message) = problem(&format!("{HEAD}duration = \"12 deg\"\n"));
    assert_eq!((place, path.as_str()), (at(3, 12), "procedure.calibration.duration"));
    assert_eq!(message, "found \"12 deg\", an angle; expected a time such as \"12 h\"");
}

#[test]
fn a_bare_number_is_told_with_an_example() {
    let (place, path, message) = problem("schema = 1\n[procedure.calibration]\nduration = 12\n");
    assert_eq!((place, path.as_str()), (at(3, 12), "procedure.calibration.duration"));
    assert_eq!(message, "found the bare number 12, expected a time such as \"12 h\"");
}

#[test]
fn an_unknown_unit_is_told_with_the_nearest() {
    let (.., message) = problem(&format!("{HEAD}[imu]\ngyro_bias = {{ normal = \"1 degs/h\" }}\n"));
    assert_says(&message, &["\"degs\"", "did you mean \"deg\"?", "\"0.005 deg/h\""]);
}

#[test]
fn a_newer_missing_or_older_schema_is_refused_in_plain_words() {
    let (place, path, message) = problem("schema = 2\n[procedure.calibration]\n");
    assert_eq!((place, path.as_str()), (at(1, 10), "schema"));
    assert_says(&message, &["version 2", "reads version 1", "a newer Octant"]);
    let (_, path, message) = problem("[procedure.calibration]\n");
    assert_eq!(path, "schema");
    assert_says(&message, &["missing", "expected 1"]);
    assert_says(&problem("schema = 0\n[procedure.calibration]\n").2, &["version 0", "expected 1"]);
}

#[test]
fn what_is_not_toml_is_told_with_its_place() {
    let (place, path, message) = problem("schema = 1\n[site\nlatitude = 3\n");
    assert!(matches!(place, Place::File { line: 2, .. }), "{place:?}");
    assert_eq!(path, "");
    assert_says(&message, &["not TOML"]);
}

#[test]
fn every_problem_is_told_at_once() {
    let text = format!("{HEAD}duration = 4\nfoo = 1\n[site]\nlatitude = \"95 deg\"\n");
    let problems = problems_with(&text, &[]);
    assert_eq!(problems.len(), 3, "{problems:?}");
    assert!(problems.iter().any(|p| p.message.contains("within ±89.3 deg")), "{problems:?}");
}

#[test]
fn a_duration_without_room_for_the_dwells_is_told_with_the_figures() {
    // 16 moves of 90° at 10 °/s and 10 °/s² take 10 s each; 17 dwells of a second at least.
    let six = |duration: &str| {
        let text = format!("{HEAD}positions = \"six\"\nduration = \"{duration}\"\n");
        problems_with(&text, &[])
    };
    assert!(six("177 s").is_empty());
    let problem = six("176 s").remove(0);
    assert_eq!(
        (problem.place, problem.path.as_str()),
        (at(4, 12), "procedure.calibration.duration")
    );
    assert_says(
        &problem.message,
        &["176 s", "17 stops", "160.0 s", "16.0 s is left", "0.94 s each", "177 s or more"],
    );
}

#[test]
fn periods_that_do_not_fit_the_sample_period_are_refused() {
    let (_, path, message) =
        problem(&format!("{HEAD}[procedure.calibration.aiding]\nperiod = \"7 ms\"\n"));
    assert_eq!(path, "procedure.calibration.aiding.period");
    assert_says(&message, &["multiple of the sample period, 5000000 ns"]);
    assert_eq!(problem(&format!("{HEAD}[imu]\nrate = \"20 kHz\"\n")).1, "imu.rate");
    assert_eq!(problem(&format!("{HEAD}[record]\nrate = \"3 Hz\"\n")).1, "record.rate");
}

#[test]
fn the_sigma_has_the_unit_of_its_reference() {
    let aiding = "[procedure.calibration.aiding]\n";
    let (_, path, message) = problem(&format!("{HEAD}{aiding}sigma = \"0.15 m\"\n"));
    assert_eq!(path, "procedure.calibration.aiding.sigma");
    assert_says(&message, &["expected a velocity", "zero-velocity"]);
}

#[test]
fn what_is_said_about_a_port_is_checked_before_it_is_opened() {
    let port = |uri: &str| problem(&format!("{HEAD}[endpoint]\nuri = {uri:?}\n"));
    let (.., message) = port("seral:/dev/ttyS0");
    assert_says(&message, &["found \"seral:/dev/ttyS0\"", "did you mean \"serial\"?"]);
    let (_, path, message) = port("serial:/dev/ttyS0?boud=9600");
    assert_eq!(path, "endpoint.uri");
    assert_says(&message, &["found option \"boud\" of serial:", "expected baud?"]);
    let (.., message) = port("slcan:/dev/ttyACM0");
    assert_says(&message, &["found bitrate=nothing", "slcan has a command for no other"]);
    let (_, path, message) = port("tcp:0.0.0.0:5005?listen=1");
    assert_eq!(path, "endpoint.uri");
    assert_says(&message, &["expected tcp:HOST:PORT alone", "an instrument that connects"]);
    let link = |more: &str| {
        problem(&format!(
            "{HEAD}[endpoint]\nuri = \"udp:localhost:5005\"\n[endpoint.link]\n{more}\n"
        ))
    };
    let (_, path, message) = link("repeat = \"6 s\"");
    assert_eq!(path, "endpoint.link.repeat");
    assert_says(&message, &["given up before it is asked for again"]);
    let (.., message) = problem(&format!("{HEAD}[endpoint.link]\nanswer = \"1 s\"\n"));
    assert_says(&message, &["without effect", "endpoint.uri names no device"]);
}

#[test]
fn stamps_by_a_time_scale_have_what_they_need_and_nothing_without_effect() {
    let live = |more: &str| {
        let source = "[source]\nuri = \"udp:7000\"\n[source.live]\nprotocol = \"novatel\"\n";
        problem(&format!("{HEAD}{source}{more}\n"))
    };
    let (_, path, message) = live("stamps = \"gps\"");
    assert_eq!(path, "source.live.stamps");
    assert_says(&message, &["stamps_within is missing"]);
    let scale = "stamps_within = \"1 us\"\nstamps =";
    let (.., message) = live(&format!("pps = \"/dev/pps0\"\n{scale} \"gps\""));
    assert_says(&message, &["beside source.live.pps", "expected one of both"]);
    let (.., message) = live(&format!("host_clock = \"/dev/ptp0\"\n{scale} \"tai\""));
    assert_says(&message, &["host_within is missing"]);
    let card = "host_clock = \"/dev/ptp0\"\nhost_within = \"1 us\"";
    let (.., message) = live(&format!("{card}\n{scale} \"utc\""));
    assert_says(&message, &["tai_offset is missing"]);
    for (more, key) in [
        (format!("tai_offset = 37\n{scale} \"utc\""), "tai_offset"),
        (format!("tai_offset = 37\n{card}\n{scale} \"tai\""), "tai_offset"),
        ("host_within = \"1 us\"".to_owned(), "host_within"),
        ("host_clock = \"/dev/ptp0\"".to_owned(), "host_clock"),
        ("stamps_within = \"1 us\"".to_owned(), "stamps_within"),
    ] {
        let (_, path, message) = live(&more);
        assert_eq!(path, format!("source.live.{key}"));
        assert_says(&message, &["without effect"]);
    }
}

#[test]
fn what_is_said_about_an_fmu_is_checked_before_the_fmu_is_read() {
    let fmu = |text: &str| problem(&format!("{HEAD}[source]\nuri = \"fmu:a.fmu\"\n{text}"));
    let (place, path, message) = fmu("[source.fmu.map]\ngyro.rat = \"w\"\n");
    assert_eq!((place, path.as_str()), (at(6, 6), "source.fmu.map.gyro.rat"));
    assert_says(&message, &["unknown key", "did you mean \"rate\"?"]);
    let (_, path, message) = fmu("[source.fmu.map]\ngyro.rate = [\"x\", \"y\"]\n");
    assert_eq!(path, "source.fmu.map.gyro.rate");
    assert_says(&message, &["found 2 entries", "array variable, or 3 entries"]);
    let (_, path, message) =
        fmu("[source.fmu.map]\ngyro.rate = { variable = \"w\", unit = \"m\" }\n");
    assert_eq!(path, "source.fmu.map.gyro.rate.unit");
    assert_says(&message, &["found \"m\"", "an angular rate such as"]);
    let (_, path, message) = fmu("[source.fmu.map]\ncase.roll = \"r\"\ngyro.rate = \"w\"\n");
    assert_eq!(path, "source.fmu.map.gyro.rate");
    assert_says(&message, &["beside case.roll", "and not both"]);
    let (_, path, message) = fmu("[source.fmu.map]\ncase.roll = \"r\"\n");
    assert_eq!(path, "source.uri");
    assert_says(&message, &["moves the case", "motion.kind is \"static\""]);
    let (_, path, message) = fmu("[source.fmu]\nstep = \"3 ms\"\n");
    assert_eq!(path, "source.fmu.step");
    assert_says(&message, &["found \"3 ms\"", "5000000 ns, divided by a whole number"]);
    let (_, path, message) = fmu("[source.fmu]\nprocess = \"shared\"\ntime_limit = \"3 s\"\n");
    assert_eq!(path, "source.fmu.time_limit");
    assert_says(&message, &["without effect", "nothing can end a call"]);
    let (_, path, message) = fmu("[source.fmu]\nparameters = { a = [[1]] }\n");
    assert_eq!(path, "source.fmu.parameters.a");
    assert_says(&message, &["found an array of 1"]);
    let (_, path, message) = problem(&format!("{HEAD}[source.fmu]\nprocess = \"own\"\n"));
    assert_eq!(path, "source.fmu");
    assert_says(&message, &["without effect", "source.uri is not fmu:FILE"]);
    let (_, path, message) = fmu(
        "[[faults]]\nid = \"a\"\nkind = \"gimbal-slip\"\ngimbal = \"azimuth\"\nangle = \"1 deg\"\n\
         trigger = { at = \"5 s\" }\n",
    );
    assert_eq!(path, "faults[0].kind");
    assert_says(&message, &["inside the simulated instrument", "the source is an FMU"]);
}

#[test]
fn a_key_without_effect_is_refused() {
    let (_, path, message) = problem(&format!("{HEAD}[motion.ship]\npreset = \"severe\"\n"));
    assert_eq!(path, "motion.ship");
    assert_says(&message, &["without effect", "static"]);
    let (_, path, _) =
        problem(&format!("{HEAD}[procedure.calibration.least_squares]\ngyro = \"earth-rate\"\n"));
    assert_eq!(path, "procedure.calibration.least_squares");
}

#[test]
fn distributions_are_one_of_three_with_the_right_number_of_entries() {
    let imu = |text: &str| problem(&format!("{HEAD}[imu]\n{text}\n")).2;
    assert_says(&imu("gyro_bias = {}"), &["found 0 keys", "normal, uniform, constant"]);
    let both = "gyro_scale = { normal = \"1 ppm\", uniform = \"1 ppm\" }";
    assert_says(&imu(both), &["found 2 keys", "exactly one"]);
    assert_says(
        &imu("gyro_bias = { constant = [\"1 deg/h\"] }"),
        &["found 1 entries", "expected 3"],
    );
}

#[test]
fn more_stops_than_64_are_refused_and_none_too() {
    let stops = vec!["{}"; 65].join(", ");
    assert_says(&problem(&format!("{HEAD}stops = [{stops}]\n")).2, &["65 entries", "1 to 64"]);
    assert_says(&problem(&format!("{HEAD}stops = []\n")).2, &["found 0 entries"]);
}

#[test]
fn a_limit_is_in_the_unit_of_its_measure() {
    let requirement = |limit: &str| {
        format!(
            "{HEAD}[[requirements]]\nid = \"A\"\ntext = \"t\"\n\
             measure = \"navigation.radial_error_nmi.max\"\nlimit = {limit}\n"
        )
    };
    let parse = |limit| Scenario::parse(&requirement(limit), "f", Path::new(""), &[]);
    assert_eq!(parse("0.8").unwrap().requirements[0].check.limit, 0.8);
    assert_eq!(parse("\"0.8 nmi\"").unwrap().requirements[0].check.limit, 0.8);
    assert_eq!(parse("\"3704 m\"").unwrap().requirements[0].check.limit, 2.0);
    assert_says(&problem(&requirement("\"3 arcmin\"")).2, &["comparable with nmi"]);
}

#[test]
fn a_measure_that_no_run_can_have_is_refused_with_the_nearest() {
    let requirement = |measure: &str| {
        let head = format!("{HEAD}[[requirements]]\nid = \"A\"\ntext = \"t\"\n");
        problem(&format!("{head}measure = \"{measure}\"\nlimit = 1\n"))
    };
    let (place, path, message) = requirement("navigaton.radial_error_nmi.max");
    assert_eq!((place, path.as_str()), (at(6, 11), "requirements[0].measure"));
    assert_says(&message, &["the summary has no \"navigaton\"", "did you mean \"navigation\"?"]);
    let (_, _, message) = requirement("|calibration.parameters.g_zx.eror|");
    assert_says(&message, &["calibration.parameters.g_zx has no", "did you mean \"error\"?"]);
    let (_, _, message) = requirement("calibration.parameters.g_zq.error");
    assert_says(&message, &["calibration.parameters has no \"g_zq\"", "did you mean"]);
    assert_says(&requirement("navigation.radial_error_nmi").2, &["is a table", "rate_per_h"]);
    assert_says(&requirement("calibration.nis_mean.max").2, &["is a number and has no \"max\""]);
}

#[test]
fn a_file_that_is_not_there_is_told_as_such() {
    let error = Scenario::load(Path::new("nosuch.toml"), &[]).unwrap_err().to_string();
    assert!(error.starts_with("failed to read nosuch.toml: "), "{error}");
}

#[test]
fn set_takes_toml_and_texts_without_quotes_and_refuses_unknown_keys() {
    let set = |argument: &str| {
        Scenario::parse(HEAD, "f", Path::new(""), &[argument.to_owned()]).map_err(|e| e.to_string())
    };
    let calibration = |argument| set(argument).unwrap().calibration.unwrap();
    assert_eq!(calibration("procedure.calibration.duration=12 h").duration_s, 43200.0);
    assert_eq!(calibration("procedure.calibration.duration=\"6 h\"").duration_s, 21600.0);
    assert_eq!(calibration("procedure.calibration.passes=2").sequence.passes(), 2);
    let own = calibration("procedure.calibration.stops=[{roll=\"90 deg\"}]");
    assert_eq!(own.sequence.stops().len(), 1);
    assert_eq!(set("seed=7").unwrap().seed, 7);
    assert!(set("screening.gate=off").unwrap().screening.gate.is_none());
    assert_eq!(set("screening.gate.nis=16").unwrap().screening.gate.unwrap().nis, 16.0);
    assert_eq!(set("imu.gyro_bias.uniform=1 deg/h").map(|_| ()), Ok(()));
    assert_says(
        &set("procedure.calibraton.duration=12 h").unwrap_err(),
        &["--set procedure.calibraton.duration=12 h", "did you mean \"calibration\"?"],
    );
    assert_says(&set("procedure.calibration.duration=12 m").unwrap_err(), &["--set", "a length"]);
    assert_says(&set("nonsense").unwrap_err(), &["expected KEY=VALUE"]);
}

#[test]
fn messages_name_file_line_and_column() {
    let error = Scenario::parse(
        "schema = 1\nseed = -1\n[procedure.calibration]\n",
        "a.toml",
        Path::new(""),
        &[],
    );
    let text = error.unwrap_err().to_string();
    assert!(text.starts_with("a.toml:2:8: seed: found -1, expected a whole number"), "{text}");
}

proptest! {
    #[test]
    fn any_text_is_parsed_without_a_panic(text in "\\PC*") {
        let _ = problems_with(&text, &[]);
        let _ = problems_with(HEAD, &[&text]);
    }

    #[test]
    fn any_value_of_a_shipped_key_is_parsed_without_a_panic(
        line in 0usize..400,
        value in prop_oneof![
            "\\PC{0,12}",
            Just("\"1e308 h\"".to_owned()),
            Just("nan".to_owned()),
            Just("-inf".to_owned()),
            Just("9223372036854775807".to_owned()),
            Just("0xffff_ffff_ffff_ffff".to_owned()),
            Just("1979-05-27".to_owned()),
            Just("[[[[{ a = 1 }]]]]".to_owned()),
            Just("\"1e-300 s\"".to_owned()),
        ],
    ) {
        let tour = octant_scenario::tour();
        let lines: Vec<&str> = tour.lines().collect();
        let line = line * lines.len() / 400;
        let changed = lines[line].split_once(" = ").map(|(key, _)| format!("{key} = {value}"));
        let mut all: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        if let Some(changed) = changed {
            all[line] = changed.trim_start_matches("#: ").to_owned();
            let _ = problems_with(&all.join("\n"), &[]);
        }
    }
}

#[test]
fn what_can_not_be_asked_for_twice_or_at_another_time_is_refused() {
    let instrument = "[source]\nuri = \"udp:7000\"\n[source.live]\nprotocol = \"vectornav\"\n";
    let navigation = "[procedure.navigation]\nduration = \"10 s\"\n";
    let counts = "gyro_count = \"1e-4 arcsec\"\naccel_count = \"1e-6 m/s\"\n";
    let (_, path, message) = problem(&format!("schema = 1\n{navigation}{instrument}{counts}"));
    assert_eq!(path, "source.live.gyro_count");
    assert_says(&message, &["\"vectornav\" has a scale of its own", "\"novatel\""]);
    let receiver = instrument.replace("vectornav", "novatel");
    assert!(problems_with(&format!("schema = 1\n{navigation}{receiver}{counts}"), &[]).is_empty());
    let half = "accel_count = \"1e-6 m/s\"\n";
    let (_, path, message) = problem(&format!("schema = 1\n{navigation}{receiver}{half}"));
    assert_eq!(path, "source.live.accel_count");
    assert_says(&message, &["source.live.gyro_count is missing"]);
    for port in ["tcp:unit:7000", "tcp:0.0.0.0:7000?listen=1"] {
        let fine = instrument.replace("udp:7000", port);
        assert!(
            problems_with(&format!("schema = 1\n{navigation}{fine}"), &[]).is_empty(),
            "{port}"
        );
    }
    let (_, path, message) = problem(&format!(
        "schema = 1\n{navigation}{}",
        instrument.replace("udp:7000", "exec:./unit")
    ));
    assert_eq!(path, "source.uri");
    assert_says(&message, &["found \"exec:./unit\""]);
    let clock = "[realtime]\npace = \"clock\"\n";
    let fine = format!("schema = 1\n{navigation}{instrument}");
    assert!(problems_with(&fine, &[]).is_empty());
    let (place, path, message) = problem(&format!("{fine}{clock}"));
    assert_eq!((place, path.as_str()), (at(9, 8), "realtime.pace"));
    assert_says(&message, &["a clock of its own", "expected \"free\""]);
    let calibration = "schema = 1\n[procedure.calibration]\nduration = \"1 h\"\n";
    let (_, path, message) =
        problem(&format!("{calibration}{instrument}[baseline]\npositions = \"six\"\n"));
    assert_eq!(path, "baseline");
    assert_says(&message, &["the same samples again", "replay:FILE"]);
    let device = "[endpoint]\nuri = \"udp:host:7000\"\n[endpoint.link]\nreconnect = \"2 s\"\n";
    let fine = format!("schema = 1\n{navigation}{device}");
    assert!(problems_with(&fine, &[]).is_empty());
    let (_, path, message) = problem(&format!("{fine}{clock}"));
    assert_eq!(path, "endpoint.link.reconnect");
    assert_says(&message, &["ends the run", "\"0 s\""]);
}

#[test]
fn sensors_quieter_than_the_linear_filter_are_warned_of() {
    let warnings_at = |rate: &str, gyro: &str, accel: &str| {
        let text = format!(
            "{HEAD}[imu]\nrate = \"{rate} Hz\"\nangle_random_walk = \"{gyro} deg/sqrt(h)\"\nvelocity_random_walk = \"{accel} ug/sqrt(Hz)\"\n"
        );
        Scenario::parse(&text, "test.toml", Path::new(""), &[]).unwrap().warnings()
    };
    let warnings = |gyro, accel| warnings_at("20", gyro, accel);
    assert_eq!(warnings_at("10", "0", "1.5"), [""; 0]);
    assert_eq!(warnings_at("10", "0", "1").len(), 1);
    assert_eq!(warnings("1e-5", "0.1"), [""; 0]);
    assert_eq!(warnings("0", "0.5"), [""; 0]);
    let quiet = warnings("1e-6", "0.1");
    assert_eq!(quiet.len(), 1, "{quiet:?}");
    assert_says(
        &quiet[0],
        &["found 1.0e-6 deg/√h and 1.0e-1 ug/√Hz", "below 1e-5 deg/√h and 0.5 ug/√Hz", "linear"],
    );
}

#[test]
fn the_position_of_a_simulated_base_at_rest_is_known_and_that_of_others_to_a_metre() {
    let position = |text: &str| {
        let scenario = Scenario::parse(text, "test.toml", Path::new(""), &[]).unwrap();
        match scenario.calibration.unwrap().estimator {
            octant_calibration::config::Estimator::Kalman(kalman) => kalman.prior.position_m,
            _ => f64::NAN,
        }
    };
    assert_eq!(position(HEAD), 0.01);
    assert_eq!(position(&format!("{HEAD}[motion]\nkind = \"dockside\"\n")), 1.0);
    assert_eq!(position(&format!("{HEAD}prior.position = \"1 m\"\n")), 1.0);
}

/// A heading test at rest, with keys beside it.
fn heading_test(test: &str, more: &str) -> String {
    format!(
        "schema = 1\n{more}[procedure.navigation]\nduration = \"6 h\"\nrotation = \"none\"\n[procedure.heading_test]\n\
         test = \"{test}\"\n"
    )
}

#[test]
fn a_heading_test_needs_the_motion_that_it_is_about() {
    let moving = "[motion]\nkind = \"dockside\"\n[motion.ship]\npreset = \"scorsby\"\n";
    let between = format!("{moving}from = \"5 h\"\nduration = \"25 min\"\n");
    let slow = "[imu]\nrate = \"50 Hz\"\n";
    for (test, more) in [
        ("settle", String::new()),
        ("settle-in-motion", moving.to_owned()),
        ("settle-in-motion", between.clone()),
        ("scorsby", between.clone()),
        ("dynamic", between.clone()),
    ] {
        let text = heading_test(test, &format!("{more}{slow}"));
        assert!(problems_with(&text, &[]).is_empty(), "{test} {more}");
    }
    for (test, more, expected) in [
        ("settle", moving.to_owned(), "it is a test at rest"),
        ("settle-in-motion", String::new(), "the motion of the table"),
        ("scorsby", String::new(), "the motion of the table"),
        ("scorsby", moving.to_owned(), "motion.ship.from and motion.ship.duration"),
        ("dynamic", moving.to_owned(), "the unit settles at rest before it"),
        ("scorsby", between.replace("5 h", "5.9 h"), "a longer procedure.navigation.duration"),
    ] {
        let (_, path, message) = problem(&heading_test(test, &format!("{more}{slow}")));
        assert_eq!(path, "procedure.heading_test.test");
        assert_says(&message, &[expected]);
    }
}

#[test]
fn several_run_ups_are_those_of_a_simulated_unit() {
    let text = heading_test("settle", "");
    assert!(problems_with(&format!("{text}run_ups = 3\n"), &[]).is_empty());
    let (_, path, message) = problem(&format!(
        "{text}run_ups = 2\n[endpoint]\nuri = \"serial:/dev/ttyUSB0?baud=115200\"\n"
    ));
    assert_eq!(path, "procedure.heading_test.run_ups");
    assert_says(&message, &["found 2, expected 1"]);
    let (_, path, message) = problem(&format!("{text}off = \"1 h\"\n"));
    assert_eq!(path, "procedure.heading_test.off");
    assert_says(&message, &["without effect with run_ups = 1"]);
    let still = heading_test("settle", "").replace("test = ", "run_ups = 1\ntest = ");
    assert!(problems_with(&still, &[]).is_empty());
}

#[test]
fn a_limit_with_sec_phi_is_one_of_a_heading() {
    let with = |measure: &str| {
        format!(
            "{HEAD}[[requirements]]\nid = \"A\"\ntext = \"x\"\nmeasure = \"{measure}\"\nlimit = \"1 deg\"\n\
             secant_latitude = true\n"
        )
    };
    assert!(problems_with(&with("heading.repeatability_deg"), &[]).is_empty());
    let (_, path, message) = problem(&with("navigation.heading_error_arcmin.max"));
    assert_eq!(path, "requirements[0].secant_latitude");
    assert_says(&message, &["has no factor sec φ", "heading.settle_point_error_deg"]);
}

#[test]
fn a_ramp_without_a_beginning_or_an_end_is_refused() {
    let text = format!("{HEAD}[motion]\nkind = \"dockside\"\n[motion.ship]\nramp = \"20 s\"\n");
    let (_, path, message) = problem(&text);
    assert_eq!(path, "motion.ship.ramp");
    assert_says(&message, &["without effect"]);
}
