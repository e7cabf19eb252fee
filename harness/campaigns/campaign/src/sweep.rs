//! Sweeps a grid of one fault, to find the variants that are undetected and yet harmful.

use octant_base::control::Control;
use octant_base::failing::{Failing, FailureKind};
use octant_base::pool::processors;
use octant_run::Ended;
use octant_run::Plan;
use octant_run::branches::run_branches;
use octant_run::difference::between;
use octant_run::{MethodError, MethodRun, StreamKeeping, run_method};
use octant_scenario::{Method, Scenario};
use octant_score::counterfactual::HARMFUL_SHIFT_SIGMA;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

/// Version of `sweep.json`.
pub const SCHEMA: u32 = 1;

/// One axis of the grid: a key of the fault, and its values as text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SweepAxis {
    /// The key, such as `amplitude` or `trigger.position`.
    pub key: String,
    /// Values.
    pub values: Vec<String>,
}

/// Result of one cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SweepCell {
    /// Index of the value on each axis.
    pub at: Vec<usize>,
    /// True if the fault altered something.
    pub fired: bool,
    /// Parameter that moved most.
    pub worst_parameter: Option<String>,
    /// Shift of that parameter, in posterior σ of the twin.
    pub worst_shift_sigma: Option<f64>,
    /// Largest distance from the twin's navigation, nmi; null without navigation.
    pub radial_max_nmi: Option<f64>,
    /// First detection by the core; null if there was none.
    pub noticed_by: Option<String>,
    /// Time from the onset to the detection, s.
    pub delay_s: Option<f64>,
    /// Reason why the calibration was refused; null if it was published.
    pub refused: Option<String>,
    /// True if the fault did harm and was not detected.
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
    /// Kind.
    pub kind: String,
    /// Parameter shift, in σ, from which a cell counts as harmful.
    pub harmful_shift_sigma: f64,
    /// Axes; the last one runs fastest.
    pub axes: Vec<SweepAxis>,
    /// Every cell.
    pub cells: Vec<SweepCell>,
}

/// Reasons why a sweep gave no result.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// A run gave no result.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// The twin refused its own calibration, so there is no reference.
    #[error("sweep: the run without the fault is refused itself: {0}")]
    TwinRefused(String),
    /// Interrupted on request.
    #[error("sweep: interrupted")]
    Cancelled,
}

impl Failing for SweepError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Method(error) => error.kind(),
            Self::TwinRefused(_) => FailureKind::Fail,
            Self::Cancelled => FailureKind::Inconclusive,
        }
    }
}

/// Number of cells of a grid.
#[must_use]
pub fn cells_of(axes: &[SweepAxis]) -> usize {
    axes.iter().map(|axis| axis.values.len()).product()
}

/// Returns the indices of a cell on each axis; the last runs fastest.
#[must_use]
pub fn indices(axes: &[SweepAxis], mut cell: usize) -> Vec<usize> {
    let mut at = vec![0; axes.len()];
    for (slot, axis) in at.iter_mut().zip(axes).rev() {
        *slot = cell % axis.values.len();
        cell /= axis.values.len();
    }
    at
}

/// Runs the scenario of every cell, and their common twin, on all processors. What the cells have in common
/// at their beginning runs once. The order of the runs has no effect on the result. `jobs` run at a time, by default as many as there are processors.
/// `controls` has one entry for the twin and one for each cell.
///
/// # Errors
/// If a run gives no result.
pub fn sweep(
    scenarios: &[Scenario],
    axes: &[SweepAxis],
    fault: &str,
    seed: u64,
    jobs: Option<usize>,
    controls: &[Control],
) -> Result<Sweep, SweepError> {
    let Some(first) = scenarios.first() else { return Err(SweepError::Cancelled) };
    let clean = first.without_faults();
    // The twin comes first: a cell is compared with it as soon as it has run, and only the result
    // is kept.
    let control = controls.first().ok_or(SweepError::Cancelled)?;
    let twin = run_method(&clean, Method::Primary, seed, StreamKeeping::Hash, control)?;
    let twin = uncancelled(twin)?;
    if let Some(reason) = twin.calibration.as_ref().and_then(|c| c.refused.as_ref()) {
        return Err(SweepError::TwinRefused(reason.clone()));
    }
    let plans: Vec<Plan<'_>> = (scenarios.iter().zip(controls.iter().skip(1)))
        .map(|(scenario, control)| {
            Plan::of(scenario, Method::Primary, seed, StreamKeeping::None, control)
        })
        .collect();
    let cells: Mutex<BTreeMap<usize, Result<SweepCell, SweepError>>> = Mutex::default();
    run_branches(&plans, jobs.unwrap_or_else(processors), &|index, run| {
        let ended = run.map_err(SweepError::from).and_then(uncancelled);
        let cell =
            ended.map(|run| cell(&scenarios[index], &run, &twin, fault, indices(axes, index)));
        cells.lock().unwrap_or_else(PoisonError::into_inner).insert(index, cell);
    });
    let cells = cells.into_inner().unwrap_or_else(PoisonError::into_inner);
    let cells = cells.into_values().collect::<Result<Vec<_>, _>>()?;
    if cells.len() != scenarios.len() {
        return Err(SweepError::Cancelled);
    }
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

fn uncancelled(run: MethodRun) -> Result<MethodRun, SweepError> {
    if run.ended == Ended::Cancelled { Err(SweepError::Cancelled) } else { Ok(run) }
}

fn cell(
    scenario: &Scenario,
    run: &MethodRun,
    twin: &MethodRun,
    fault: &str,
    at: Vec<usize>,
) -> SweepCell {
    let difference = between(scenario, run, twin);
    let noticed = difference.as_ref().and_then(|d| d.faults.iter().find(|f| f.id == fault));
    SweepCell {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_axis_runs_fastest() {
        let axis = |key: &str, n: usize| SweepAxis {
            key: key.to_owned(),
            values: (0..n).map(|i| i.to_string()).collect(),
        };
        let axes = [axis("a", 2), axis("b", 3), axis("c", 2)];
        assert_eq!(cells_of(&axes), 12);
        let all: Vec<_> = (0..12).map(|i| indices(&axes, i)).collect();
        assert_eq!((&all[0], &all[1], &all[2]), (&vec![0, 0, 0], &vec![0, 0, 1], &vec![0, 1, 0]));
        assert_eq!(all[11], [1, 2, 1]);
    }
}
