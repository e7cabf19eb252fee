//! Uncertainty of a normal sample's standard deviation, and of its mean.

use crate::sample::{ConfidenceInterval, deviation};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// Standard deviation about the mean with its two-sided interval, for normal values: s √((n − 1) / χ²).
/// `None` for fewer than two values, or for an invalid confidence.
#[must_use]
pub fn interval(values: &[f64], confidence: f64) -> Option<ConfidenceInterval> {
    let value = deviation(values)?;
    let (low, high) = factors(values.len() as u64 - 1, confidence)?;
    Some(ConfidenceInterval { value, low: value * low, high: value * high })
}

/// Factors from the standard deviation of a sample to the ends of its interval.
#[must_use]
pub fn factors(degrees_of_freedom: u64, confidence: f64) -> Option<(f64, f64)> {
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
