//! Power of a device: a simulated supply whose output starts and kills `octant serve`, so a cut is a real cold start.

use crate::common::program::{OCTANT, ended, ends, json, octant};
use crate::outside_text::{nothing_acts, nothing_acts_in};
use octant_power::simulate::{Peculiarities, SimulatedInstrument, within};
use octant_test_processes::{Started, command, start};
use serde_json::Value;
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

const LONG: Duration = octant_test_processes::HANGS;

/// Eight seconds of calibration at one stop and two of navigation.
const SHORT: &str = r#"
schema = 1
title = "short"
seed = 3
[record]
samples = "full"
[procedure.calibration]
duration = "8 s"
stops = [{ azimuth = "0 deg", roll = "0 deg" }]
[procedure.navigation]
duration = "2 s"
"#;

const CUT: &str = r#"
[[faults]]
id = "cut"
kind = "brown-out"
trigger = { at = "4 s" }
duration = "500 ms"
"#;

/// Channel 2 of a supply, or relay 4.
const SUPPLY: &str = "channel = 2\nvoltage = \"24 V\"\ncurrent_limit = \"2 A\"\n";
const RELAY: &str = "relay = 4\n";

/// Device that runs while it has power.
#[derive(Default)]
struct Device {
    child: Option<Started>,
    starts: u32,
}

impl Device {
    fn stop(&mut self) {
        self.child = None;
    }
}

/// A bench: a simulated supply or relay, and a device behind it.
struct Bench {
    folder: tempfile::TempDir,
    scenario: PathBuf,
    instrument: SimulatedInstrument,
    device: Arc<Mutex<Device>>,
}

impl Drop for Bench {
    fn drop(&mut self) {
        // The instrument holds the device until the process ends, and a run may leave it on.
        self.device.lock().unwrap_or_else(PoisonError::into_inner).stop();
    }
}

impl Bench {
    /// A bench whose device runs from this voltage on, V; a relay gives every voltage.
    fn new(faults: &str, power: &str, least_v: f64) -> Self {
        Self::that_takes("2 s", faults, power, least_v)
    }

    /// The same with a longer navigation.
    fn that_takes(navigation: &str, faults: &str, power: &str, least_v: f64) -> Self {
        let procedure = SHORT.replace("\"2 s\"", &format!("{navigation:?}"));
        let folder = tempfile::tempdir().unwrap();
        let scenario = folder.path().join("s.toml");
        let instrument = SimulatedInstrument::start(Peculiarities::default()).unwrap();
        let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let supply = instrument.port();
        let text = format!(
            "{procedure}{faults}\n[endpoint]\nuri = \"tcp:{port}\"\n[endpoint.link]\nhello = \"300 s\"\nanswer = \"20 s\"\n\
             [power]\nport = \"{supply}\"\nreply = \"20 s\"\nsettle = \"20 s\"\nrest = \"10 ms\"\n{power}"
        );
        std::fs::write(&scenario, text).unwrap();
        let device: Arc<Mutex<Device>> = Arc::default();
        let (behind, file) = (Arc::clone(&device), scenario.clone());
        instrument.on_change(move |number, on, set_v| {
            let powered = on && (number == 4 || set_v >= least_v);
            let mut device = behind.lock().unwrap();
            if !powered {
                device.stop();
            } else if device.child.is_none() {
                let mut serve = command(OCTANT);
                let serve =
                    serve.args(["serve", "--silence", "60", "--endpoint", &format!("tcp:{port}")]);
                device.child =
                    Some(start(serve.arg(&file).stdout(Stdio::null()).stderr(Stdio::null())));
                device.starts += 1;
            }
        });
        Self { folder, scenario, instrument, device }
    }

    fn command(&self, more: &[&str]) -> Command {
        let mut command = command(OCTANT);
        command.args(["run", "--out"]).arg(self.folder.path().join("out"));
        command.args(more).arg(&self.scenario);
        command
    }

    fn run(&self, more: &[&str]) -> Output {
        self.command(more).output().unwrap()
    }

    fn file(&self, name: &str) -> Value {
        json(&self.folder.path().join("out").join(name))
    }

    fn hash(&self) -> String {
        self.file("summary.json")["stream_hash"].as_str().unwrap().to_owned()
    }

    fn starts(&self) -> u32 {
        self.device.lock().unwrap().starts
    }

    /// Stream hash of the run in process with these faults.
    fn in_process(&self, faults: &str) -> String {
        let (file, out) = (self.folder.path().join("p.toml"), self.folder.path().join("p"));
        std::fs::write(&file, format!("{SHORT}{faults}")).unwrap();
        let mut run = command(OCTANT);
        let output = run.args(["run", "--no-twin", "--out"]).arg(&out).arg(&file).output().unwrap();
        assert!(matches!(output.status.code(), Some(0 | 1 | 3)), "{output:?}");
        json(&out.join("summary.json"))["stream_hash"].as_str().unwrap().to_owned()
    }

    /// Starts a run, waits until the device is on, and lets it be ended; returns status and words.
    fn ended_by(&self, more: &[&str], end: impl FnOnce(&Child)) -> (Option<i32>, String) {
        let mut run = self.command(more);
        let child = start(run.stdout(Stdio::piped()).stderr(Stdio::piped()));
        assert!(within(LONG, || self.instrument.is_on(2)));
        end(&child);
        let output = child.output();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

fn signal(child: &Child, signal: &str) {
    let id = child.id().to_string();
    assert!(command("kill").args([signal, &id]).status().unwrap().success());
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_power_cut_is_a_cold_start_and_gives_the_bits_of_a_brown_out_in_process() {
    for (power, off, on) in
        [(SUPPLY, "OUTP OFF", "OUTP ON"), (RELAY, "ROUT:OPEN (@4)", "ROUT:CLOS (@4)")]
    {
        let bench = Bench::new(CUT, power, 20.0);
        let output = bench.run(&["--no-twin"]);
        assert!(matches!(output.status.code(), Some(0 | 1 | 3)), "{}", said(&output));
        assert_eq!(bench.starts(), 2, "{}", said(&output));
        assert_eq!(bench.hash(), bench.in_process(CUT));

        let manifest = bench.file("manifest.json");
        let power = &manifest["bench"]["power"];
        assert_eq!(power["identity"], "Octant,simulated supply,0,1.0");
        assert_eq!(power["end"]["on"], false);
        let all = power["switchings"].as_array().unwrap();
        let told: Vec<_> = all
            .iter()
            .map(|one| (one["command"].as_str().unwrap(), one["sample"].as_u64()))
            .collect();
        // Off and on at the start, and off at the end. 4 s at 200 Hz are 800 samples.
        let expected = [(off, None), (on, None), (off, Some(801)), (on, Some(901)), (off, None)];
        assert_eq!(told, expected);
        let at =
            |index: usize| octant_base::utc::parse(all[index]["at"].as_str().unwrap()).unwrap();
        assert!(at(3).duration_since(at(2)).unwrap() >= Duration::from_millis(499));
        let volts: Vec<_> = all.iter().map(|one| one["after"]["voltage_v"].as_f64()).collect();
        if off == "OUTP OFF" {
            assert_eq!(volts, [Some(0.0), Some(24.0), Some(0.0), Some(24.0), Some(0.0)]);
            assert_eq!(all[3]["after"]["current_a"], 0.5);
        } else {
            assert_eq!(volts, [None; 5]);
        }
        let shown = manifest["bench"]["power of the device"].as_str().unwrap();
        assert!(shown.contains("switched 5 times, left off"), "{shown}");
        let summary = bench.file("summary.json");
        let fault = &summary["faults"][0];
        assert_eq!(
            (&fault["id"], &fault["samples_altered"]),
            (&"cut".into(), &100.into()),
            "{fault}"
        );
        // A replay does the same in process.
        let out = bench.folder.path().join("out/recording.mcap");
        let (replayed, _) = ended(octant(&["replay", out.to_str().unwrap()]), 0);
        assert!(replayed.contains("bit for bit"), "{replayed}");
    }
}

#[test]
fn a_dip_that_the_device_rides_through_alters_nothing_and_one_that_it_doesnt_is_a_restart() {
    let dip = |volts: &str| {
        format!(
            "[[faults]]\nid = \"dip\"\nkind = \"voltage-dip\"\nvoltage = \"{volts}\"\nlength = \"20 ms\"\n\
             trigger = {{ at = \"4 s\" }}\n"
        )
    };
    let restart = "[[faults]]\nid = \"dip\"\nkind = \"restart\"\ntrigger = { at = \"4 s\" }\n";
    for (volts, starts, ridden, expected) in [("12 V", 1, 1, ""), ("5 V", 2, 0, restart)] {
        let bench = Bench::new(&dip(volts), SUPPLY, 9.0);
        let output = bench.run(&["--no-twin"]);
        assert!(matches!(output.status.code(), Some(0 | 1 | 3)), "{}", said(&output));
        assert_eq!(bench.starts(), starts, "{}", said(&output));
        assert_eq!(bench.hash(), bench.in_process(expected), "{volts}");
        let power = &bench.file("manifest.json")["bench"]["power"];
        assert_eq!((&power["dips"], &power["ridden_through"]), (&1.into(), &ridden.into()));
        let dips: Vec<_> = (power["switchings"].as_array().unwrap().iter())
            .filter(|one| one["sample"] == 801)
            .map(|one| (one["before"]["voltage_v"].as_f64(), one["after"]["voltage_v"].as_f64()))
            .collect();
        let low_v = Some(f64::from(volts[..volts.len() - 2].parse::<u8>().unwrap()));
        assert_eq!(dips, [(Some(24.0), low_v), (low_v, Some(24.0))]);
        let fault = &bench.file("summary.json")["faults"][0];
        assert_eq!(fault["samples_altered"], 1, "{fault}");
    }
}

#[test]
fn the_twin_begins_with_a_cold_start_of_its_own() {
    let bench = Bench::new(CUT, &format!("{SUPPLY}end = \"on\"\n"), 20.0);
    let output = bench.run(&[]);
    assert!(matches!(output.status.code(), Some(0 | 1 | 3)), "{}", said(&output));
    // Two runs, of which one has a cut.
    assert_eq!(bench.starts(), 3);
    assert!(bench.instrument.is_on(2), "left on");
    assert!(bench.file("summary.json")["counterfactual"].is_object());
}

#[test]
fn an_identity_with_control_characters_acts_nowhere() {
    let bench = Bench::new("", SUPPLY, 20.0);
    let hostile = Peculiarities { hostile: true, ..Peculiarities::default() };
    bench.instrument.becomes(hostile);
    let output = bench.run(&[]);
    assert!(matches!(output.status.code(), Some(0 | 1 | 3)), "{}", said(&output));
    let run = bench.folder.path().join("out");
    nothing_acts_in(&run);
    let page = std::fs::read_to_string(run.join("report.html")).unwrap();
    assert!(page.contains("Octant,\\u001b[2Jsupply\\u0007"), "it is shown");
    let port = bench.instrument.port();
    let by_hand = octant(&["power", &port, "--channel", "2", "--reply", "20 s", "status"]);
    for bytes in [&output.stdout, &output.stderr, &by_hand.stdout, &by_hand.stderr] {
        nothing_acts("terminal", &String::from_utf8_lossy(bytes));
    }
}

#[test]
fn an_interrupt_leaves_the_output_as_it_is_to_be_left() {
    for (number, status) in [("-INT", 3), ("-TERM", 3)] {
        // A cut of a minute of host time, in the middle of which the signal comes.
        let cut = CUT.replace("500 ms", "60 s").replace("at = \"4 s\"", "at = \"1 s\"");
        let bench = Bench::that_takes("100 s", &cut, SUPPLY, 20.0);
        let mut run = bench.command(&["--no-twin"]);
        let child = start(run.stdout(Stdio::piped()).stderr(Stdio::piped()));
        assert!(within(LONG, || bench.starts() == 1));
        assert!(within(LONG, || !bench.instrument.is_on(2)));
        signal(&child, number);
        let output = child.output();
        assert_eq!(output.status.code(), Some(status), "{number}: {}", said(&output));
        assert!(!bench.instrument.is_on(2));
        assert_eq!(bench.starts(), 1, "nothing was switched on again");
    }
}

#[test]
fn an_interrupted_run_that_idles_is_left_off_and_a_second_signal_too() {
    // The device never starts, and its hello is waited for.
    let bench = Bench::new(CUT, SUPPLY, 1e9);
    let (status, words) = bench.ended_by(&["--no-twin"], |child| {
        signal(child, "-INT");
        std::thread::sleep(Duration::from_millis(300));
        signal(child, "-INT");
    });
    assert_eq!(status, Some(4), "{words}");
    assert!(within(LONG, || !bench.instrument.is_on(2)), "{words}");
}

#[test]
fn a_device_that_does_not_come_back_ends_the_run_as_an_error_of_the_bench() {
    let bench = Bench::new(CUT, SUPPLY, 20.0);
    let device = Arc::clone(&bench.device);
    let (status, words) =
        bench.ended_by(&["--no-twin", "--set", "endpoint.link.hello=10 s"], |_| {
            assert!(within(LONG, || device.lock().unwrap().starts == 1));
            assert!(within(LONG, || !bench.instrument.is_on(2)));
            // It burnt out.
            bench.instrument.on_change(|_, _, _| {});
        });
    assert_eq!(status, Some(4), "{words}");
    assert!(words.contains("tcp:127.0.0.1") || words.contains("endpoint"), "{words}");
    assert!(!bench.instrument.is_on(2));
}

#[test]
fn a_supply_that_fails_in_the_middle_ends_the_run_and_is_named() {
    let bench = Bench::that_takes("10 min", &CUT.replace("4 s", "9 min"), SUPPLY, 20.0);
    let instrument = bench.instrument.clone();
    let device = Arc::clone(&bench.device);
    let (status, words) = bench.ended_by(&["--no-twin", "--set", "power.settle=200 ms"], |_| {
        assert!(within(LONG, || device.lock().unwrap().starts == 1));
        instrument.becomes(Peculiarities { stuck: true, ..Peculiarities::default() });
    });
    assert_eq!(status, Some(4), "{words}");
    let summary = json(&bench.folder.path().join("out.partial/summary.json"));
    let reasons = summary["reasons"].to_string();
    assert!(reasons.contains("power of the device") && reasons.contains("OUTP OFF"), "{reasons}");
}

#[test]
fn a_device_that_answers_while_its_power_is_cut_was_never_cut() {
    let bench = Bench::that_takes("10 min", &CUT.replace("4 s", "9 min"), RELAY, 20.0);
    let (instrument, device) = (bench.instrument.clone(), Arc::clone(&bench.device));
    let mut run = bench.command(&["--no-twin"]);
    let child = start(run.stdout(Stdio::piped()).stderr(Stdio::piped()));
    assert!(within(LONG, || device.lock().unwrap().starts == 1));
    // From here on the relay switches nothing.
    instrument.on_change(|_, _, _| {});
    let output = child.output();
    let words = said(&output);
    assert_eq!(output.status.code(), Some(4), "{words}");
    assert!(words.contains("failed to cut the power of tcp:127.0.0.1"), "{words}");
}

#[test]
fn what_a_supply_or_a_relay_cannot_do_is_refused_when_the_scenario_is_read() {
    let device = "[endpoint]\nuri = \"serial:/dev/ttyUSB0\"\n";
    let dip = "[[faults]]\nid = \"d\"\nkind = \"voltage-dip\"\nvoltage = \"9 V\"\ntrigger = { at = \"4 s\" }\n";
    let power = |keys: &str| format!("[power]\nport = \"tcp:psu\"\n{keys}");
    for (text, expected) in [
        (power(SUPPLY), "no device that it could feed"),
        (format!("{device}{}", power("")), "a supply needs voltage and current_limit"),
        (format!("{device}{}", power("relay = 4\nvoltage = \"24 V\"\n")), "beside power.relay"),
        (format!("{device}{}", power("relay = 4\nchannel = 1\n")), "beside power.relay"),
        (
            format!("{device}{}", power("voltage = \"24 A\"\ncurrent_limit = \"2 A\"\n")),
            "expected a voltage such as",
        ),
        (format!("{device}{}", power("voltage = \"0 V\"\ncurrent_limit = \"2 A\"\n")), "above 0"),
        (format!("{device}{}", power(SUPPLY).replace("tcp:psu", "psu")), "expected tcp:HOST"),
        (format!("{dip}{device}"), "acts on the supply of a device, and there is none"),
        (format!("{dip}{device}{}", power(RELAY)), "power.relay can only switch"),
        (
            format!("{}{device}{}", dip.replace("9 V", "22 V"), power(SUPPLY)),
            "expected less than 21.6 V: power.voltage, 24 V, less twice power.tolerance",
        ),
        (
            format!("{CUT}{device}[realtime]\npace = \"clock\"\n{}", power(SUPPLY)),
            "don't wait: expected realtime.pace",
        ),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("s.toml");
        std::fs::write(&file, format!("{SHORT}{text}")).unwrap();
        let (_, words) = ends(&["run", file.to_str().unwrap()], 2);
        assert!(words.contains(expected), "{text}: {words}");
    }
}

#[test]
fn a_supply_is_looked_at_set_and_switched_by_hand() {
    let instrument = SimulatedInstrument::start(Peculiarities::default()).unwrap();
    let port = instrument.port();
    let by_hand = |more: &[&str], status| {
        let all = [&["power", &port, "--channel", "2", "--reply", "20 s"], more].concat();
        ends(&all, status)
    };
    let (told, _) = by_hand(&["set", "--voltage", "12 V", "--current-limit", "500 mA"], 0);
    assert_eq!(
        told,
        "Octant,simulated supply,0,1.0\noff, set to 12 V and at most 0.5 A; measured 0.000 V, 0.0000 A\n"
    );
    assert!(!instrument.heard().iter().any(|line| line == "SYST:REM"));
    by_hand(&["--remote", "on"], 0);
    assert!(instrument.heard().iter().any(|line| line == "SYST:REM"));
    assert!(instrument.is_on(2));
    let (told, _) = by_hand(&["--json", "status"], 0);
    let told: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(
        (&told["on"], &told["voltage_v"], &told["current_a"]),
        (&true.into(), &12.0.into(), &0.25.into())
    );
    by_hand(&["off"], 0);
    assert!(!instrument.is_on(2));
    by_hand(&["on"], 0);
    by_hand(&["reset"], 0);
    assert!(!instrument.is_on(2));
    ends(&["power", &port, "--relay", "4", "on"], 0);
    assert!(instrument.is_on(4));

    let (_, words) = by_hand(&["set", "--voltage", "99 V"], 4);
    assert!(words.contains("refuses `VOLT 99` with -222,\"Data out of range\""), "{words}");
    for (arguments, status, expected) in [
        (&["power", &port, "--relay", "4", "set", "--voltage", "1 V"][..], 2, "a relay switches"),
        (&["power", &port, "set"], 2, "expected --voltage or --current-limit"),
        (&["power", &port, "set", "--voltage", "12"], 2, "expected a voltage above 0 such as"),
        (&["power", &port, "--channel", "0", "on"], 2, "--channel"),
        (&["power", "psu", "on"], 2, "expected tcp:HOST"),
        (&["power", "tcp:127.0.0.1:1", "on"], 4, "open tcp:127.0.0.1:1"),
    ] {
        let (_, words) = ends(arguments, status);
        assert!(words.contains(expected), "{arguments:?}: {words}");
    }
}

#[test]
fn a_scenario_names_the_output_by_hand() {
    let bench = Bench::new("", SUPPLY, 1e9);
    let file = bench.scenario.to_str().unwrap();
    let (told, _) = ends(&["power", file, "on"], 0);
    assert!(told.contains("on, set to 24 V and at most 2 A; measured 24.000 V"), "{told}");
    ends(&["power", file, "off"], 0);
    assert!(!bench.instrument.is_on(2));
    let (_, words) = ends(&["power", file, "--channel", "1", "on"], 2);
    assert!(words.contains("expected no such option, or a port"), "{words}");
}
