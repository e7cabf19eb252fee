//! Runs by the clock: the results are the same, lateness is reported, and the thread of the samples
//! allocates nothing.

use crate::common::allocations;
use crate::common::program::{ends, json};
use octant_base::control::Control;
use octant_endpoint::{Endpoint, EndpointError, InProcess, Sent};
use octant_realtime::clock::{MonotonicTime, now};
use octant_recorder::{Recorder, RecorderOptions};
use octant_run::observers::done::PlannedWork;
use octant_run::realtime::run as run_by_clock;
use octant_run::{Bench, Ended, Faulted, Observers, Records, RunHost, StreamKeeping};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Output, Parameters};
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use octant_source::{Epoch, PlantSource};
use serde_json::Value;
use std::collections::VecDeque;
use std::path::Path;

const SECONDS: &str = "schema = 1\ntitle = \"by the clock\"\n[procedure.alignment]\nmethod = \"given\"\n\
    [procedure.navigation]\nduration = \"2 s\"\n[imu]\nrate = \"200 Hz\"\n[record]\nsamples = \"full\"\n\
    [realtime]\noverrun = \"10 s\"\n";

const FAULTS: &str = "[[faults]]\nid = \"spike-1\"\nkind = \"spike\"\nchannels = \"gyro x\"\n\
    amplitude = \"1000 deg/h\"\ntrigger = { at = \"0.5 s\" }\nduration = \"20 samples\"\n\
    [[faults]]\nid = \"late-1\"\nkind = \"late-delivery\"\ndelay = \"3 samples\"\n\
    trigger = { at = \"1 s\" }\nduration = \"20 samples\"\n";

fn scenario(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

fn run(folder: &Path, scenario: &str, out: &str, more: &[&str], status: i32) -> Value {
    let out = folder.join(out);
    let arguments = [&["run", scenario, "--out", out.to_str().unwrap()], more].concat();
    ends(&arguments, status);
    json(&out.join("summary.json"))
}

#[test]
fn the_clock_changes_nothing_of_what_is_computed() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    for (name, faults) in [("plain", ""), ("faulted", FAULTS)] {
        let file = scenario(here, &format!("{name}.toml"), &format!("{SECONDS}{faults}"));
        let free = run(here, &file, &format!("{name}-free"), &[], 0);
        let paced = run(here, &file, &format!("{name}-paced"), &["--realtime"], 0);
        assert!(free["pacing"].is_null());
        assert_eq!(paced["pacing"]["frames"], 400);
        assert_eq!(paced["pacing"]["late_answers"], 0);
        assert_eq!(paced["pacing"]["dropped_records"], 0);
        assert_eq!(paced["stream_hash"], free["stream_hash"], "{name}");
        assert_eq!(paced["faults"], free["faults"]);
        assert_eq!(paced["counterfactual"], free["counterfactual"]);
        assert_eq!(paced["navigation"], free["navigation"]);
        let manifest = json(&here.join(format!("{name}-paced/manifest.json")));
        let scheduling = &manifest["realtime"]["scheduling"]["outcome"];
        assert!(scheduling == "granted" || scheduling == "refused", "{manifest}");
        assert!(manifest["rerun"].as_str().unwrap().contains("--realtime"));
        assert!(json(&here.join(format!("{name}-free/manifest.json")))["realtime"].is_null());
        let report =
            std::fs::read_to_string(here.join(format!("{name}-paced/report.html"))).unwrap();
        assert!(report.contains("Against the clock"));
        // A recording made by the clock is replayed without it.
        let recording = here.join(format!("{name}-paced/recording.mcap"));
        let (text, _) = ends(&["replay", recording.to_str().unwrap()], 0);
        assert!(text.contains("is equal to the recorded one"), "{text}");
    }
}

#[test]
fn a_bench_that_was_too_late_proves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    // No sample leaves earlier than a nanosecond after its deadline.
    let text = SECONDS.replace("\"2 s\"", "\"0.1 s\"").replace("\"10 s\"", "\"1 ns\"");
    let file = scenario(here, "late.toml", &text);
    let summary = run(here, &file, "late", &["--realtime"], 3);
    assert_eq!(summary["verdict"], "inconclusive");
    assert_eq!(summary["pacing"]["overruns"], 20);
    let reason = summary["reasons"][0].as_str().unwrap();
    assert!(reason.starts_with("the bench failed at 0 s: a sample left "), "{reason}");
    assert_eq!(summary["done"]["navigation_s"], 0.0, "nothing after it counts");
    let reason = summary["reasons"][1].as_str().unwrap();
    assert!(reason.starts_with("the bench was late: 20 of 20 samples left more than"), "{reason}");
    let allowed = run(here, &file, "allowed", &["--realtime", "--set", "realtime.overruns=20"], 0);
    assert_eq!(allowed["verdict"], "none");
    // Every sample is an interval of its own, and an overrun of it.
    let over = &allowed["pacing"]["lateness_over_run"];
    assert_eq!(over["frames_per_interval"], 1);
    assert_eq!(over["overruns"], Value::from(vec![1; 20]));
    assert_eq!(over["largest_ns"], over["least_ns"]);
    let largest = over["largest_ns"].as_array().unwrap().iter().filter_map(Value::as_f64);
    let max = allowed["pacing"]["lateness_us"]["max"].as_f64().unwrap();
    assert_eq!(largest.fold(0.0, f64::max) / 1e3, max);
    let report = std::fs::read_to_string(here.join("allowed/report.html")).unwrap();
    let chart = report.split("aria-label=\"Lateness over the run\"").nth(1).unwrap();
    assert!(chart.contains("20 overruns") && chart.contains("smallest to largest in 0.005 s"));
    let p99 =
        ["--realtime", "--set", "realtime.overruns=20", "--set", "realtime.lateness_p99=\"1 ns\""];
    let summary = run(here, &file, "p99", &p99, 3);
    let reason = summary["reasons"][0].as_str().unwrap();
    assert!(reason.contains("the lateness of 99 % of the samples is"), "{reason}");
}

#[test]
fn a_run_whose_bench_is_lost_ends_there_where_it_is_told_to() {
    let folder = tempfile::tempdir().unwrap();
    let here = folder.path();
    // A minute by the clock, of which no sample leaves in time; and a twin.
    let text = SECONDS.replace("\"2 s\"", "\"60 s\"").replace("\"10 s\"", "\"1 ns\"");
    let file = scenario(here, "lost.toml", &format!("{text}{FAULTS}"));
    let lost = run(here, &file, "lost", &["--realtime", "--stop-when-lost"], 3);
    assert!(lost["pacing"]["frames"].as_u64().unwrap() < 12_000, "{}", lost["pacing"]);
    assert_eq!((&lost["verdict"], &lost["counterfactual"]), (&"inconclusive".into(), &Value::Null));
    let reasons: Vec<&str> =
        lost["reasons"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(reasons[0].starts_with("the bench failed at 0 s: a sample left "), "{reasons:?}");
    assert!(
        reasons[0].ends_with("; the run was ended there, as --stop-when-lost asks"),
        "{reasons:?}"
    );
    assert!(reasons.contains(&"navigation: planned 60 s, done 0 s"), "{reasons:?}");
    let manifest = json(&here.join("lost/manifest.json"));
    assert!(manifest["rerun"].as_str().unwrap().contains("--realtime --stop-when-lost"));
    // In simulated time nothing is late: the option would do nothing.
    let (_, said) = ends(&["run", &file, "--stop-when-lost"], 2);
    assert!(said.contains("--stop-when-lost: found a run in simulated time"), "{said}");
}

/// Core whose answers to some epochs are delayed.
struct Slow {
    inside: InProcess,
    /// Number of frames by which the answer to a sample is delayed.
    held: fn(u64) -> u32,
    waiting: VecDeque<(u32, Output)>,
    number: u64,
    /// Samples between which the thread's allocations are counted.
    watched: Option<(u64, u64)>,
    counted: Option<u64>,
}

impl Slow {
    fn new(inside: InProcess, held: fn(u64) -> u32) -> Self {
        let waiting = VecDeque::with_capacity(1024);
        Self { inside, held, waiting, number: 0, watched: None, counted: None }
    }
}

impl Endpoint for Slow {
    fn step(&mut self, epoch: &Epoch, output: &mut Output) -> Result<(), EndpointError> {
        self.inside.step(epoch, output)
    }

    fn uri(&self) -> String {
        "slow".to_owned()
    }

    fn send(&mut self, epoch: &Epoch, _output: &mut Output) -> Result<Sent, EndpointError> {
        self.number += 1;
        if let Some((from, to)) = self.watched {
            if self.number == from {
                allocations::watch();
            }
            if self.number == to {
                self.counted = allocations::watched();
            }
        }
        self.waiting.iter_mut().for_each(|(frames, _)| *frames = frames.saturating_sub(1));
        let mut answer = Output::default();
        self.inside.step(epoch, &mut answer)?;
        self.waiting.push_back(((self.held)(self.number), answer));
        Ok(Sent::Underway)
    }

    fn answer(
        &mut self,
        until: MonotonicTime,
        output: &mut Output,
    ) -> Result<Option<usize>, EndpointError> {
        if self.waiting.front().is_some_and(|(frames, _)| *frames == 0)
            && let Some((_, answer)) = self.waiting.pop_front()
        {
            *output = answer;
            return Ok(Some(0));
        }
        octant_realtime::clock::sleep_until(until);
        Ok(None)
    }

    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), EndpointError> {
        self.inside.restart(offset)
    }

    fn parameters(&self) -> ParameterEstimate {
        self.inside.parameters()
    }
}

fn drive(
    held: fn(u64) -> u32,
    more: &str,
    watched: Option<(u64, u64)>,
) -> (Result<Ended, String>, octant_run::TimeKeeping, octant_recorder::RecorderSummary, Option<u64>)
{
    let folder = tempfile::tempdir().unwrap();
    // Memory locking would lock all of this process, with the tests beside this one.
    let text = format!("{SECONDS}lock_memory = false\n{more}");
    let path = scenario(folder.path(), "s.toml", &text);
    let scenario = Scenario::load(Path::new(&path), &[]).unwrap();
    let (plant, core, _) = configurations(&scenario, Method::Primary, 1).unwrap();
    let source = PlantSource::new(&plant, scenario.samples().unwrap()).unwrap();
    let mut endpoint = Slow::new(InProcess::new(&core).unwrap(), held);
    endpoint.watched = watched;
    let options = RecorderOptions::default();
    let faulted = scenario.station(1).unwrap().map(|station| Faulted {
        station,
        fires: Vec::new(),
        host: RunHost::new(&scenario, &StreamKeeping::File(Path::new("sink")), &options.trouble)
            .unwrap(),
    });
    let recorder = Recorder::to_writer(std::io::sink(), &options).unwrap();
    let (observers, control) = (Observers::new(PlannedWork::default()), Control::default());
    let records = Records::new(recorder, observers, &control);
    let mut bench = Bench::of_parts(source, endpoint, faulted, records);
    run_by_clock(&mut bench, &scenario.realtime, scenario.sample_period_ns);
    let ended = bench.ended.take().unwrap().map_err(|error| error.to_string());
    let (kept, counted) = (bench.kept.take().unwrap(), bench.endpoint.counted);
    (ended, kept, bench.keeper.recorder.finish().unwrap(), counted)
}

#[test]
fn late_answers_are_counted_and_recorded_with_their_samples() {
    let start = now();
    let (ended, kept, in_time, _) = drive(|_| 0, "", None);
    assert!(now().since(start) >= 2_000_000_000, "400 periods of 5 ms");
    assert_eq!(ended, Ok(Ended::Done));
    assert_eq!((kept.pacing.frames, kept.pacing.late_answers), (400, 0));
    assert_eq!(in_time.epochs, 400);
    // The answers to samples 100 and 101 come three frames late, and those of 102 and 103 after
    // them.
    let (ended, kept, late, _) = drive(|number| if number / 2 == 50 { 3 } else { 0 }, "", None);
    assert_eq!(ended, Ok(Ended::Done));
    assert_eq!((kept.pacing.frames, kept.pacing.late_answers), (400, 4));
    assert_eq!(late.epochs, 400, "every answer found its sample");
    assert_eq!(late.stream_hash, in_time.stream_hash, "the gimbals stand: nothing hangs on when");
    // Three periods; frames that a stalled host makes late follow each other at once.
    let lateness_us = kept.pacing.lateness_us.max;
    assert!(kept.pacing.answer_us.max + lateness_us > 14_000.0, "{:?}", kept.pacing);
    let total: u64 = kept.pacing.lateness_histogram_ns.iter().map(|[_, count]| count).sum();
    assert_eq!(total, 400);
}

#[test]
fn an_endpoint_that_falls_silent_ends_the_run() {
    let held = |number| if number >= 50 { u32::MAX } else { 0 };
    let (ended, kept, summary, _) = drive(held, "silence = \"1 s\"\n", None);
    let error = ended.unwrap_err();
    let waited = error.strip_prefix("endpoint slow is gone: no answer to sample 50 for ");
    let waited_s: f64 = waited.and_then(|w| w.split(' ').next()?.parse().ok()).expect(&error);
    assert!(waited_s >= 1.0, "{error}");
    assert_eq!(summary.epochs, 49, "what was answered is recorded");
    // 200 periods of silence; fewer frames if the host stalled meanwhile.
    assert!((50..260).contains(&kept.pacing.frames), "{:?}", kept.pacing);
}

#[test]
fn the_thread_of_the_samples_allocates_nothing() {
    let held = |number| if number % 16 == 3 { 2 } else { 0 };
    let (ended, _, _, counted) = drive(held, "", Some((10, 390)));
    assert_eq!(ended, Ok(Ended::Done));
    assert_eq!(counted, Some(0));
    // Checks that the counter counts.
    allocations::watch();
    let boxed = std::hint::black_box(Box::new(1));
    assert_eq!(allocations::watched(), Some(*boxed));
}

#[test]
fn a_fault_of_the_host_is_raised_without_an_allocation() {
    let faults = "pace = \"clock\"\n[[faults]]\nid = \"starved\"\nkind = \"host-cpu-starved\"\n\
        length = \"20 ms\"\ntrigger = { every = \"0.5 s\" }\n[[faults]]\nid = \"stalled\"\n\
        kind = \"host-recorder-stalled\"\npause = \"100 ms\"\ntrigger = { at = \"1 s\" }\n";
    let (ended, kept, recorded, counted) = drive(|_| 0, faults, Some((10, 390)));
    assert_eq!(ended, Ok(Ended::Done));
    assert_eq!(counted, Some(0));
    assert_eq!((recorded.epochs, kept.pacing.dropped_records), (400, 0));
}
