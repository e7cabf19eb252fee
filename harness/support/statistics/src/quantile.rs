//! Distribution-free bounds of a quantile from order statistics.
//!
//! The number of n independent values below the p-quantile has a binomial distribution, so that order
//! statistics bound the quantile (David and Nagaraja, Order Statistics, 3rd edition, section 7.1;
//! Wilks, 1942, for the number of values that a bound needs).

use crate::sample::{ConfidenceInterval, percentile};
use statrs::distribution::{Beta, ContinuousCDF};

/// P(at most `k` of `n` are below the `p`-quantile), for a continuous distribution.
fn at_most(k: u64, n: u64, p: f64) -> f64 {
    if k >= n {
        return 1.0;
    }
    // The binomial sum equals the regularised incomplete beta function.
    Beta::new((n - k) as f64, (k + 1) as f64).map_or(f64::NAN, |beta| beta.cdf(1.0 - p))
}

/// Upper bound of the `p`-quantile with one-sided `confidence`: the smallest order statistic that is
/// above it with that probability. `None` if there are too few values.
#[must_use]
pub fn upper_bound(values: &[f64], p: f64, confidence: f64) -> Option<f64> {
    let rank = upper_rank(values.len() as u64, p, confidence)?;
    let mut sorted = sorted(values)?;
    Some(sorted.swap_remove(rank as usize - 1))
}

/// Lower bound of the `p`-quantile, one-sided like [`upper_bound`].
#[must_use]
pub fn lower_bound(values: &[f64], p: f64, confidence: f64) -> Option<f64> {
    let n = values.len() as u64;
    // Counted from the other end it is an upper bound.
    let rank = n + 1 - upper_rank(n, 1.0 - p, confidence)?;
    let mut sorted = sorted(values)?;
    Some(sorted.swap_remove(rank as usize - 1))
}

fn sorted(values: &[f64]) -> Option<Vec<f64>> {
    if values.iter().any(|v| v.is_nan()) {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    Some(sorted)
}

/// Smallest rank r, from 1, with P(the r-th of n is above the quantile) at least `confidence`.
#[must_use]
pub fn upper_rank(n: u64, p: f64, confidence: f64) -> Option<u64> {
    let inside = |x: f64| x > 0.0 && x < 1.0;
    // X(r) is above the quantile if at most r − 1 values are below it.
    if n == 0 || !inside(p) || !inside(confidence) || at_most(n - 1, n, p) < confidence {
        return None;
    }
    let (mut low, mut high) = (1, n);
    while low < high {
        let middle = low + (high - low) / 2;
        if at_most(middle - 1, n, p) >= confidence {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    Some(high)
}

/// Number of values that an upper bound of the `p`-quantile needs: ln(1 − confidence) / ln p, 59 for 95
/// % with 95 % (Wilks, Annals of Mathematical Statistics 13, 1942).
#[must_use]
pub fn values_needed(p: f64, confidence: f64) -> Option<u64> {
    let inside = |x: f64| x > 0.0 && x < 1.0;
    if !inside(p) || !inside(confidence) {
        return None;
    }
    let n = libm::ceil(libm::log1p(-confidence) / libm::log(p));
    (n < 1e15).then_some(n.max(1.0) as u64)
}

/// The `p`-quantile with its two-sided interval: each end has half of the remaining probability. An end
/// for which there are too few values is infinite.
#[must_use]
pub fn interval(values: &[f64], p: f64, confidence: f64) -> Option<ConfidenceInterval> {
    let each = 0.5 * (1.0 + confidence);
    Some(ConfidenceInterval {
        value: percentile(values, p)?,
        low: lower_bound(values, p, each).unwrap_or(f64::NEG_INFINITY),
        high: upper_bound(values, p, each).unwrap_or(f64::INFINITY),
    })
}
