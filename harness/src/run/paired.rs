//! Two methods over many seeds, on the same instruments with the same noise.

use super::drive::{Control, Ended};
use super::method::{MethodError, Recording, label, run_method};
use octant_scenario::{Method, Scenario};
use octant_score::compare::{Comparison, Maxima, PairedRun, compare};
use octant_score::floor::Floor;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Members of the ensemble that the floor of the random walk is taken from.
const FLOOR_MEMBERS: u32 = 400;
/// Hours of the marks that methods are compared at.
const MARKS_H: [f64; 2] = [24.0, 72.0];

/// A method of a scenario.
#[derive(Clone, Debug)]
pub struct Side {
    /// The scenario.
    pub scenario: Scenario,
    /// Which of its methods.
    pub method: Method,
}

/// Why two methods could not be compared.
#[derive(Debug, thiserror::Error)]
pub enum PairedError {
    /// A run gave no result.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// Nothing is navigated, or not long enough.
    #[error("compare: both methods need a navigation of at least 24 h ([procedure.navigation])")]
    NoNavigation,
    /// Samples that are not simulated know nothing of seeds.
    #[error("compare: seeds need source.uri = \"plant\", or a ship under it")]
    NotSimulated,
    /// Somebody asked for it.
    #[error("compare: interrupted")]
    Cancelled,
}

/// Runs every seed with both sides on all processors, and compares. The order in which they are
/// run doesn't show in the result.
///
/// `controls` has one entry for each run: two a seed.
///
/// # Errors
/// If a run gives no result.
pub fn paired(
    first: &Side,
    second: &Side,
    seeds: &[u64],
    controls: &[Control],
) -> Result<Comparison, PairedError> {
    let scenario = &second.scenario;
    if [first, second].iter().any(|s| !s.scenario.source.has_plant()) {
        return Err(PairedError::NotSimulated);
    }
    // Said before hours of simulation, not after.
    if [first, second].iter().any(|side| navigated_h(&side.scenario) < MARKS_H[0]) {
        return Err(PairedError::NoNavigation);
    }
    let results = ensemble([first, second], seeds, controls)?;
    let runs: Vec<PairedRun> = seeds
        .iter()
        .zip(results.chunks_exact(2))
        .map(|(seed, pair)| PairedRun {
            seed: *seed,
            first: pair[0].maxima,
            second: pair[1].maxima,
            first_refused: pair[0].refused.clone(),
            second_refused: pair[1].refused.clone(),
        })
        .collect();
    let floor = Floor::new(
        scenario.site.latitude_rad,
        scenario.site.height_m,
        scenario.imu.angle_random_walk,
        scenario.imu.velocity_random_walk,
    )
    .maxima(&MARKS_H, FLOOR_MEMBERS, scenario.seed);
    let [a, b] = [first, second].map(|side| label(&side.scenario, side.method));
    let (a, b) = if a == b { (format!("{a} (first)"), format!("{b} (second)")) } else { (a, b) };
    let comparison = compare(&scenario.title, &a, &b, &runs, &floor);
    // What all seeds refused is a result too.
    if comparison.cells.is_empty() && comparison.refusals.is_none() {
        return Err(PairedError::NoNavigation);
    }
    Ok(comparison)
}

/// Length of the navigation, h; 0 without one.
fn navigated_h(scenario: &Scenario) -> f64 {
    let Some(plan) = &scenario.navigation else { return 0.0 };
    plan.duration_s.map_or(f64::INFINITY, |duration_s| duration_s / 3600.0)
}

fn ensemble(
    sides: [&Side; 2],
    seeds: &[u64],
    controls: &[Control],
) -> Result<Vec<One>, PairedError> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<Result<One, PairedError>>>> =
        Mutex::new((0..2 * seeds.len()).map(|_| None).collect());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let task = next.fetch_add(1, Ordering::Relaxed);
                    let (Some(seed), Some(control)) = (seeds.get(task / 2), controls.get(task))
                    else {
                        break;
                    };
                    let result = one(sides[task % 2], *seed, control);
                    let failed = result.is_err();
                    results.lock().unwrap_or_else(PoisonError::into_inner)[task] = Some(result);
                    if failed {
                        // Nothing comes of the rest: no need to wait for it.
                        next.fetch_max(2 * seeds.len(), Ordering::Relaxed);
                    }
                }
            });
        }
    });
    let results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    // The first failure in order of seeds is the one that is told.
    let mut maxima = Vec::with_capacity(results.len());
    let mut skipped = false;
    for result in results {
        match result {
            Some(result) => maxima.push(result?),
            None => skipped = true,
        }
    }
    if skipped { Err(PairedError::Cancelled) } else { Ok(maxima) }
}

/// What one method came to with one seed.
#[derive(Clone, Debug)]
struct One {
    maxima: Maxima,
    refused: Option<String>,
}

fn one(side: &Side, seed: u64, control: &Control) -> Result<One, PairedError> {
    if control.cancel.load(Ordering::Relaxed) {
        return Err(PairedError::Cancelled);
    }
    let run = run_method(&side.scenario, side.method, seed, Recording::None, control)?;
    control.epochs.store(side.scenario.samples().unwrap_or_default(), Ordering::Relaxed);
    if run.ended == Ended::Cancelled {
        return Err(PairedError::Cancelled);
    }
    match (&run.navigation, run.calibration.and_then(|c| c.refused)) {
        // One that was refused is a result: it has no errors, and counts as refused.
        (_, Some(reason)) => Ok(One { maxima: Maxima::default(), refused: Some(reason) }),
        (Some(navigation), None) => Ok(One { maxima: Maxima::of(navigation), refused: None }),
        (None, None) => Err(PairedError::NoNavigation),
    }
}
