//! `octant smooth`: what a whole calibration knows, and whether its constants are constant.

mod history;

use crate::failure::Failure;
use crate::run_folder::recording_of;
use crate::score::scenario_of;
use crate::terminal::{print, print_json};
use clap::Args;
use octant_base::number::{counted, significant};
use octant_calibration::config::{Calibration, Estimator};
use octant_calibration::covariance::{PARAMETERS, STATE_COUNT};
use octant_endpoint::InProcess;
use octant_observe::covariance::state_name;
use octant_observe::ensemble::state_unit;
use octant_run::smoothed::repeat_calibration;
use octant_run::smoothing_doubts::SmoothingDoubts;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};
use octant_smoother::backward::{SmoothedCalibration, SmootherError};
use octant_smoother::constancy::{self, ConstancyFinding, NODES_MAX, ParameterChange};
use octant_source::Replay;
use octant_source::configure::configurations;
use octant_verdict::Verdict;
use serde::Serialize;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(super) struct SmoothArguments {
    /// A run: its folder, or a full-rate recording.
    #[arg(value_name = "RUN")]
    run: PathBuf,
    /// Write the estimates and their σ over time, filtered and smoothed, to a new file.
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// A calibration, smoothed.
#[derive(Serialize)]
struct Report {
    method: String,
    /// Measurements that were smoothed, and the filter's time at the first and at the last, s.
    measurements: usize,
    between_s: (f64, f64),
    mean_nis: f64,
    /// True if the core of this program gives the recorded outputs and parameters.
    equal_to_recording: bool,
    states: Vec<StateRow>,
    /// Parameters that are known too little to be tested.
    untested: Vec<&'static str>,
    changes: Vec<ChangeRow>,
    /// Why the tests aren't normal here, and their results count for nothing.
    invalid: Vec<String>,
    /// Why the tests don't cover the calibration, so that finding nothing counts for nothing.
    incomplete: Vec<String>,
}

/// σ of a state on the way, the median over the nodes.
#[derive(Serialize)]
struct StateRow {
    name: String,
    unit: &'static str,
    filtered: f64,
    smoothed: f64,
}

/// The largest change of a kind.
#[derive(Serialize)]
struct ChangeRow {
    change: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    correlation_time_s: Option<f64>,
    parameter: &'static str,
    between_s: (f64, f64),
    sigmas: f64,
    /// Above it the change isn't noise.
    limit_sigmas: f64,
    size: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    size_sigma: Option<f64>,
    unit: String,
}

impl ChangeRow {
    /// True above the limit, and for a σ that isn't a number.
    fn is_found(&self) -> bool {
        !(self.sigmas <= self.limit_sigmas)
    }
}

pub(super) fn command(arguments: &SmoothArguments) -> Result<Verdict, Failure> {
    let SmoothArguments { run, csv, json } = arguments;
    let path = recording_of(run)?;
    let (scenario, method, seed) = scenario_of(&path)?;
    let bad = |error: &dyn std::fmt::Display| Failure::input(format!("failed to {error}"));
    let (_, config, _) = configurations(&scenario, method, seed).map_err(|e| bad(&e))?;
    let endpoint = InProcess::new(&config).map_err(|e| bad(&format!("set up the core: {e}")))?;
    let source = Replay::open(&path, None).map_err(|e| bad(&e))?;
    let mut repeated =
        repeat_calibration(source, endpoint, &config, NODES_MAX).map_err(|e| bad(&e))?;
    let smoothed = repeated.history.smooth().map_err(|e| bad(&e))?;
    let Some(Calibration { estimator: Estimator::Kalman(kalman), .. }) = &config.calibration else {
        return Err(bad(&SmootherError::NoFilter { found: "none" }));
    };
    let (tested, changes) = changes(&smoothed, repeated.history.prior());
    let doubts = SmoothingDoubts::of(&config, kalman, &repeated, &smoothed, &tested);
    let history = &repeated.history;
    let report = Report {
        method: scenario.method_label(method),
        measurements: history.len(),
        between_s: (history.begins_s(), history.ends_s()),
        mean_nis: smoothed.mean_nis,
        equal_to_recording: repeated.replayed.first_difference_sample.is_none(),
        states: moving_states(&smoothed, kalman.further.gyro_rate_random_walk > 0.0),
        untested: (0..PARAMETER_COUNT).filter(|i| !tested.contains(i)).map(|i| NAMES[i]).collect(),
        changes,
        invalid: doubts.invalid,
        incomplete: doubts.incomplete,
    };
    if let Some(file) = csv {
        history::write(file, &smoothed)?;
    }
    if *json {
        print_json(&report)?
    } else {
        print(&text(&report))?
    }
    let changed = report.changes.iter().any(ChangeRow::is_found);
    Ok(match (report.invalid.is_empty(), changed, report.incomplete.is_empty()) {
        (true, true, _) => Verdict::Fail,
        (true, false, true) => Verdict::Pass,
        _ => Verdict::Inconclusive,
    })
}

/// The states that move: attitude, velocity and position, and gyro biases that walk.
fn moving_states(smoothed: &SmoothedCalibration, walks: bool) -> Vec<StateRow> {
    let end = if walks { PARAMETERS + 3 } else { PARAMETERS };
    let covariances: Vec<_> = smoothed
        .nodes
        .iter()
        .map(|node| (node.filtered_covariance().diagonal(), node.covariance().diagonal()))
        .collect();
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).map_or(0.0, |variance| libm::sqrt(variance.max(0.0)))
    };
    let row = |state: usize| {
        let (unit, si) = state_unit(state);
        StateRow {
            name: state_name(state),
            unit,
            filtered: median(covariances.iter().map(|(filtered, _)| filtered[state]).collect())
                / si,
            smoothed: median(covariances.iter().map(|(_, smoothed)| smoothed[state]).collect())
                / si,
        }
    };
    (0..end.min(STATE_COUNT)).map(row).collect()
}

/// The parameters that are tested, and the largest finding of each kind.
fn changes(
    smoothed: &SmoothedCalibration,
    prior: &[f64; STATE_COUNT],
) -> (Vec<usize>, Vec<ChangeRow>) {
    let mut largest: Vec<ConstancyFinding> = Vec::new();
    let mut tested = Vec::new();
    constancy::test(smoothed, prior, |found| {
        if tested.last() != Some(&found.parameter) {
            tested.push(found.parameter);
        }
        match largest.iter_mut().find(|known| known.change == found.change) {
            Some(known) if known.sigmas >= found.sigmas => {}
            Some(known) => *known = found,
            None => largest.push(found),
        }
    });
    (tested, largest.iter().map(change_row).collect())
}

fn change_row(found: &ConstancyFinding) -> ChangeRow {
    let (unit, si) = state_unit(PARAMETERS + found.parameter);
    let (change, correlation_time_s, per) = match found.change {
        ParameterChange::Jump => ("jump", None, ""),
        ParameterChange::Pulse => ("jump and back", None, ""),
        ParameterChange::Ramp => ("ramp", None, ""),
        ParameterChange::Walk => ("random walk", None, "/√h"),
        ParameterChange::Wander { correlation_time_s } => {
            ("Gauss-Markov", Some(correlation_time_s), "")
        }
    };
    // A walk is a change in the square root of a time.
    let time = if per.is_empty() { 1.0 } else { 60.0 };
    ChangeRow {
        change,
        correlation_time_s,
        parameter: NAMES[found.parameter],
        between_s: found.between_s,
        sigmas: found.sigmas,
        limit_sigmas: found.change.limit_sigmas(),
        size: found.size * time / si,
        size_sigma: found.size_sigma.map(|sigma| sigma * time / si),
        unit: format!("{unit}{per}"),
    }
}

fn text(report: &Report) -> String {
    use std::fmt::Write as _;
    let (from_s, to_s) = report.between_s;
    let mut out = format!(
        "{}: {} from {from_s:.0} to {to_s:.0} s of the filter, mean NIS {} (3 is expected)\n",
        report.method,
        counted(report.measurements as u64, "measurement", "measurements"),
        significant(report.mean_nis, 3),
    );
    if from_s > 0.0 {
        out += "  what came before the last recovery is left out\n";
    }
    if !report.equal_to_recording {
        out += "  the core of this program answers otherwise than the recorded one: this is about its own filter\n";
    }
    let _ =
        writeln!(out, "  {:24} {:>10} {:>10}  unit", "median σ on the way", "filter", "smoothed");
    for state in &report.states {
        let _ = writeln!(
            out,
            "  {:24} {:>10} {:>10}  {}",
            state.name,
            significant(state.filtered, 3),
            significant(state.smoothed, 3),
            state.unit
        );
    }
    out += "  the parameters are constants: at the end the filter knows what the smoother knows, nothing is gained\n";
    let _ = writeln!(
        out,
        "  {:24} {:>6} {:>6}  {:24} {:>14}  size",
        "largest change", "σ", "limit", "parameter", "s"
    );
    for change in &report.changes {
        let name = match change.correlation_time_s {
            Some(time_s) => format!("{}, {time_s:.0} s", change.change),
            None => change.change.to_owned(),
        };
        let (from_s, to_s) = change.between_s;
        let span = match change.change {
            "jump" => format!("from {from_s:.0}"),
            _ => format!("{from_s:.0} to {to_s:.0}"),
        };
        let size = significant(change.size, 3);
        let sigma = change
            .size_sigma
            .map_or_else(String::new, |sigma| format!(" ± {}", significant(sigma, 2)));
        let _ = writeln!(
            out,
            "  {name:24} {:>6.2} {:>6.1}  {:24} {span:>14}  {size}{sigma} {}",
            change.sigmas, change.limit_sigmas, change.parameter, change.unit
        );
    }
    if !report.untested.is_empty() {
        let _ = writeln!(out, "  known too little to be tested: {}", report.untested.join(", "));
    }
    for doubt in &report.invalid {
        let _ = writeln!(out, "  inconclusive, the tests don't hold: {doubt}");
    }
    for doubt in &report.incomplete {
        let _ = writeln!(out, "  incomplete: {doubt}");
    }
    out += match (report.invalid.is_empty(), report.changes.iter().any(ChangeRow::is_found)) {
        (false, _) => "",
        (true, true) => "  above its limit: what the calibration takes for constant has changed\n",
        (true, false) if report.incomplete.is_empty() => {
            "  none is above its limit: the data agree with constants\n"
        }
        (true, false) => "  inconclusive: none is above its limit, but not all was tested\n",
    };
    out
}
