//! The table under a real instrument, both simulated: the core's set points turn the table, its
//! angles are in the samples, and every end of the run stops it.

use crate::common::program::OCTANT;
use crate::common::table::{Bench, Felt, Running, Stage, wait_for};
use octant_test_processes::{command, start};
use octant_turntable::TableAxis;
use octant_turntable::simulate::ControllerBehaviour;
use serde_json::Value;

#[test]
fn the_core_turns_the_table_and_its_angles_stand_in_the_samples() {
    let stage = Stage::new();
    let bench = Bench::new(&stage, 20, "home = true\nwatchdog = \"8 s\"\n");
    let (status, said) = bench.run(&[]).wait();
    assert!(matches!(status, Some(0 | 1 | 3)), "{status:?}: {said}");
    assert!((stage.angle(TableAxis::Roll) - 20.0).abs() < 1e-4 && stage.rests());
    let log = stage.server.with(|controller, _| controller.log().to_vec());
    let homed = log.iter().filter(|line| line.starts_with("PROGRAM RUN")).count();
    assert_eq!(homed, 2);
    // The watchdog was on, and was reset.
    assert!(log.iter().any(|line| line == "IGLOBAL(34) = 8000"));
    assert_eq!(
        log.iter().rfind(|line| line.starts_with("IGLOBAL(34)")).unwrap(),
        "IGLOBAL(34) = 0"
    );

    // The gyros of the instrument on the table agree with the angles: 0.5° are 50 ms.
    let Felt { samples, without, felt_rad, worst_deg: worst } = Felt::of(&bench);
    assert_eq!(samples, 3200);
    // A machine that stalls for a moment leaves samples without angles.
    assert!(without < 800, "{without}");
    assert!((felt_rad.to_degrees() - 20.0).abs() < 0.3, "{}", felt_rad.to_degrees());
    assert!(worst < 2.0, "{worst}");

    let manifest: Value = bench.json("manifest.json");
    let table = &manifest["bench"]["table"];
    assert_eq!(table["port"], stage.port.as_str());
    assert_eq!(table["dialect"], "aerotech-ensemble");
    assert_eq!(table["roll"]["greatest_deg"].as_f64().unwrap().round(), 25.0);
    assert_eq!(table["stopped"], Value::Null);
    assert_eq!(table["commands"], 2, "{table}");
    assert_eq!(table["angles"]["samples"], samples - without);
    let clock = &manifest["bench"]["clock"];
    assert_eq!(clock["stamps"], samples);
    // Both follow the clock of this machine.
    assert!(clock["skew_ppm"].as_f64().unwrap().abs() < 20_000.0, "{clock}");
    let summary = std::fs::read_to_string(bench.out().join("summary.json")).unwrap();
    assert!(!summary.contains("skew"), "host time has no place in it");
    let report = std::fs::read_to_string(bench.out().join("report.html")).unwrap();
    assert!(report.contains("from the nearest look") && report.contains("host faster by"));
}

/// The line delays each reading by 3 ms: pulses show it, and the angles are those of the samples.
#[test]
fn pulses_give_samples_their_time_and_show_the_delay_of_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("assert");
    let stage = Stage::with_pulses(&file);
    let bench = Bench::new(&stage, 20, "");
    let pps = format!("source.live.pps={:?}", file.display().to_string());
    let (status, said) = bench.run(&["--set", &pps]).wait();
    assert!(matches!(status, Some(0 | 1 | 3)), "{status:?}: {said}");
    let manifest: Value = bench.json("manifest.json");
    let time = &manifest["bench"]["time"];
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{time}"));
    assert_eq!(time["origin"], "pulses", "{time}");
    assert_eq!(time["arrivals_by_kernel"], 0, "{time}");
    assert!(number(&time["pulses"]["taken"]) >= 10.0, "{time}");
    assert_eq!(time["pulses"]["off"], 0, "{time}");
    // Pulses are written at their time to the nanosecond: what is left is the conversion of clocks.
    assert!(number(&time["pulses"]["residual_us"]) < 100.0, "{time}");
    assert!(number(&time["line_delay"]["least_ms"]) > 2.9, "{time}");
    assert!(number(&time["line_delay"]["least_ms"]) < 40.0, "{time}");
    assert!(number(&time["within_us"]) >= 20.0, "{time}");
    // At 10 °/s, with the looks: 36″ a millisecond.
    let looks_ms = number(&manifest["bench"]["table"]["angles"]["time_within_ms"]);
    let expected = 36.0 * (number(&time["within_us"]) * 1e-3 + looks_ms);
    assert!((number(&time["angle_within_arcsec"]) / expected - 1.0).abs() < 1e-9, "{time}");
    let report = std::fs::read_to_string(bench.out().join("report.html")).unwrap();
    assert!(report.contains("delay of the line from"));
    println!("{time}");
}

/// Without pulses the run doesn't begin.
#[test]
fn pulses_that_never_come_end_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("assert");
    std::fs::write(&file, "0.000000000#0\n").unwrap();
    let stage = Stage::new();
    let bench = Bench::new(&stage, 20, "");
    let pps = format!("source.live.pps={:?}", file.display().to_string());
    let (status, _) = bench.run(&["--set", &pps, "--set", "source.live.pps_silence=2 s"]).wait();
    assert_eq!(status, Some(4));
    let reasons = bench.json("summary.json")["reasons"].to_string();
    assert!(reasons.contains("source.live.pps: no pulse for 2 s"), "{reasons}");
    assert!(stage.rests());
}

/// Ends a run in the middle of a move of 200°, and checks that the table comes to rest; returns the
/// exit status and the reasons or the output.
fn ended_on_the_way(more: &str, end: impl FnOnce(&Stage, &Running)) -> (Option<i32>, String) {
    let stage = Stage::new();
    let bench = Bench::new(&stage, 200, more);
    let running = bench.run(&[]);
    stage.wait_for_the_way();
    end(&stage, &running);
    wait_for("rest", || stage.rests());
    let (status, said) = running.wait();
    let angle = stage.angle(TableAxis::Roll);
    assert!(angle < 195.0, "{angle}: {said}");
    assert!(stage.rests());
    if status != Some(4) {
        return (status, said);
    }
    let summary = bench.json("summary.json");
    assert_eq!(summary["verdict"], "error");
    (status, summary["reasons"].to_string())
}

#[test]
fn an_instrument_that_is_lost_stops_the_table() {
    let (status, reasons) = ended_on_the_way("", |stage, _| stage.instrument.fall_silent());
    assert_eq!(status, Some(4));
    assert!(reasons.contains("no reading for 5 s"), "{reasons}");
}

#[test]
fn a_table_that_stops_itself_ends_the_run_and_is_named() {
    let (status, reasons) = ended_on_the_way("reply = \"3 s\"\n", |stage, _| {
        stage.server.with(|controller, _| controller.behave(ControllerBehaviour::Silent));
    });
    assert_eq!(status, Some(4));
    assert!(reasons.contains("turntable tcp:") && reasons.contains("no reply to"), "{reasons}");
}

#[test]
fn somebody_on_the_command_line_stops_it() {
    let (status, reasons) = ended_on_the_way("", |stage, _| {
        let output = command(OCTANT).args(["turntable", "stop", &stage.port]).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && said.contains("the program that drives"), "{said}");
    });
    assert_eq!(status, Some(4));
    assert!(reasons.contains("stop command on the command line"), "{reasons}");
}

#[test]
fn an_interrupt_stops_it_and_the_run_is_inconclusive() {
    let (status, said) = ended_on_the_way("", |_, running| running.signal("-INT"));
    assert_eq!(status, Some(3), "{said}");
}

#[test]
fn a_harness_that_is_killed_leaves_a_guard_that_stops_it() {
    let (status, _) = ended_on_the_way("", |_, running| running.signal("-KILL"));
    assert_eq!(status, None);
}

/// A fault inverts the set point: a set point beyond the limits is never sent.
#[test]
fn a_set_point_beyond_its_limits_ends_the_run() {
    let stage = Stage::new();
    let bench = Bench::new(&stage, 20, "");
    bench.add(
        "[[faults]]\nid = \"round\"\nkind = \"wrong-direction\"\ntrigger = { at = \"1 s\" }\n\
         duration = \"10 s\"\n",
    );
    let (status, said) = bench.run(&[]).wait();
    assert_eq!(status, Some(4), "{said}");
    let reasons = bench.json("summary.json")["reasons"].to_string();
    assert!(reasons.contains("roll -20.0000° is beyond its limits, -5° to 25°"), "{reasons}");
    assert!(stage.rests() && stage.angle(TableAxis::Roll).abs() < 1e-4);
}

/// Invalid settings are refused with their place, before anything is sent to the table.
#[test]
fn what_makes_no_sense_is_refused_before_anything_moves() {
    let stage = Stage::new();
    for (set, expected) in [
        ("source.uri=plant", "turntable.drive: a real table turns a real instrument"),
        (
            "turntable.drive.roll=[\"-5 deg\", \"15 deg\"]",
            "turntable.drive.roll: found -5 deg to 15 deg, but stop 2 of the calibration is at 20.0000 deg",
        ),
        (
            "turntable.drive.azimuth=[\"5 deg\", \"15 deg\"]",
            "turntable.drive.azimuth: found 5 deg to 15 deg, expected a least and a greatest angle with zero",
        ),
        (
            "turntable.drive.port=\"can:can0\"",
            "turntable.drive.port: found \"can:can0\", expected tcp:HOST:PORT, or serial:DEVICE",
        ),
        (
            "turntable.drive.guard=\"10 ms\"",
            "turntable.drive.guard: found \"10 ms\", expected no less than look and reply together",
        ),
        ("turntable.drive.dialect=\"nobody.toml\"", "nobody.toml: No such file"),
        ("realtime.pace=clock", "realtime.pace: a real instrument sends by a clock of its own"),
    ] {
        let bench = Bench::new(&stage, 20, "");
        let mut more = vec!["--set", set];
        if set.starts_with("source") {
            more.extend(["--set", "source.live.silence=\"1 s\""]);
        }
        let (status, said) = bench.run(&more).wait();
        assert_eq!(status, Some(2), "{set}: {said}");
        assert!(said.contains(expected), "{set}: {said}");
    }
    assert!(stage.server.with(|controller, _| controller.log().is_empty()));
}

#[test]
fn by_hand_on_a_pseudo_terminal() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("table");
    let name = format!("serial:{}?baud=115200", link.display());
    let simulated = start(
        command(OCTANT)
            .args(["turntable", "simulate", &format!("pty:{}", link.display())])
            .stderr(std::process::Stdio::null()),
    );
    wait_for("the terminal", || link.exists());
    let scenario = folder.path().join("s.toml");
    std::fs::write(
        &scenario,
        format!(
            "schema = 1\n[procedure.navigation]\nduration = \"10 s\"\nrotation = \"none\"\n\
             [source]\nuri = \"udp:127.0.0.1:0\"\n[turntable.drive]\nport = {name:?}\n\
             azimuth = [\"-5 deg\", \"5 deg\"]\nroll = [\"-5 deg\", \"25 deg\"]\n"
        ),
    )
    .unwrap();
    let scenario = scenario.to_str().unwrap();
    let octant = |arguments: &[&str]| {
        let output = command(OCTANT).arg("turntable").args(arguments).output().unwrap();
        let out = String::from_utf8_lossy(&output.stdout).into_owned();
        (output.status.code(), out + &String::from_utf8_lossy(&output.stderr))
    };
    let (status, said) = octant(&["status", &name]);
    // The table is queried, and no drive is switched on.
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("azimuth  0.00000 deg") && said.contains("drive off"), "{said}");
    let (status, said) = octant(&["home", &name, "--axis", "roll", "--json"]);
    assert_eq!(status, Some(0), "{said}");
    let json: Value = serde_json::from_str(&said).unwrap();
    let homed = |axis: &str| json[axis]["homed"].clone();
    assert_eq!((homed("roll"), homed("azimuth")), (true.into(), false.into()), "{json}");
    let (status, said) = octant(&["status", &name, "--json"]);
    assert_eq!(status, Some(0), "{said}");
    let json: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(json["roll"]["homed"], true, "{json}");
    let (status, said) = octant(&["home", &name]);
    assert_eq!(status, Some(0), "{said}");
    assert!(said.matches(", homed").count() == 2, "{said}");
    let (status, said) = octant(&["goto", scenario, "roll", "-3 deg", "--json"]);
    assert_eq!(status, Some(0), "{said}");
    let json: Value = serde_json::from_str(&said).unwrap();
    assert!((json["roll"]["angle_deg"].as_f64().unwrap() + 3.0).abs() < 1e-4, "{json}");
    let (status, said) = octant(&["goto", scenario, "roll", "30 deg"]);
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("roll 30.0000° is beyond its limits, -5° to 25°"), "{said}");
    let (status, said) = octant(&["goto", &name, "roll", "3 deg"]);
    assert_eq!(status, Some(2), "{said}");
    assert!(said.contains("expected a scenario"), "{said}");
    let (status, said) = octant(&["stop", scenario]);
    assert_eq!(status, Some(0), "{said}");
    assert!(said.contains("stop sent through its own port"), "{said}");
    let (status, said) = octant(&["status", "tcp:127.0.0.1:1"]);
    assert_eq!(status, Some(4), "{said}");
    drop(simulated);
}
