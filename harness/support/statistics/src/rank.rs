//! Rank correlation between an output and a factor, for any monotonic relation.

use crate::sample::{mean, ranks};
use serde::{Deserialize, Serialize};
use statrs::distribution::{Beta, ContinuousCDF};

/// A rank correlation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RankCorrelation {
    /// Spearman's ρ.
    pub rho: f64,
    /// Two-sided probability of a magnitude at least as large without any relation.
    pub p: f64,
}

/// Spearman's rank correlation (American Journal of Psychology 15, 1904) of pairs; ties have the mean
/// of their ranks. With up to eight pairs the probability is exact: the share of all n! orders with a
/// magnitude at least as large. With more it is that of t = ρ √((n − 2)/(1 − ρ²)) with n − 2 degrees of
/// freedom (Kendall and Stuart, vol. 2, section 31.19), at least that of two orders among n!.
///
/// Returns `None` if the lengths differ, there are fewer than three pairs, a value is NaN, or one side
/// is constant.
#[must_use]
pub fn spearman(x: &[f64], y: &[f64]) -> Option<RankCorrelation> {
    let n = x.len();
    if y.len() != n || n < 3 || x.iter().chain(y).any(|v| v.is_nan()) {
        return None;
    }
    let (x, y) = (ranks(x), ranks(y));
    let middle = mean(&x)?;
    let dot = |a: &[f64], b: &[f64]| {
        a.iter().zip(b).map(|(a, b)| (a - middle) * (b - middle)).sum::<f64>()
    };
    let rho = dot(&x, &y) / libm::sqrt(dot(&x, &x) * dot(&y, &y));
    if !rho.is_finite() {
        return None;
    }
    let rho = rho.clamp(-1.0, 1.0);
    if n <= EXACT_PAIRS {
        let product = |y: &[f64]| dot(&x, y).abs();
        // Ranks are halves: products differ by a quarter or not at all.
        let p = share_of_orders(y.clone(), |other| product(other) > product(&y) - 0.125);
        return Some(RankCorrelation { rho, p });
    }
    // Two tails of Student's distribution are I(ν/(ν + t²); ν/2, 1/2), and ν/(ν + t²) is 1 − ρ².
    let degrees = (n - 2) as f64;
    let p = match 1.0 - rho * rho {
        rest if rest > 0.0 => Beta::new(0.5 * degrees, 0.5).ok()?.cdf(rest),
        _ => 0.0,
    };
    // Of all orders at least this one and the opposite one are as extreme; of many their share is nothing.
    let orders: f64 = (1..=n).map(|i| i as f64).product();
    let least = if n <= COUNTED_PAIRS { 2.0 / orders } else { 0.0 };
    Some(RankCorrelation { rho, p: p.max(least) })
}

/// Most pairs whose orders are all looked at: 8! is 40 320.
const EXACT_PAIRS: usize = 8;

/// Most pairs among whose orders a single one counts: 2/20! is 8e-19.
const COUNTED_PAIRS: usize = 20;

/// Returns the share of all orders of some values that `extreme` is true for (B. R. Heap, 1963, The
/// Computer Journal 6).
fn share_of_orders(mut values: Vec<f64>, extreme: impl Fn(&[f64]) -> bool) -> f64 {
    let mut turns = vec![0; values.len()];
    let (mut count, mut all) = (u32::from(extreme(&values)), 1u32);
    let mut place = 0;
    while place < values.len() {
        if turns[place] < place {
            values.swap(if place % 2 == 0 { 0 } else { turns[place] }, place);
            count += u32::from(extreme(&values));
            all += 1;
            turns[place] += 1;
            place = 0;
        } else {
            turns[place] = 0;
            place += 1;
        }
    }
    f64::from(count) / f64::from(all)
}

impl RankCorrelation {
    /// True if the correlation is significant at this level as one of `looked_at` tests, each of which
    /// has its part of the level (Bonferroni).
    #[must_use]
    pub fn stands_out(self, level: f64, looked_at: usize) -> bool {
        self.p <= level / looked_at.max(1) as f64
    }
}

/// Correlation of an output with one factor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensitivity {
    /// Name of the factor.
    pub factor: String,
    /// Rank correlation; `None` if the factor is the same in all runs, or a value is NaN.
    pub correlation: Option<RankCorrelation>,
}

/// Rank correlations of an output with every factor, the strongest first.
#[must_use]
pub fn sensitivities(factors: &[(String, Vec<f64>)], output: &[f64]) -> Vec<Sensitivity> {
    let mut all: Vec<Sensitivity> = factors
        .iter()
        .map(|(factor, values)| Sensitivity {
            factor: factor.clone(),
            correlation: spearman(values, output),
        })
        .collect();
    let size = |s: &Sensitivity| s.correlation.map_or(-1.0, |c| c.rho.abs());
    // The stable sort keeps equal ones in the order of the factors.
    all.sort_by(|a, b| size(b).total_cmp(&size(a)));
    all
}
