//! Description of a run, from its scenario.

use octant_base::number::plain;
use octant_faults::trigger::Trigger;
use octant_recorder::reader::Info;
use octant_sample::{Mode, Parameters};
use octant_scenario::resolve::{DrawnValues, Seeded};
use octant_scenario::{CalibrationSpec, Fault, Method, NumberedStops, Scenario};
use std::path::Path;

/// Fault that is armed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Armed {
    /// Id in the scenario.
    pub id: String,
    /// Kind.
    pub kind: String,
    /// Condition that it waits for, as text.
    pub when: String,
}

/// Description of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// Title of the scenario.
    pub title: String,
    /// Name of the method.
    pub method: String,
    /// Seed of every draw.
    pub seed: u64,
    /// Sample period, ns.
    pub sample_period_ns: Option<u64>,
    /// Length of the whole procedure, ns; `None` where it lasts until the source ends.
    pub length_ns: Option<u64>,
    /// Stops of the calibration with their positions; `None` without one.
    pub stops: Option<NumberedStops>,
    /// True if the run goes by the clock.
    pub by_clock: bool,
    /// Lateness from which a sample is an overrun, µs, in a run by the clock.
    pub overrun_us: Option<f64>,
    /// Faults that are armed, in order.
    pub faults: Vec<Armed>,
    /// True parameters of the instrument, where they are known.
    pub truth: Option<Parameters>,
    /// Reason why nothing of the above is known.
    pub unread: Option<String>,
}

impl About {
    /// Reads the scenario in a recording in a folder. If it can't be read, the rest of the run can
    /// still be watched.
    #[must_use]
    pub fn of(info: &Info, folder: &Path) -> Self {
        let scenario = match Scenario::parse(&info.scenario, "scenario.toml", folder, &[]) {
            Ok(scenario) => scenario,
            Err(error) => return Self { unread: Some(error.to_string()), ..Self::default() },
        };
        let is_baseline = info.run.get("method").is_some_and(|method| method == "baseline");
        let method = if is_baseline { Method::Baseline } else { Method::Primary };
        let seed = info.run.get("seed").and_then(|seed| seed.parse().ok()).unwrap_or(scenario.seed);
        let has_truth = info.run.get("true_parameters").is_some_and(|text| text == "true");
        let truth = has_truth.then(|| DrawnValues::of(&scenario, &Seeded(seed)).parameters);
        Self::of_run(&scenario, method, seed, truth)
    }

    /// Describes a run of a scenario, whose true parameters are known or not.
    #[must_use]
    pub fn of_run(
        scenario: &Scenario,
        method: Method,
        seed: u64,
        truth: Option<Parameters>,
    ) -> Self {
        let calibration = match method {
            Method::Primary => &scenario.calibration,
            Method::Baseline => &scenario.baseline,
        };
        let stops = calibration.as_ref().map(CalibrationSpec::numbered_stops);
        Self {
            title: scenario.title.clone(),
            method: scenario.method_label(method),
            seed,
            sample_period_ns: Some(scenario.sample_period_ns),
            length_ns: scenario.samples().map(|n| n.saturating_mul(scenario.sample_period_ns)),
            stops,
            by_clock: scenario.realtime.by_clock,
            overrun_us: (scenario.realtime.by_clock)
                .then(|| scenario.realtime.overrun_ns as f64 / 1e3),
            faults: (scenario.faults.iter())
                .map(|fault| Armed {
                    id: fault.spec.id.clone(),
                    kind: fault.spec.kind.name.to_owned(),
                    when: when(fault, stops.as_ref(), scenario.sample_period_ns),
                })
                .collect(),
            truth,
            unread: None,
        }
    }
}

/// Describes the condition that a fault waits for.
fn when(fault: &Fault, stops: Option<&NumberedStops>, period_ns: u64) -> String {
    let fires = &fault.fires;
    // A fault that sets in at time t first alters the interval that begins there.
    let at = |epoch: u64| time(epoch.saturating_sub(1), period_ns);
    let after = |delay: u64| match delay {
        0 => String::new(),
        delay => format!(", {} later", time(delay, period_ns)),
    };
    let place = |stop: u16, mode: Mode| {
        let stop = usize::from(stop);
        match stops.filter(|_| mode == Mode::Calibrating) {
            Some(stops) => format!("stop {}", stops.describe(stop)),
            None => format!("stop {} while {}", stop + 1, mode.name()),
        }
    };
    match &fault.spec.schedule.trigger {
        Trigger::Epoch(epoch) => format!("at {}", at(*epoch)),
        Trigger::Position { stop, mode, delay } => {
            format!("at {}{}", place(*stop, *mode), after(*delay))
        }
        Trigger::Move { stop, mode, delay } => {
            format!("on the way to {}{}", place(*stop, *mode), after(*delay))
        }
        Trigger::Mode { mode, delay } => format!("once {}{}", mode.name(), after(*delay)),
        Trigger::Condition { delay, .. } => format!("on a condition{}", after(*delay)),
        Trigger::Periodic { first, period, .. } => {
            format!("every {} from {}", time(*period, period_ns), at(*first))
        }
        Trigger::Poisson { first, mean, .. } => {
            let mean = time(*mean as u64, period_ns);
            format!("at random, {mean} apart, from {}", at(*first))
        }
        Trigger::After { fault, delay } => format!("after {fault}{}", after(*delay)),
        Trigger::Manual if fires.is_empty() => "by hand, and nobody fires it".to_owned(),
        Trigger::Manual => {
            let times: Vec<String> = fires.iter().map(|epoch| at(*epoch)).collect();
            format!("by hand at {}", times.join(", "))
        }
        Trigger::Outside { delay } => format!("on a condition{}", after(*delay)),
    }
}

fn time(epochs: u64, period_ns: u64) -> String {
    format!("{} s", plain(epochs as f64 * period_ns as f64 * 1e-9, 9))
}
