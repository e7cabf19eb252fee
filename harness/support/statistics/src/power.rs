//! Detection power: the smallest change that a number of runs detects with a given probability.
//!
//! A result of no change is meaningful only together with it.

use super::sample::student;
use crate::draw::unit;
use crate::normal;
use crate::sample::ranks;
use statrs::distribution::{Beta, ChiSquared, ContinuousCDF};

/// Power for which reports state the smallest change.
pub const POWER: f64 = 0.9;
/// Number of simulated samples for the power of a signed-rank test, which gives it to 0.7 %.
const SAMPLES: u64 = 2000;
/// Number of pairs above which Student's test, scaled by the asymptotic efficiency, replaces the
/// simulation.
const SIMULATED_MAX: u64 = 60;
/// Number of halvings of an interval of shifts.
const HALVINGS: u32 = 14;
/// Asymptotic relative efficiency of the signed-rank test to Student's for normal differences, 3/π
/// (Hodges and Lehmann, Annals of Mathematical Statistics 27, 1956).
const EFFICIENCY: f64 = 3.0 / core::f64::consts::PI;

fn sane(level: f64, power: f64) -> bool {
    let inside = |p: f64| p > 0.0 && p < 1.0;
    inside(level) && inside(power)
}

/// Smallest shift of the mean of `pairs` normal differences, in their σ, that Wilcoxon's signed-rank
/// test at a two-sided `level` detects with probability `power`. `None`: so few pairs detect no shift.
///
/// Up to 60 pairs the power is that of simulated samples, the same ones each time, compared with the
/// exact critical value.
#[must_use]
pub fn signed_rank_shift(pairs: u64, level: f64, power: f64) -> Option<f64> {
    // Equal signs of all differences are the most extreme result.
    if pairs == 0 || !sane(level, power) || libm::exp2(1.0 - pairs as f64) > level {
        return None;
    }
    if pairs > SIMULATED_MAX {
        let student = student(pairs as usize - 1, 1.0 - level)?;
        let effective = EFFICIENCY * pairs as f64;
        return Some((student + normal::quantile(power)) / libm::sqrt(effective));
    }
    let critical = critical_rank_sum(pairs as usize, level)?;
    let samples: Vec<Vec<f64>> = (0..SAMPLES)
        .map(|i| {
            let one = |k: u64| normal::quantile(unit(0, "power", i * SIMULATED_MAX + k, 0));
            (0..pairs).map(one).collect()
        })
        .collect();
    let found = |shift: f64| {
        let is_found = |sample: &&Vec<f64>| {
            let shifted: Vec<f64> = sample.iter().map(|d| d + shift).collect();
            let ranks = ranks(&shifted.iter().map(|d| d.abs()).collect::<Vec<_>>());
            let positive: f64 =
                ranks.iter().zip(&shifted).filter(|(_, d)| **d > 0.0).map(|(rank, _)| rank).sum();
            let total = (pairs * (pairs + 1) / 2) as f64;
            positive.min(total - positive) <= critical
        };
        samples.iter().filter(is_found).count() as f64 >= power * SAMPLES as f64
    };
    let (mut low, mut high) = (0.0, 8.0);
    if !found(high) {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if found(middle) { high = middle } else { low = middle }
    }
    Some(high)
}

/// Largest sum of ranks of one sign that is significant at a two-sided level.
fn critical_rank_sum(pairs: usize, level: f64) -> Option<f64> {
    let mut probability = vec![0.0; pairs * (pairs + 1) / 2 + 1];
    probability[0] = 1.0;
    let mut reached = 0;
    for rank in 1..=pairs {
        for sum in (0..=reached).rev() {
            let half = 0.5 * probability[sum];
            probability[sum] = half;
            probability[sum + rank] += half;
        }
        reached += rank;
    }
    let mut tail = 0.0;
    let significant = probability.iter().take_while(|p| {
        tail += **p;
        2.0 * tail <= level
    });
    let sums = significant.count();
    (sums > 0).then(|| (sums - 1) as f64)
}

/// Smallest probability that the result of a pair changes, always in the same direction, that McNemar's
/// test at a two-sided `level` detects with probability `power` in so many pairs. `None`: so few pairs
/// detect none.
#[must_use]
pub fn turning(pairs: u64, level: f64, power: f64) -> Option<f64> {
    if !sane(level, power) {
        return None;
    }
    // Smallest k with 2 · 2^(−k) at most the level.
    let turned = libm::ceil(1.0 - libm::log2(level)) as u64;
    if turned > pairs {
        return None;
    }
    // P(at least k of n change) is the incomplete beta function I(p; k, n − k + 1).
    let beta = Beta::new(turned as f64, (pairs - turned + 1) as f64).ok()?;
    Some(beta.inverse_cdf(power))
}

/// Smallest difference of a mean, in σ, that a two-sided Student interval of this many values with this
/// confidence excludes with probability `power`.
#[must_use]
pub fn mean_shift(values: u64, confidence: f64, power: f64) -> Option<f64> {
    if !sane(1.0 - confidence, power) {
        return None;
    }
    let student = student(usize::try_from(values).ok()?.checked_sub(1)?, confidence)?;
    Some((student + normal::quantile(power)) / libm::sqrt(values as f64))
}

/// Ratios of σ, below and above 1, that the χ² interval of this many normal values with this confidence
/// excludes with probability `power`.
#[must_use]
pub fn sigma_ratios(values: u64, confidence: f64, power: f64) -> Option<(f64, f64)> {
    if !sane(1.0 - confidence, power) {
        return None;
    }
    let squares = ChiSquared::new(values.checked_sub(1)? as f64).ok()?;
    let left = 0.5 * (1.0 - confidence);
    let ratio = |interval: f64, found: f64| {
        libm::sqrt(squares.inverse_cdf(interval) / squares.inverse_cdf(found))
    };
    Some((ratio(left, power), ratio(1.0 - left, 1.0 - power)))
}
