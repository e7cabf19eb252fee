//! Figures of one sample: mean, deviation and percentiles, and how uncertain they are.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// Root mean square; `None` without values.
#[must_use]
pub fn rms(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().map(|v| v * v).sum();
    (!values.is_empty()).then(|| libm::sqrt(sum / values.len() as f64))
}

/// Mean; `None` without values.
#[must_use]
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Standard deviation about the mean, with n − 1; `None` for fewer than two values.
#[must_use]
pub fn deviation(values: &[f64]) -> Option<f64> {
    if values.len() < 2 {
        return None;
    }
    let mean = mean(values)?;
    let sum: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    Some(libm::sqrt(sum / (values.len() - 1) as f64))
}

/// Percentile `p` (0 to 1), interpolated between order statistics; `None` without values or with a NaN.
/// Definition 7 of Hyndman and Fan (The American Statistician 50, 1996), as in numpy, R and
/// spreadsheets. Values may be infinite, for example for a refused run: between a number and infinity
/// the result is infinite.
#[must_use]
pub fn percentile(values: &[f64], p: f64) -> Option<f64> {
    if values.iter().any(|v| v.is_nan()) {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    of_sorted(&sorted, p)
}

/// Percentile as in [`percentile`], of values in ascending order.
pub(crate) fn of_sorted(sorted: &[f64], p: f64) -> Option<f64> {
    percentile_of_ranks(sorted.len(), p, |rank| sorted[rank])
}

/// Percentile as in [`percentile`], of `count` values that are known by their ranks from 0, in ascending order.
#[must_use]
pub fn percentile_of_ranks(count: usize, p: f64, value: impl Fn(usize) -> f64) -> Option<f64> {
    let last = count.checked_sub(1)?;
    let at = p.clamp(0.0, 1.0) * last as f64;
    let (low, part) = (at as usize, at - libm::floor(at));
    let (below, above) = (value(low), value((low + 1).min(last)));
    // The difference of two infinities is NaN, and so is every multiple of it.
    Some(if part == 0.0 || below == above { below } else { below + part * (above - below) })
}

/// An estimate with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConfidenceInterval {
    /// Estimate.
    pub value: f64,
    /// Lower end; minus infinity if the sample gives none.
    pub low: f64,
    /// Upper end; infinity if the sample gives none.
    pub high: f64,
}

/// Ranks from 1; ties have the mean of their ranks.
#[must_use]
pub fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let mut from = 0;
    while from < order.len() {
        let mut to = from;
        while to + 1 < order.len() && values[order[to + 1]] == values[order[from]] {
            to += 1;
        }
        let rank = (from + to) as f64 / 2.0 + 1.0;
        for &index in &order[from..=to] {
            ranks[index] = rank;
        }
        from = to + 1;
    }
    ranks
}

/// Standard deviation about the mean with its two-sided interval, for normal values: s √((n − 1) / χ²).
/// `None` for fewer than two values, or for an invalid confidence.
#[must_use]
pub fn deviation_interval(values: &[f64], confidence: f64) -> Option<ConfidenceInterval> {
    let value = deviation(values)?;
    let (low, high) = deviation_factors(values.len() as u64 - 1, confidence)?;
    Some(ConfidenceInterval { value, low: value * low, high: value * high })
}

/// Factors from the standard deviation of a sample to the ends of its interval.
#[must_use]
pub fn deviation_factors(degrees_of_freedom: u64, confidence: f64) -> Option<(f64, f64)> {
    if degrees_of_freedom == 0 || !(confidence > 0.0 && confidence < 1.0) {
        return None;
    }
    let n = degrees_of_freedom as f64;
    let squares = ChiSquared::new(n).ok()?;
    let left = 0.5 * (1.0 - confidence);
    let factor = |p: f64| libm::sqrt(n / squares.inverse_cdf(p));
    Some((factor(1.0 - left), factor(left)))
}

/// Factor of a two-sided interval by Student's distribution; `None` without a degree of freedom.
#[must_use]
pub fn student(degrees: usize, confidence: f64) -> Option<f64> {
    if !(confidence > 0.0 && confidence < 1.0) {
        return None;
    }
    let t = StudentsT::new(0.0, 1.0, degrees as f64).ok()?;
    Some(t.inverse_cdf(0.5 * (1.0 + confidence)))
}
