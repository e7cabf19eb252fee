//! Statistics over many runs: position percentiles, confidence bounds, paired improvement.

use rand_philox::Philox;
use serde::{Deserialize, Serialize};
use statrs::distribution::{Beta, ContinuousCDF};

/// Resamples of a bootstrap.
pub const RESAMPLES: u32 = 4000;

/// √ of the mean of squares; `None` of nothing.
#[must_use]
pub fn rms(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().map(|v| v * v).sum();
    (!values.is_empty()).then(|| libm::sqrt(sum / values.len() as f64))
}

/// Percentile `p` (0 to 1), interpolated between order statistics; `None` of nothing or of a value
/// that isn't a number.
#[must_use]
pub fn percentile(values: &[f64], p: f64) -> Option<f64> {
    if values.is_empty() || values.iter().any(|v| v.is_nan()) {
        return None;
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = p.clamp(0.0, 1.0) * (sorted.len() - 1) as f64;
    let (low, part) = (at as usize, at - libm::floor(at));
    let high = (low + 1).min(sorted.len() - 1);
    Some(sorted[low] + part * (sorted[high] - sorted[low]))
}

/// Circular error probable of a Gaussian error, 0.5887 (σ_lat + σ_lon): within 3 % while one σ is
/// at most twice the other.
#[must_use]
pub fn cep50(sigma_latitude: f64, sigma_longitude: f64) -> f64 {
    0.5887 * (sigma_latitude + sigma_longitude)
}

/// Where an ensemble of positions lies, in the unit of its errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PositionStatistics {
    /// 0.5887 (σ_lat + σ_lon), σ about zero: a common offset counts as an error.
    pub cep50_gaussian: f64,
    /// Median of the radial errors.
    pub cep50_empirical: f64,
    /// 95th percentile of the radial errors.
    pub r95: f64,
    /// √ of the mean of the squared radial errors.
    pub drms: f64,
}

/// Statistics of north and east errors of an ensemble at one time; `None` of nothing.
#[must_use]
pub fn position_statistics(north_east: &[[f64; 2]]) -> Option<PositionStatistics> {
    let column = |i: usize| north_east.iter().map(|e| e[i]).collect::<Vec<_>>();
    let radial: Vec<f64> =
        north_east.iter().map(|e| libm::sqrt(e[0] * e[0] + e[1] * e[1])).collect();
    Some(PositionStatistics {
        cep50_gaussian: cep50(rms(&column(0))?, rms(&column(1))?),
        cep50_empirical: percentile(&radial, 0.5)?,
        r95: percentile(&radial, 0.95)?,
        drms: rms(&radial)?,
    })
}

/// 50th and 95th percentile of radial error rates (regression through the origin), nmi/h. The first
/// is what a class is named by: 0.8 nmi/h CEP.
#[must_use]
pub fn radial_rates(rates_nmi_per_h: &[f64]) -> Option<[f64; 2]> {
    Some([percentile(rates_nmi_per_h, 0.5)?, percentile(rates_nmi_per_h, 0.95)?])
}

/// Lower bound of the probability of success after `failures` in `runs`, with one-sided
/// `confidence` (Clopper and Pearson, 1934). Zero failures in 59 runs show 95 % at 95 %.
#[must_use]
pub fn success_lower_bound(failures: u64, runs: u64, confidence: f64) -> f64 {
    let successes = runs.saturating_sub(failures);
    if successes == 0 {
        return 0.0;
    }
    let (a, b) = (successes as f64, (runs - successes + 1) as f64);
    Beta::new(a, b).map_or(0.0, |beta| beta.inverse_cdf(1.0 - confidence))
}

/// Upper bound of the probability of success, one-sided as [`success_lower_bound`].
#[must_use]
pub fn success_upper_bound(failures: u64, runs: u64, confidence: f64) -> f64 {
    1.0 - success_lower_bound(runs.saturating_sub(failures), runs, confidence)
}

/// How much better a second method is, from paired runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Improvement {
    /// 1 − rms(second)/rms(first).
    pub value: f64,
    /// Lower end of the 90 % interval.
    pub low: f64,
    /// Upper end of the 90 % interval.
    pub high: f64,
}

/// Improvement of `second` over `first`, run by run with the same seeds, as 1 − ratio of the root
/// mean squares, and its 90 % interval by the paired bootstrap (Efron, 1979): whole pairs are drawn
/// with replacement, so what both share, the instrument and its noise, stays shared.
///
/// `None` if the lengths differ, there are fewer than two pairs, or `first` is all zero.
#[must_use]
pub fn improvement(first: &[f64], second: &[f64], seed: u64) -> Option<Improvement> {
    let pairs = first.len();
    let (whole, other) = (rms(first)?, rms(second)?);
    if second.len() != pairs || pairs < 2 || whole == 0.0 || !(whole + other).is_finite() {
        return None;
    }
    let mut random = Philox::from_u64_seed(seed);
    let mut resampled = Vec::with_capacity(RESAMPLES as usize);
    for _ in 0..RESAMPLES {
        let (mut a, mut b) = (0.0, 0.0);
        for _ in 0..pairs {
            let i = random.bounded(pairs as u32) as usize;
            a += first[i] * first[i];
            b += second[i] * second[i];
        }
        if a > 0.0 {
            resampled.push(1.0 - libm::sqrt(b / a));
        }
    }
    Some(Improvement {
        value: 1.0 - other / whole,
        low: percentile(&resampled, 0.05)?,
        high: percentile(&resampled, 0.95)?,
    })
}
