//! Outliers among runs.

use serde::{Deserialize, Serialize};

/// An outlier.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outlier {
    /// Index of the value, from 0.
    pub index: usize,
    /// Modified z-score with its sign; infinite for a value that isn't finite, or if more than half of
    /// the values are equal.
    pub score: f64,
}

/// Scale on which values are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OutlierScale {
    /// Linear, for errors of either sign.
    Linear,
    /// Logarithmic, for magnitudes, which are skewed. A value of zero or less has an infinite score.
    Logarithm,
}

/// Limit that Iglewicz and Hoaglin recommend for the modified z-score.
pub const LIMIT: f64 = 3.5;

/// 75th percentile of the standard normal distribution: the MAD of a Gaussian is 0.6745 σ.
const MAD_OF_SIGMA: f64 = 0.674_489_750_196_081_7;

/// Values whose modified z-score 0.6745 (x − median) / MAD exceeds `limit` in magnitude, the farthest
/// first (Iglewicz and Hoaglin, How to Detect and Handle Outliers, ASQC 1993). A value that isn't
/// finite is always an outlier, and isn't used for the median.
#[must_use]
pub fn outliers(values: &[f64], scale: OutlierScale, limit: f64) -> Vec<Outlier> {
    let scaled: Vec<f64> = values
        .iter()
        .map(|v| match scale {
            OutlierScale::Linear => *v,
            OutlierScale::Logarithm if *v > 0.0 => libm::log(*v),
            OutlierScale::Logarithm => f64::NEG_INFINITY,
        })
        .collect();
    let finite: Vec<f64> = scaled.iter().copied().filter(|v| v.is_finite()).collect();
    let median = |values: &[f64]| crate::sample::percentile(values, 0.5);
    let middle = median(&finite).unwrap_or(0.0);
    let distances: Vec<f64> = finite.iter().map(|v| (v - middle).abs()).collect();
    let mad = median(&distances).unwrap_or(0.0);
    let score = |v: f64| {
        if v.is_nan() {
            f64::INFINITY
        } else if v == middle {
            0.0
        } else {
            MAD_OF_SIGMA * (v - middle) / mad
        }
    };
    let mut found: Vec<Outlier> = scaled
        .iter()
        .enumerate()
        .map(|(index, v)| Outlier { index, score: score(*v) })
        .filter(|outlier| outlier.score.abs() > limit)
        .collect();
    found.sort_by(|a, b| b.score.abs().total_cmp(&a.score.abs()).then(a.index.cmp(&b.index)));
    found
}
