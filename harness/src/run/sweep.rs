//! A grid of one fault: which of its forms are invisible and yet harmful.

use super::drive::{Control, Ended};
use super::method::{MethodError, MethodRun, Recording, run_method};
use super::twin::between;
use octant_scenario::{Method, Scenario};
use octant_score::counterfactual::HARMFUL_SHIFT_SIGMA;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Version of `sweep.json`.
pub const SCHEMA: u32 = 1;

/// One axis of the grid: a key of the fault and its values as they are written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Axis {
    /// The key, such as `amplitude` or `trigger.position`.
    pub key: String,
    /// Its values.
    pub values: Vec<String>,
}

/// What came of one cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cell {
    /// Index of the value on each axis.
    pub at: Vec<usize>,
    /// The fault altered something.
    pub fired: bool,
    /// Parameter that moved most.
    pub worst_parameter: Option<String>,
    /// How far, in posterior σ of the twin.
    pub worst_shift_sigma: Option<f64>,
    /// Largest distance from the twin's navigation, nmi; null without navigation.
    pub radial_max_nmi: Option<f64>,
    /// How the core noticed first; null: not at all.
    pub noticed_by: Option<String>,
    /// Seconds after the onset.
    pub delay_s: Option<f64>,
    /// Why the calibration was refused; null: it was published.
    pub refused: Option<String>,
    /// It did harm, and nobody noticed.
    pub missed: bool,
}

/// A sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sweep {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Version of the program.
    pub octant: String,
    /// Name of the scenario.
    pub scenario: String,
    /// Seed of all cells.
    pub seed: u64,
    /// Id of the fault.
    pub fault: String,
    /// Its kind.
    pub kind: String,
    /// Parameter shift, in σ, from which a cell counts as harmful.
    pub harmful_shift_sigma: f64,
    /// The axes; the last one runs fastest.
    pub axes: Vec<Axis>,
    /// Every cell.
    pub cells: Vec<Cell>,
}

/// Why a sweep gave no result.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A run gave no result.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The twin refused its own calibration: nothing can be held against it.
    #[error("sweep: the run without the fault is refused itself: {0}")]
    TwinRefused(String),
    /// Somebody asked for it.
    #[error("sweep: interrupted")]
    Cancelled,
}

/// Number of cells of a grid.
#[must_use]
pub fn cells_of(axes: &[Axis]) -> usize {
    axes.iter().map(|axis| axis.values.len()).product()
}

/// Indices of a cell on each axis; the last runs fastest.
#[must_use]
pub fn indices(axes: &[Axis], mut cell: usize) -> Vec<usize> {
    let mut at = vec![0; axes.len()];
    for (slot, axis) in at.iter_mut().zip(axes).rev() {
        *slot = cell % axis.values.len();
        cell /= axis.values.len();
    }
    at
}

/// Runs the scenario of every cell, and their common twin, on all processors. The order in which
/// they run doesn't show in the result. `jobs` run at a time, by default as many as there are
/// processors. `controls` has one entry for the twin and one for each cell.
///
/// # Errors
/// If a run gives no result.
pub fn sweep(
    scenarios: &[Scenario],
    axes: &[Axis],
    fault: &str,
    seed: u64,
    jobs: Option<usize>,
    controls: &[Control],
) -> Result<Sweep, SweepError> {
    let Some(first) = scenarios.first() else { return Err(SweepError::Cancelled) };
    let clean = first.without_faults();
    let run = |scenario: &Scenario, recording: Recording<'_>, task: usize| {
        let control = controls.get(task).ok_or(SweepError::Cancelled)?;
        let run = run_method(scenario, Method::Primary, seed, recording, control)?;
        if run.ended == Ended::Cancelled { Err(SweepError::Cancelled) } else { Ok(run) }
    };
    // The twin first: a cell is held against it as soon as it has run, and only the result is kept.
    let twin = run(&clean, Recording::Hash, 0)?;
    if let Some(reason) = twin.calibration.as_ref().and_then(|c| c.refused.as_ref()) {
        return Err(SweepError::TwinRefused(reason.clone()));
    }
    let cells = on_processors(jobs, scenarios.len(), |i| {
        let scenario = scenarios.get(i).ok_or(SweepError::Cancelled)?;
        let faulted = run(scenario, Recording::None, i + 1)?;
        Ok::<_, SweepError>(cell(scenario, &faulted, &twin, fault, indices(axes, i)))
    })?;
    let kind = first.faults.iter().find(|f| f.spec.id == fault).map_or("", |f| f.spec.kind.name);
    Ok(Sweep {
        schema: SCHEMA,
        octant: env!("CARGO_PKG_VERSION").to_owned(),
        scenario: first.title.clone(),
        seed,
        fault: fault.to_owned(),
        kind: kind.to_owned(),
        harmful_shift_sigma: HARMFUL_SHIFT_SIGMA,
        axes: axes.to_vec(),
        cells,
    })
}

fn cell(
    scenario: &Scenario,
    run: &MethodRun,
    twin: &MethodRun,
    fault: &str,
    at: Vec<usize>,
) -> Cell {
    let difference = between(scenario, run, twin);
    let noticed = difference.as_ref().and_then(|d| d.faults.iter().find(|f| f.id == fault));
    Cell {
        at,
        fired: run.receipts.iter().any(|r| r.id == fault && r.fired()),
        worst_parameter: difference.as_ref().and_then(|d| d.worst_parameter.clone()),
        worst_shift_sigma: difference.as_ref().and_then(|d| d.worst_shift_sigma),
        radial_max_nmi: difference
            .as_ref()
            .and_then(|d| d.navigation.as_ref().map(|n| n.radial_max_nmi)),
        noticed_by: noticed.and_then(|n| n.noticed_by.clone()),
        delay_s: noticed.and_then(|n| n.delay_s),
        refused: run.calibration.as_ref().and_then(|c| c.refused.clone()),
        missed: difference.as_ref().is_some_and(|d| d.missed),
    }
}

/// Does tasks 0 to `count`, so many at a time; results in order. After a failure no more are begun,
/// and the first in order is told.
fn on_processors<T: Send, E: Send>(
    jobs: Option<usize>,
    count: usize,
    work: impl Fn(usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let processors = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = jobs.unwrap_or_else(processors).clamp(1, count.max(1));
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<Result<T, E>>>> = Mutex::new((0..count).map(|_| None).collect());
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let task = next.fetch_add(1, Ordering::Relaxed);
                    if task >= count {
                        break;
                    }
                    let result = work(task);
                    if result.is_err() {
                        next.fetch_max(count, Ordering::Relaxed);
                    }
                    results.lock().unwrap_or_else(PoisonError::into_inner)[task] = Some(result);
                }
            });
        }
    });
    // A task that was never begun comes after the failure that kept it from it.
    results.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_axis_runs_fastest() {
        let axis = |key: &str, n: usize| Axis {
            key: key.to_owned(),
            values: (0..n).map(|i| i.to_string()).collect(),
        };
        let axes = [axis("a", 2), axis("b", 3), axis("c", 2)];
        assert_eq!(cells_of(&axes), 12);
        let all: Vec<_> = (0..12).map(|i| indices(&axes, i)).collect();
        assert_eq!((&all[0], &all[1], &all[2]), (&vec![0, 0, 0], &vec![0, 0, 1], &vec![0, 1, 0]));
        assert_eq!(all[11], [1, 2, 1]);
    }

    #[test]
    fn results_are_in_order_and_the_first_failure_is_told() {
        let doubled = on_processors(Some(3), 50, |i| Ok::<_, usize>(2 * i)).unwrap();
        assert!(doubled.iter().enumerate().all(|(i, d)| *d == 2 * i));
        let failed = on_processors(Some(3), 50, |i| if i % 7 == 3 { Err(i) } else { Ok(i) });
        assert_eq!(failed, Err(3));
    }
}
