//! Runs two methods over many seeds, on the same instruments with the same noise.

use super::once::run_method;
use crate::bench::ended::Ended;
use crate::bench::error::MethodError;
use crate::bench::recording::StreamKeeping;
use octant_base::control::Control;
use octant_base::failing::{Failing, FailureKind};
use octant_base::pool::{in_order, processors};
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_scenario::{Method, Scenario};
use octant_score::compare::{Maxima, MethodComparison, PairedRun, compare};
use octant_score::floor::Floor;
use octant_score::summary::CalibrationScore;
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;

/// Members of the ensemble from which the floor of the random walk is computed.
const FLOOR_MEMBERS: u32 = 400;
/// Marks at which methods are compared, h.
const MARKS_H: [f64; 2] = [24.0, 72.0];

/// A method of a scenario.
#[derive(Clone, Debug)]
pub struct MethodSide {
    /// The scenario.
    pub scenario: Scenario,
    /// Method of that scenario.
    pub method: Method,
}

/// Reasons why two methods could not be compared.
#[derive(Debug, thiserror::Error)]
pub enum PairedError {
    /// A run gave no result.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// No navigation, or too short a one.
    #[error("compare: both methods need a navigation of at least 24 h ([procedure.navigation])")]
    NoNavigation,
    /// Seeds have no effect on samples that are not simulated.
    #[error("compare: seeds need source.uri = \"plant\", or a ship under it")]
    NotSimulated,
    /// Interrupted on request.
    #[error("compare: interrupted")]
    Cancelled,
}

impl Failing for PairedError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Method(error) => error.kind(),
            Self::NoNavigation | Self::NotSimulated => FailureKind::Input,
            Self::Cancelled => FailureKind::Inconclusive,
        }
    }
}

/// Result of one side with one seed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SideResult {
    /// Largest errors; all unknown where the calibration was refused.
    pub maxima: Maxima,
    /// Reason of a refused calibration.
    pub refused: Option<String>,
    /// Errors of the g-dependent biases divided by their σ, in the order of
    /// [`octant_sample::parameters::NAMES`]; empty where one isn't estimated, or has no known truth.
    pub g_normalized: Vec<f64>,
}

/// Runs every seed with both sides on all processors, and compares. The order of the runs has no
/// effect on the result.
///
/// `controls` has one entry for each run: two per seed.
///
/// # Errors
/// If a run gives no result.
pub fn paired(
    first: &MethodSide,
    second: &MethodSide,
    seeds: &[u64],
    controls: &[Control],
) -> Result<MethodComparison, PairedError> {
    let scenario = &second.scenario;
    let results = paired_runs([first, second], seeds, processors(), controls)?;
    let runs: Vec<PairedRun> = seeds
        .iter()
        .zip(results)
        .map(|(seed, [first, second])| PairedRun {
            seed: *seed,
            first: first.maxima,
            second: second.maxima,
            first_refused: first.refused,
            second_refused: second.refused,
        })
        .collect();
    let lengths = [first, second].map(|side| navigated_h(&side.scenario));
    let navigation_h = (lengths[0] == lengths[1] && lengths[0].is_finite()).then_some(lengths[0]);
    let hours: Vec<f64> = MARKS_H.into_iter().chain(navigation_h).collect();
    let floor = Floor::new(
        scenario.site.latitude_rad,
        scenario.site.height_m,
        scenario.imu.angle_random_walk,
        scenario.imu.velocity_random_walk,
    )
    .at_heading(scenario.motion.heading_rad())
    .maxima(&hours, FLOOR_MEMBERS, scenario.seed);
    let [a, b] = [first, second].map(|side| side.scenario.method_label(side.method));
    let (a, b) = if a == b { (format!("{a} (first)"), format!("{b} (second)")) } else { (a, b) };
    let comparison = compare(&scenario.title, &a, &b, &runs, &floor, navigation_h);
    // Refusals of every seed are a result too.
    if comparison.cells.is_empty() && comparison.refusals.is_none() {
        return Err(PairedError::NoNavigation);
    }
    Ok(comparison)
}

/// Returns the length of the navigation, h; 0 without one.
fn navigated_h(scenario: &Scenario) -> f64 {
    let Some(plan) = &scenario.navigation else { return 0.0 };
    plan.duration_s.map_or(f64::INFINITY, |duration_s| duration_s / 3600.0)
}

/// Runs every seed with both sides on `jobs` threads, on the same instruments with the same noise. Neither
/// the number of threads nor the order of the runs has an effect on the results.
///
/// `controls` has one entry for each run: two per seed.
///
/// # Errors
/// If a run gives no result.
pub fn paired_runs(
    sides: [&MethodSide; 2],
    seeds: &[u64],
    jobs: usize,
    controls: &[Control],
) -> Result<Vec<[SideResult; 2]>, PairedError> {
    if sides.iter().any(|side| !side.scenario.source.has_plant()) {
        return Err(PairedError::NotSimulated);
    }
    // Reported before hours of simulation, not after.
    if sides.iter().any(|side| navigated_h(&side.scenario) < MARKS_H[0]) {
        return Err(PairedError::NoNavigation);
    }
    // Without one of them nothing can be concluded: the first failure ends the others.
    let work = |task: usize| {
        let control = controls.get(task).ok_or(PairedError::Cancelled)?;
        one(sides[task % 2], seeds[task / 2], control).map(Some)
    };
    let mut results = in_order(jobs, 2 * seeds.len(), || false, work)?.into_iter().flatten();
    let mut pairs = Vec::with_capacity(seeds.len());
    while let (Some(first), Some(second)) = (results.next(), results.next()) {
        pairs.push([first, second]);
    }
    Ok(pairs)
}

fn one(side: &MethodSide, seed: u64, control: &Control) -> Result<SideResult, PairedError> {
    if control.cancel.load(Ordering::Relaxed) {
        return Err(PairedError::Cancelled);
    }
    let run = run_method(&side.scenario, side.method, seed, StreamKeeping::None, control)?;
    control.epochs.store(side.scenario.samples().unwrap_or_default(), Ordering::Relaxed);
    if run.ended == Ended::Cancelled {
        return Err(PairedError::Cancelled);
    }
    let g = ParameterGroup::GDependent.range().map(|i| NAMES[i]);
    let normalized = |calibration: &CalibrationScore| {
        g.map(|name| calibration.parameters.get(name)?.normalized).collect::<Option<Vec<f64>>>()
    };
    let g_normalized = run.calibration.as_ref().and_then(normalized).unwrap_or_default();
    match (&run.navigation, run.calibration.and_then(|c| c.refused)) {
        // A refused calibration is a result: it has no errors, and counts as refused.
        (_, Some(reason)) => {
            Ok(SideResult { maxima: Maxima::default(), refused: Some(reason), g_normalized })
        }
        (Some(navigation), None) => {
            Ok(SideResult { maxima: Maxima::of(navigation), refused: None, g_normalized })
        }
        (None, None) => Err(PairedError::NoNavigation),
    }
}
