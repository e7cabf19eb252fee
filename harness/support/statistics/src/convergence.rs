//! Convergence of an estimate with the number of runs.

use crate::sample::ConfidenceInterval;
use serde::{Deserialize, Serialize};

/// Estimate from the first `runs` runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConvergenceStep {
    /// Number of runs.
    pub runs: u64,
    /// Estimate with its bounds.
    pub estimate: ConfidenceInterval,
}

/// Numbers of runs at which to estimate: 1, 2, 5, 10, 20, 50 … and all.
#[must_use]
pub fn steps(runs: usize) -> Vec<usize> {
    let mut steps = Vec::new();
    let mut decade = 1usize;
    'all: loop {
        for factor in [1, 2, 5] {
            let step = decade.saturating_mul(factor);
            if step >= runs {
                break 'all;
            }
            steps.push(step);
        }
        decade = decade.saturating_mul(10);
    }
    if runs > 0 {
        steps.push(runs);
    }
    steps
}

/// Running estimate from the first runs, for each of [`steps`]. Steps for which `estimate` returns
/// `None` are omitted.
///
/// Any estimate of a sample can be used: [`crate::quantile::interval`] of a percentile, [`mean`], or
/// [`pass`] of a pass probability.
#[must_use]
pub fn convergence<T>(
    values: &[T],
    mut estimate: impl FnMut(&[T]) -> Option<ConfidenceInterval>,
) -> Vec<ConvergenceStep> {
    steps(values.len())
        .into_iter()
        .filter_map(|n| Some(ConvergenceStep { runs: n as u64, estimate: estimate(&values[..n])? }))
        .collect()
}

/// Mean with its two-sided interval by Student's distribution; `None` for fewer than two values.
#[must_use]
pub fn mean(values: &[f64], confidence: f64) -> Option<ConfidenceInterval> {
    let (value, deviation) = (crate::sample::mean(values)?, crate::sample::deviation(values)?);
    let half = super::sample::student(values.len() - 1, confidence)? * deviation
        / libm::sqrt(values.len() as f64);
    Some(ConfidenceInterval { value, low: value - half, high: value + half })
}

/// Pass probability with its two-sided interval of Clopper and Pearson; `None` for no runs.
#[must_use]
pub fn pass(passed: &[bool], confidence: f64) -> Option<ConfidenceInterval> {
    let runs = passed.len() as u64;
    let failures = passed.iter().filter(|passed| !**passed).count() as u64;
    let each = 0.5 * (1.0 + confidence);
    (runs > 0).then(|| ConfidenceInterval {
        value: (runs - failures) as f64 / runs as f64,
        low: crate::proportion::success_lower_bound(failures, runs, each),
        high: crate::proportion::success_upper_bound(failures, runs, each),
    })
}
