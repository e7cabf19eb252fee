//! How an estimate settles with the number of runs.

use crate::sample::Interval;
use serde::{Deserialize, Serialize};

/// The estimate of the first `runs` runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Runs that it is of.
    pub runs: u64,
    /// The estimate and its bounds.
    pub estimate: Interval,
}

/// Numbers of runs at which to look: 1, 2, 5, 10, 20, 50 … and all.
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

/// The running estimate: that of the first runs, for each of [`steps`]. A step for which `estimate`
/// gives nothing is left out.
///
/// Any estimate of a sample can be looked at: [`crate::quantile::interval`] of a percentile,
/// [`mean`], or [`pass`] of a pass probability.
#[must_use]
pub fn convergence<T>(
    values: &[T],
    mut estimate: impl FnMut(&[T]) -> Option<Interval>,
) -> Vec<Step> {
    steps(values.len())
        .into_iter()
        .filter_map(|n| Some(Step { runs: n as u64, estimate: estimate(&values[..n])? }))
        .collect()
}

/// The mean with its two-sided interval by Student's distribution; `None` of fewer than two.
#[must_use]
pub fn mean(values: &[f64], confidence: f64) -> Option<Interval> {
    let (value, deviation) = (crate::sample::mean(values)?, crate::sample::deviation(values)?);
    let half = crate::paired::student(values.len() - 1, confidence)? * deviation
        / libm::sqrt(values.len() as f64);
    Some(Interval { value, low: value - half, high: value + half })
}

/// The pass probability with its two-sided interval of Clopper and Pearson; `None` of nothing.
#[must_use]
pub fn pass(passed: &[bool], confidence: f64) -> Option<Interval> {
    let runs = passed.len() as u64;
    let failures = passed.iter().filter(|passed| !**passed).count() as u64;
    let each = 0.5 * (1.0 + confidence);
    (runs > 0).then(|| Interval {
        value: (runs - failures) as f64 / runs as f64,
        low: crate::proportion::success_lower_bound(failures, runs, each),
        high: crate::proportion::success_upper_bound(failures, runs, each),
    })
}
