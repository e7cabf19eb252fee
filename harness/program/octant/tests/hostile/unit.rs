//! The core behind a port, with its answers altered on the way.

use octant_base::control::Control;
use octant_endpoint::ServedCore;
use octant_link::device::{Device, Notice, Steps};
use octant_link::port::{self, Bytes as _, Pty};
use octant_link::{Uri, Wire};
use octant_run::assemble;
use octant_run::{StreamKeeping, core_of, run_as_far_as_it_goes};
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{Aiding, Output, Parameters, Sample};
use octant_scenario::{Method, Scenario};
use octant_score::summary::Summary;
use octant_wire::EndRole;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// 20 s of calibration through a move and 10 s of navigation at 50 Hz.
pub const SCENARIO: &str = r#"
schema = 1
title = "hostile"
seed = 3
[imu]
rate = "50 Hz"
[procedure.calibration]
duration = "20 s"
stops = [{ azimuth = "0 deg", roll = "0 deg" }, { azimuth = "0 deg", roll = "45 deg" }]
[procedure.navigation]
duration = "10 s"
[[requirements]]
id = "NEAR"
text = "It stays near."
measure = "navigation.radial_error_nmi.max"
limit = "1 nmi"
[[requirements]]
id = "SIGMA"
text = "The errors are as large as their uncertainty says."
measure = "calibration.worst_normalized_error"
limit = 10
[[requirements]]
id = "NIS"
text = "The innovations agree with the tuning."
measure = "calibration.nis_mean"
limit = 6
"#;

/// Number of samples of the calibration, of the run, and of a second.
pub const CALIBRATION: u64 = 1000;
pub const ALL: u64 = 1500;
pub const SECOND: u64 = 50;

/// Alteration of the core's answers.
#[derive(Clone, Copy)]
pub struct Twist {
    pub answer: fn(&mut Turn<'_>),
    pub parameters: fn(u64, &mut [f64; PARAMETER_COUNT], &mut [f64; PARAMETER_COUNT]),
    /// Silence after which the unit considers the harness gone, ms; chosen by the unit, as usual.
    pub silence_ms: u16,
}

/// Alters nothing.
pub const HONEST: Twist = Twist { answer: |_| {}, parameters: |_, _, _| {}, silence_ms: 60_000 };

/// Answer on its way.
pub struct Turn<'a> {
    /// Number of the sample since the start, from 1.
    pub k: u64,
    pub output: &'a mut Output,
    /// Earlier outputs, in order.
    pub before: &'a [Output],
}

pub struct Twisted {
    core: ServedCore,
    twist: Twist,
    before: Vec<Output>,
}

impl Twisted {
    pub fn new(core: ServedCore, twist: Twist) -> Self {
        Self { core, twist, before: Vec::new() }
    }
}

impl Steps for Twisted {
    fn restart(&mut self, offset: Option<&Parameters>) -> Result<(), String> {
        self.before.clear();
        self.core.restart(offset)
    }

    fn step(&mut self, sample: &Sample, aiding: Option<&Aiding>, output: &mut Output) {
        self.core.step(sample, aiding, output);
        let own = *output;
        let k = self.before.len() as u64 + 1;
        (self.twist.answer)(&mut Turn { k, output, before: &self.before });
        self.before.push(own);
    }

    fn end(&mut self) -> Output {
        self.core.end()
    }

    fn parameters(&self) -> (Parameters, [f64; PARAMETER_COUNT]) {
        let (parameters, mut sigma) = self.core.parameters();
        let mut values = parameters.to_array();
        (self.twist.parameters)(self.before.len() as u64, &mut values, &mut sigma);
        (Parameters::from_array(&values), sigma)
    }
}

/// Kinds of ports to a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    Serial,
    Udp,
    Can,
}

/// Device on a thread, for one run.
pub struct Served {
    stop: Arc<AtomicBool>,
    threads: Vec<std::thread::JoinHandle<()>>,
    /// URI for the harness.
    pub uri: String,
}

impl Served {
    pub fn new(over: Over, scenario: &Scenario, twist: Twist) -> Self {
        serve_patiently(over, scenario, twist.silence_ms, move |core| Twisted::new(core, twist))
    }
}

/// Serves a unit that is made of the core.
pub fn serve<S: Steps>(
    over: Over,
    scenario: &Scenario,
    unit: impl FnOnce(ServedCore) -> S + Send + 'static,
) -> Served {
    serve_patiently(over, scenario, HONEST.silence_ms, unit)
}

fn serve_patiently<S: Steps>(
    over: Over,
    scenario: &Scenario,
    silence_ms: u16,
    unit: impl FnOnce(ServedCore) -> S + Send + 'static,
) -> Served {
    let config = core_of(scenario, Method::Primary, scenario.seed).unwrap();
    let core = ServedCore::new(&config).unwrap();
    let facts = core.facts(silence_ms);
    let stop = Arc::new(AtomicBool::new(false));
    let mut threads = Vec::new();
    let (uri, reached): (Uri, Option<String>) = match over {
        Over::Serial => ("pty:".parse().unwrap(), None),
        Over::Udp => ("udp:0".parse().unwrap(), None),
        Over::Can => {
            let (near, far, bridge) = bridge(&stop);
            threads.push(bridge);
            (far.parse().unwrap(), Some(near))
        }
    };
    let port = port::open(&uri, EndRole::Device).unwrap();
    let reached = reached.unwrap_or_else(|| port::announcement(&uri, &port));
    let wire = Wire::new(uri.to_string(), port, EndRole::Device);
    let until = Arc::clone(&stop);
    threads.push(std::thread::spawn(move || {
        let mut steps = unit(core);
        let mut notice = |_: &Notice| {};
        let mut device = Device::new(wire, facts, &mut steps, &mut notice).unwrap();
        // The loss of the port ends the session.
        let _ = device.serve(&until);
    }));
    Served { stop, threads, uri: reached }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Opens two CAN adapters that speak slcan, on one bus: frames into one come out of the other.
fn bridge(stop: &Arc<AtomicBool>) -> (String, String, std::thread::JoinHandle<()>) {
    let mut lines = [Pty::open("").unwrap(), Pty::open("").unwrap()];
    let [near, far] =
        [&lines[0], &lines[1]].map(|line| format!("slcan:{}?bitrate=1000000", line.name()));
    let until = Arc::clone(stop);
    let thread = std::thread::spawn(move || {
        let mut texts = [Vec::new(), Vec::new()];
        let mut buffer = [0; 4096];
        while !until.load(Ordering::Relaxed) {
            let mut idle = true;
            for from in 0..2 {
                let wait = if idle { Duration::from_micros(200) } else { Duration::ZERO };
                let Ok(count) = lines[from].receive(&mut buffer, wait) else { continue };
                idle &= count == 0;
                texts[from].extend_from_slice(&buffer[..count]);
                while let Some(end) = texts[from].iter().position(|byte| *byte == b'\r') {
                    let line: Vec<u8> = texts[from].drain(..=end).collect();
                    let is_frame = line.first().is_some_and(|c| b"tTdDbBrR".contains(c));
                    let (to, text): (usize, &[u8]) =
                        if is_frame { (1 - from, &line) } else { (from, b"\r") };
                    // A closed end reads nothing.
                    let _ = lines[to].send(text, Duration::from_secs(1));
                }
            }
        }
    });
    (near, far, thread)
}

/// Parses the scenario of these tests with more at its end.
pub fn scenario(more: &str) -> Scenario {
    scenario_of(&format!("{SCENARIO}{more}"))
}

/// Parses a scenario.
pub fn scenario_of(text: &str) -> Scenario {
    Scenario::parse(text, "hostile.toml", Path::new(""), &[]).unwrap()
}

/// Returns the summary of a run against a unit.
pub fn run(over: Over, twist: Twist) -> Result<Summary, String> {
    run_of(&scenario(""), over, twist)
}

pub fn run_of(scenario: &Scenario, over: Over, twist: Twist) -> Result<Summary, String> {
    let served = Served::new(over, scenario, twist);
    let at = [
        format!("endpoint.uri={}", served.uri),
        "endpoint.link.answer=300 s".to_owned(),
        "endpoint.link.hello=300 s".to_owned(),
    ];
    let text = scenario.to_resolved_toml(
        scenario.seed,
        &octant_scenario::resolve::DrawnValues::of(
            scenario,
            &octant_scenario::resolve::Seeded(scenario.seed),
        ),
    );
    let scenario = Scenario::parse(&text, "hostile.toml", Path::new(""), &at).unwrap();
    summary_of(&scenario)
}

/// Returns the summary of a run.
pub fn summary_of(scenario: &Scenario) -> Result<Summary, String> {
    let control = Control::default();
    let run = run_as_far_as_it_goes(
        scenario,
        Method::Primary,
        scenario.seed,
        StreamKeeping::None,
        &control,
    )
    .map_err(|error| error.to_string())?;
    Ok(assemble(scenario, scenario.seed, run, None).unwrap().summary)
}

/// Compares the end of an attack with the expected one.
pub fn check(about: &str, ends: &super::Ends, found: Result<Summary, String>) {
    let (status, reasons) = match found {
        Ok(summary) => (summary.verdict.exit_code(), summary.reasons.join("; ")),
        // A run that can't begin, or whose device goes away without a message.
        Err(reason) => (octant_verdict::Verdict::Error.exit_code(), reason),
    };
    assert_eq!(status, ends.status, "{about}: {reasons}");
    assert!(
        reasons.contains(ends.because),
        "{about}: found {reasons:?}, expected {:?}",
        ends.because
    );
}
