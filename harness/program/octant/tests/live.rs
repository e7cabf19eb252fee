//! A core at the other end of a wire: over pseudo terminals, UDP, TCP, pipes and adapters, driven by the
//! program and served by it, the answers are those of the core in process to the last bit; and
//! however a device ends, the bench reports it.

use crate::common::program::OCTANT;
use octant_test_processes::{Started, command, start};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

const LOCKSTEP: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/lockstep.toml");

/// A short scenario: 20 s of calibration through a move, 5 s of navigation.
const SHORT: &str = r#"
schema = 1
title = "short"
seed = 3
[procedure.calibration]
duration = "20 s"
stops = [{ azimuth = "0 deg", roll = "0 deg" }, { azimuth = "0 deg", roll = "45 deg" }]
[procedure.navigation]
duration = "5 s"
[record]
samples = "full"
"#;

/// Running `octant serve`, ended with the test.
struct Served {
    child: Started,
    /// URI for the harness.
    uri: String,
    said: Option<std::thread::JoinHandle<String>>,
}

impl Served {
    fn new(endpoint: &str, scenario: &Path) -> Self {
        // Longer than a busy host stands still.
        Self::with("60", endpoint, scenario, &[])
    }

    /// A device that gives up a harness after a silence, s.
    fn with_silence(silence: &str, endpoint: &str, scenario: &Path) -> Self {
        Self::with(silence, endpoint, scenario, &[])
    }

    fn with(silence: &str, endpoint: &str, scenario: &Path, more: &[&str]) -> Self {
        let mut child = start(
            command(OCTANT)
                .args(["serve", "--silence", silence, "--endpoint", endpoint])
                .args(more)
                .arg(scenario)
                .stderr(Stdio::piped()),
        );
        let mut stderr = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        stderr.read_line(&mut line).unwrap();
        let uri = line.trim().strip_prefix("octant: listening on ").expect(&line).to_owned();
        let said = std::thread::spawn(move || {
            let mut said = String::new();
            let _ = stderr.read_to_string(&mut said);
            said
        });
        Self { child, uri, said: Some(said) }
    }

    fn signal(&self, signal: &str) {
        let pid = self.child.id().to_string();
        assert!(command("kill").args([signal, &pid]).status().unwrap().success());
    }

    /// Stops it; returns its exit status and its output after the first line.
    fn stop(mut self, signal: &str) -> (Option<i32>, String) {
        self.signal(signal);
        let status = self.child.wait().unwrap().code();
        (status, self.said.take().unwrap().join().unwrap())
    }
}

struct Bench {
    folder: tempfile::TempDir,
    scenario: PathBuf,
}

impl Bench {
    fn new(text: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scenario = folder.path().join("s.toml");
        std::fs::write(&scenario, text).unwrap();
        Self { folder, scenario }
    }

    fn run(&self, scenario: &Path, out: &str, more: &[&str]) -> Output {
        command(OCTANT)
            .args(["run", "--out"])
            .arg(self.folder.path().join(out))
            .args(more)
            .arg(scenario)
            .output()
            .unwrap()
    }

    fn summary(&self, out: &str) -> Value {
        let text = std::fs::read_to_string(self.folder.path().join(out).join("summary.json"));
        serde_json::from_str(&text.unwrap()).unwrap()
    }

    /// Returns the account of the wire, after a check of its sum and of its copy in the manifest.
    fn wire(&self, out: &str) -> Value {
        let summary = self.summary(out);
        let wire = summary["inputs"].as_array().unwrap().last().unwrap().clone();
        let path = self.folder.path().join(out).join("manifest.json");
        let manifest: Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
        assert_eq!(manifest["accounts"], summary["inputs"]);
        let link = &manifest["link"];
        assert_eq!(wire["input"], format!("wire {}", link["port"].as_str().unwrap()));
        let count = |name: &str| link[name].as_u64().unwrap();
        assert_eq!(wire["read"], count("received") + count("damaged") + count("unreadable"));
        wire
    }

    /// Returns the stream hash of a run that must end well.
    fn hash(&self, out: &str, more: &[&str]) -> String {
        let output = self.run(&self.scenario, out, more);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{more:?}: {said}");
        self.summary(out)["stream_hash"].as_str().unwrap().to_owned()
    }
}

#[test]
fn ten_minutes_are_the_same_bits_in_process_and_over_every_port() {
    let bench = Bench::new(&std::fs::read_to_string(LOCKSTEP).unwrap());
    let expected = bench.hash("in-process", &[]);
    for (i, endpoint) in ["pty:", "udp:0", "tcp:0"].into_iter().enumerate() {
        let served = Served::new(endpoint, &bench.scenario);
        let out = format!("live-{i}");
        // Long time limits, so that a busy host causes no repeats: only real losses are counted.
        let patient = ["--set", "endpoint.link.repeat=5 s", "--set", "endpoint.link.answer=300 s"];
        let words = [&["--endpoint", &served.uri], &patient[..]].concat();
        let found = bench.hash(&out, &words);
        assert_eq!(found, expected, "{endpoint}");
        let wire = bench.wire(&out);
        assert!(wire["read"] == wire["used"] && wire.get("missing").is_none(), "{wire}");
        let (status, said) = served.stop("-TERM");
        assert_eq!(status, Some(0), "{said}");
        assert!(said.contains("120000 steps, 0 repeated, 0 skipped, 0 damaged"), "{said}");
        assert!(said.contains("octant: stopped"), "{said}");
    }
    // A program that the harness starts, and ends.
    let device = format!("exec:{OCTANT} serve --endpoint stdio: {}", bench.scenario.display());
    assert_eq!(bench.hash("exec", &["--endpoint", &device]), expected);
    // The device's answers are those of the core in process on the recording.
    let recording = bench.folder.path().join("live-0/recording.mcap");
    let replayed = command(OCTANT).arg("replay").arg(recording).output().unwrap();
    let said = String::from_utf8_lossy(&replayed.stdout);
    assert!(replayed.status.success() && said.contains("bit for bit"), "{said}");
}

/// Three seconds by the clock over a port. Nothing here says how late a sample may be.
#[test]
fn a_run_by_the_clock_over_a_port_shows_its_lateness_over_the_run() {
    let bench = Bench::new(
        "schema = 1\ntitle = \"by the clock\"\n[procedure.alignment]\nmethod = \"given\"\n\
         [procedure.navigation]\nduration = \"3 s\"\n[realtime]\noverrun = \"10 s\"\n",
    );
    let expected = bench.hash("in-process", &[]);
    for endpoint in ["udp:0", "pty:"] {
        let served = Served::new(endpoint, &bench.scenario);
        let out = endpoint.trim_end_matches([':', '0']);
        let patient = ["--set", "endpoint.link.answer=300 s", "--realtime"];
        let words = [&["--endpoint", &served.uri], &patient[..]].concat();
        // On a busy host answers are late, and the run is inconclusive; its commands are late too then, and its hash
        // is another one.
        let output = bench.run(&bench.scenario, out, &words);
        let summary = bench.summary(out);
        match output.status.code() {
            Some(0) => assert_eq!(summary["stream_hash"], *expected, "{endpoint}"),
            Some(3) => assert_eq!(summary["verdict"], "inconclusive", "{endpoint}"),
            _ => panic!("{endpoint}: {output:?}"),
        }
        let pacing = &summary["pacing"];
        assert_eq!(pacing["frames"], 600);
        let over = &pacing["lateness_over_run"];
        let list = |name: &str| -> Vec<u64> {
            over[name].as_array().unwrap().iter().map(|n| n.as_u64().unwrap()).collect()
        };
        let (least, largest) = (list("least_ns"), list("largest_ns"));
        let per_interval = over["frames_per_interval"].as_u64().unwrap();
        assert_eq!(largest.len() as u64, 600u64.div_ceil(per_interval));
        assert!(least.iter().zip(&largest).all(|(least, largest)| least <= largest));
        let max_us = pacing["lateness_us"]["max"].as_f64().unwrap();
        assert_eq!(*largest.iter().max().unwrap() as f64 / 1e3, max_us);
        assert_eq!(Some(list("overruns").iter().sum()), pacing["overruns"].as_u64());
        let page = std::fs::read_to_string(bench.folder.path().join(out).join("report.html"));
        let page = page.unwrap();
        let chart = page.split("aria-label=\"Lateness over the run\"").nth(1).unwrap();
        assert!(chart.contains("smallest to largest in "), "{endpoint}");
        served.stop("-TERM");
    }
}

#[test]
fn a_program_that_ends_or_is_not_there_ends_the_run() {
    let bench = Bench::new(SHORT);
    let tried = [
        ("exec:true", "the program ended: exit status: 0"),
        ("exec:./no-such-program --fast", "expected a program"),
        ("stdio:", "possible: in-process"),
        ("tcp:127.0.0.1:1", "refused"),
    ];
    for (i, (device, reason)) in tried.into_iter().enumerate() {
        let output = bench.run(&bench.scenario, &format!("gone-{i}"), &["--endpoint", device]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(said.contains(reason), "{device}: {said}");
        let expected = if device == "stdio:" { 2 } else { 4 };
        assert_eq!(output.status.code(), Some(expected), "{device}: {said}");
    }
}

#[test]
fn a_device_program_gets_no_secret_and_its_words_are_marked_and_escaped() {
    let bench = Bench::new(SHORT);
    let (script, seen) = (bench.folder.path().join("dev"), bench.folder.path().join("seen"));
    let body = format!(
        "env > '{}'\nprintf '\\033]0;owned\\007\\033[31mverdict: pass\\n' >&2\n\
         head -c 1000000 /dev/zero | tr '\\0' x >&2\nexit 3\n",
        seen.display()
    );
    std::fs::write(&script, body).unwrap();
    let output = command(OCTANT)
        .args(["run", bench.scenario.to_str().unwrap(), "--out"])
        .arg(bench.folder.path().join("out"))
        .arg("--endpoint")
        .arg(format!("exec:sh {}", script.display()))
        .env("AWS_SECRET_ACCESS_KEY", "hunter2")
        .env("GITHUB_TOKEN", "hunter2")
        .env("http_proxy", "http://ann:hunter2@proxy:3128")
        .env("DEVICE_SERIAL", "0042")
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{said}");
    let environment = std::fs::read_to_string(seen).unwrap();
    assert!(!environment.contains("hunter2"), "{environment}");
    assert!(environment.contains("DEVICE_SERIAL=0042"), "{environment}");
    let line = r"device: \u001b]0;owned\u0007\u001b[31mverdict: pass";
    assert!(said.lines().any(|said| said == line), "{said}");
    assert!(!said.contains('\u{1b}'), "{said}");
    // Its last words stand before the message about its end.
    assert!(said.find(line) < said.find("the program ended: exit status: 3"), "{said}");
    // Only a part of the flood after them is shown.
    assert!(said.len() < 500_000 && said.contains("bytes of its output were dropped"));
}

#[test]
fn a_line_full_of_faults_gives_the_same_bits_and_receipts() {
    let faults = |kinds: &[&str]| {
        let one = |kind: &&str| {
            format!(
                "[[faults]]\nid = {kind:?}\nkind = {kind:?}\nshare = \"2 %\"\n\
                 trigger = {{ at = \"1 s\" }}\nduration = \"20 s\"\n"
            )
        };
        kinds.iter().map(one).collect::<String>()
    };
    let bytes = ["wire-flip", "wire-insert", "wire-drop", "wire-truncate", "wire-checksum"];
    let frames =
        ["wire-loss", "wire-duplicate", "wire-reorder", "wire-delay", "wire-replay", "wire-babble"];
    let line = ["wire-split", "wire-coalesce", "serial-framing"];
    let clean = Bench::new(SHORT);
    let expected = clean.hash("clean", &[]);
    for (endpoint, kinds) in [
        ("pty:", [&bytes[..], &frames, &line].concat()),
        ("udp:0", [&bytes[..], &frames, &["wire-coalesce"]].concat()),
    ] {
        let served = Served::new(endpoint, &clean.scenario);
        let wire = format!(
            "[endpoint]\nuri = {:?}\n[endpoint.link]\nrepeat = \"5 ms\"\n{}",
            served.uri,
            faults(&kinds)
        );
        let bench = Bench::new(&format!("{SHORT}{wire}"));
        assert_eq!(bench.hash("faulted", &[]), expected, "{endpoint}");
        let wire = bench.wire("faulted");
        let kinds_left = wire["left_out"].to_string();
        assert!(kinds_left.contains("damaged messages"), "{wire}");
        assert!(kinds_left.contains("a second time"), "{wire}");
        assert!(wire["notes"].to_string().contains("requests sent again"), "{wire}");
        let summary = bench.summary("faulted");
        let receipts = summary["faults"].as_array().unwrap();
        assert_eq!(receipts.len(), kinds.len());
        for receipt in receipts {
            assert_eq!(receipt["fired"], true, "{receipt}");
            let first = receipt["first_sample"].as_u64().unwrap();
            assert!((201..4201).contains(&first), "{receipt}");
            assert!(receipt["samples_altered"].as_u64().unwrap() > 1, "{receipt}");
        }
        let (_, said) = served.stop("-INT");
        assert!(said.contains("damaged"), "{said}");
    }
}

#[test]
fn a_plug_that_is_pulled_ends_the_run_or_is_waited_for() {
    let fault = "[[faults]]\nid = \"plug\"\nkind = \"wire-hang-up\"\naway = \"300 ms\"\n\
                 trigger = { at = \"3 s\" }\n";
    let clean = Bench::new(SHORT);
    let expected = clean.hash("clean", &[]);
    let served = Served::new("pty:", &clean.scenario);
    let text = |link: &str| {
        format!("{SHORT}[endpoint]\nuri = {:?}\n[endpoint.link]\n{link}\n{fault}", served.uri)
    };
    let bench = Bench::new(&text("reconnect = \"5 s\""));
    assert_eq!(bench.hash("back", &["--no-twin"]), expected);
    assert_eq!(bench.summary("back")["faults"][0]["samples_altered"], 1);
    let bench = Bench::new(&text(""));
    let output = bench.run(&bench.scenario, "gone", &["--no-twin", "--json"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{said}");
    // The earlier part of the recording stays, under the name of an unfinished run.
    let partial = bench.folder.path().join("gone.partial/summary.json");
    let summary: Value = serde_json::from_str(&std::fs::read_to_string(partial).unwrap()).unwrap();
    assert_eq!(summary["verdict"], "error");
    let reason = summary["reasons"][0].as_str().unwrap();
    assert!(reason.contains("pulled its plug"), "{reason}");
    // With --json only the summary is on stdout, and the messages go to the terminal as well.
    assert_eq!(serde_json::from_slice::<Value>(&output.stdout).unwrap(), summary);
    assert!(said.contains(&format!("octant: {reason}\n")), "{said}");
    assert!(said.contains("the recorded part is in") && said.contains("gone.partial"), "{said}");
}

#[test]
fn a_device_that_is_killed_is_an_error_of_the_bench() {
    let bench = Bench::new(&std::fs::read_to_string(LOCKSTEP).unwrap());
    for (i, endpoint) in ["pty:", "udp:0"].into_iter().enumerate() {
        let served = Served::new(endpoint, &bench.scenario);
        let mut child = start(
            command(OCTANT)
                .args(["run", "--out"])
                .arg(bench.folder.path().join(format!("killed-{i}")))
                .args(["--set", "endpoint.link.answer=5 s", "--endpoint", &served.uri])
                .arg(&bench.scenario)
                .stdout(Stdio::null())
                .stderr(Stdio::piped()),
        );
        let recording = format!("killed-{i}.partial/recording.mcap");
        grows(&bench.folder.path().join(recording));
        served.signal("-KILL");
        let mut said = String::new();
        child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(4), "{said}");
        let partial = bench.folder.path().join(format!("killed-{i}.partial/summary.json"));
        let text = std::fs::read_to_string(partial).unwrap();
        let summary: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(summary["verdict"], "error");
        let reasons = summary["reasons"].to_string();
        let told = reasons.contains("no output to step") || reasons.contains("went away");
        assert!(told, "{endpoint}: {reasons}");
    }
}

#[test]
fn a_harness_that_is_killed_leaves_a_device_that_serves_the_next() {
    let bench = Bench::new(&SHORT.replace("\"5 s\"", "\"60 s\""));
    let expected = bench.hash("in-process", &[]);
    for (i, endpoint) in ["pty:", "udp:0"].into_iter().enumerate() {
        let served = Served::with_silence("5", endpoint, &bench.scenario);
        let out = bench.folder.path().join(format!("killed-{i}"));
        let mut child = start(
            command(OCTANT)
                .args(["run", "--endpoint", &served.uri, "--out"])
                .arg(&out)
                .arg(&bench.scenario)
                .stdout(Stdio::null())
                .stderr(Stdio::null()),
        );
        grows(&out.with_extension("partial").join("recording.mcap"));
        child.kill().unwrap();
        assert_eq!(child.wait().unwrap().code(), None, "it was killed before its end");
        // After the seconds of --silence the device is free.
        let found = bench.hash(&format!("after-{i}"), &["--endpoint", &served.uri]);
        assert_eq!(found, expected, "{endpoint}");
    }
}

/// Waits until a recording has reached its middle.
fn grows(recording: &Path) {
    let begun = Instant::now();
    while std::fs::metadata(recording).map_or(0, |about| about.len()) < 100_000 {
        assert!(begun.elapsed() < octant_test_processes::HANGS, "the run doesn't get on");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_stop_of_both_ends_is_no_silence() {
    let bench = Bench::new(&std::fs::read_to_string(LOCKSTEP).unwrap());
    let expected = bench.hash("in-process", &[]);
    let served = Served::with_silence("4", "udp:0", &bench.scenario);
    let out = bench.folder.path().join("stopped");
    let mut child = start(
        command(OCTANT)
            .args(["run", "--set", "endpoint.link.answer=4 s", "--endpoint", &served.uri, "--out"])
            .arg(&out)
            .arg(&bench.scenario)
            .stdout(Stdio::null()),
    );
    grows(&bench.folder.path().join("stopped.partial/recording.mcap"));
    let signal_both = |signal: &str| {
        let all = [child.id(), served.child.id()].map(|pid| pid.to_string());
        assert!(command("kill").arg(signal).args(all).status().unwrap().success());
    };
    signal_both("-STOP");
    // Twice as long as either end waits for the other.
    std::thread::sleep(Duration::from_secs(8));
    signal_both("-CONT");
    assert!(child.wait().unwrap().success());
    assert_eq!(bench.summary("stopped")["stream_hash"].as_str().unwrap(), expected);
    let (status, said) = served.stop("-TERM");
    assert_eq!(status, Some(0), "{said}");
    assert!(!said.contains("nothing heard"), "{said}");
}

#[test]
fn what_does_not_fit_is_refused_before_anything_is_stepped() {
    let bench = Bench::new(SHORT);
    let served = Served::new("udp:0", &bench.scenario);
    let refused = |more: &[&str], status: i32| {
        let mut all = vec!["--endpoint", served.uri.as_str()];
        all.extend(more);
        let output = bench.run(&bench.scenario, "refused", &all);
        assert_eq!(output.status.code(), Some(status));
        let _ = std::fs::remove_dir_all(bench.folder.path().join("refused.partial"));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let said = refused(&["--set", "site.latitude=40 deg"], 2);
    assert!(said.contains("give both the same scenario"), "{said}");
    // Both have the same seed too.
    let seeded = Served::with("60", "udp:0", &bench.scenario, &["--seed", "7"]);
    for (more, status) in [(&[][..], 2), (&["--seed", "7"], 0)] {
        let all = [&["--endpoint", seeded.uri.as_str()], more].concat();
        let output = bench.run(&bench.scenario, "seeded", &all);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(status), "{said}");
        assert!(status == 0 || said.contains("give both the same scenario"), "{said}");
        let _ = std::fs::remove_dir_all(bench.folder.path().join("seeded.partial"));
    }
    let said = refused(&["--set", "imu.rate=100 Hz"], 2);
    assert!(said.contains("sample period"), "{said}");
    // A scenario with a baseline, for which a device has no second core.
    let quick = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/quick.toml");
    let output = bench.run(Path::new(quick), "quick", &["--endpoint", &served.uri]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("[baseline] on the device"), "{said}");
    assert!(!bench.folder.path().join("quick.partial").exists(), "nothing was begun");
    let nobody = ["--endpoint", "udp:127.0.0.1:9", "--set", "endpoint.link.hello=300 ms"];
    let output = bench.run(&bench.scenario, "nobody", &nobody);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert!(said.contains("no hello within 0.") && said.contains("udp:127.0.0.1:9"), "{said}");
}

#[test]
fn a_fault_of_the_wire_needs_a_wire_on_which_it_happens() {
    let fault = |kind: &str| {
        format!("{SHORT}[[faults]]\nid = \"a\"\nkind = {kind:?}\ntrigger = {{ at = \"3 s\" }}\n")
    };
    for (kind, endpoint, expected) in [
        ("wire-loss", "in-process", "there is none: endpoint.uri names no port"),
        ("serial-break", "udp:127.0.0.1:9", "doesn't happen on UDP"),
        ("can-bus-off", "serial:/dev/null", "doesn't happen on a serial line"),
        ("wire-insert", "can:can0", "doesn't happen on a CAN bus"),
    ] {
        let bench = Bench::new(&fault(kind));
        let output = bench.run(&bench.scenario, "x", &["--endpoint", endpoint]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(expected), "{kind}: {said}");
    }
}
