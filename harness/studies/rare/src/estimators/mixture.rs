//! Mixtures of normal distributions that are moved to the failures.
//!
//! A fitted component has the covariance of the inputs, the identity. A narrower one would let the weights grow without
//! bound at its edges, and where the noise decides, far from its centre, failures still occur. Wider ones guard against
//! directions that no chain met, where there are few components.

use crate::estimators::point::RarePoint;
use crate::estimators::slope::slope;
use octant_random::draws::Draws;

/// Rounds of expectation and maximization.
const ROUNDS: usize = 30;

/// A mixture of normal distributions with identity covariance.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMixture {
    /// Components.
    pub parts: Vec<MixturePart>,
}

/// A component.
#[derive(Clone, Debug, PartialEq)]
pub struct MixturePart {
    /// Weight.
    pub weight: f64,
    /// Standard deviation in every direction.
    pub sigma: f64,
    /// Mean.
    pub mean: Vec<f64>,
}

/// Points that a mixture is fitted to, with their weights.
#[derive(Clone, Debug, Default)]
pub struct Weighted<'a> {
    pub(crate) points: Vec<(&'a [f64], f64)>,
}

impl NormalMixture {
    /// The distribution of the inputs.
    #[must_use]
    pub fn plain(dimension: usize) -> Self {
        Self::around(dimension, 1.0)
    }

    /// A normal distribution about the middle of the inputs, with another standard deviation.
    #[must_use]
    pub fn around(dimension: usize, sigma: f64) -> Self {
        Self { parts: vec![MixturePart { weight: 1.0, sigma, mean: vec![0.0; dimension] }] }
    }

    /// Fits `count` components by expectation and maximization, from a start that the draws choose (k-means++).
    #[must_use]
    pub fn fitted(data: &Weighted<'_>, count: usize, draws: &mut Draws) -> Self {
        Self::begun(data, count, draws).refitted(data)
    }

    /// Fits the components again, from where they are.
    #[must_use]
    pub fn refitted(&self, data: &Weighted<'_>) -> Self {
        let mut mixture = self.clone();
        let rounds = if mixture.parts.len() > 1 { ROUNDS } else { 1 };
        for _ in 0..rounds {
            mixture.maximized(data);
        }
        mixture
    }

    fn begun(data: &Weighted<'_>, count: usize, draws: &mut Draws) -> Self {
        let mut parts: Vec<MixturePart> = Vec::new();
        let share = 1.0 / count as f64;
        while parts.len() < count {
            let distances: Vec<f64> = (data.points.iter())
                .map(|(u, weight)| {
                    let nearest = parts.iter().map(|part| squared(u, &part.mean));
                    let nearest = nearest.fold(f64::INFINITY, f64::min);
                    weight * if nearest.is_finite() { nearest } else { 1.0 }
                })
                .collect();
            let total: f64 = distances.iter().sum();
            let mut left = draws.unit() * total;
            let at = distances.iter().position(|distance| {
                left -= distance;
                left <= 0.0
            });
            let Some((u, _)) = data.points.get(at.unwrap_or(0)) else { break };
            parts.push(MixturePart { weight: share, sigma: 1.0, mean: u.to_vec() });
        }
        Self { parts }
    }

    /// One round: shares of the components in each point, then their weights and means.
    fn maximized(&mut self, data: &Weighted<'_>) {
        let dimension = self.parts.first().map_or(0, |part| part.mean.len());
        let mut sums = vec![(0.0, vec![0.0; dimension]); self.parts.len()];
        for (u, weight) in &data.points {
            let logs = self.logs(u);
            let total = log_sum(&logs);
            for ((sum, mean), log) in sums.iter_mut().zip(&logs) {
                let share = weight * libm::exp(log - total);
                *sum += share;
                mean.iter_mut().zip(*u).for_each(|(mean, u)| *mean += share * u);
            }
        }
        let total: f64 = sums.iter().map(|(sum, _)| sum).sum();
        if !(total > 0.0) {
            return;
        }
        // An empty component keeps its place, with hardly any weight.
        let least = 1e-6 * total;
        let whole: f64 = sums.iter().map(|(sum, _)| sum.max(least)).sum();
        for (part, (sum, mean)) in self.parts.iter_mut().zip(sums) {
            part.weight = sum.max(least) / whole;
            if sum > 1e-9 * total {
                part.mean = mean.into_iter().map(|mean| mean / sum).collect();
            }
        }
    }

    /// ln(weight × density / density of the inputs) of each component.
    fn logs(&self, u: &[f64]) -> Vec<f64> {
        let own: f64 = u.iter().map(|u| u * u).sum();
        let of_part = |part: &MixturePart| {
            let scaled = squared(u, &part.mean) / (part.sigma * part.sigma);
            let volume = u.len() as f64 * libm::log(part.sigma);
            libm::log(part.weight) + 0.5 * (own - scaled) - volume
        };
        self.parts.iter().map(of_part).collect()
    }

    /// ln of the density over that of the inputs.
    #[must_use]
    pub fn log_ratio(&self, u: &[f64]) -> f64 {
        log_sum(&self.logs(u))
    }

    /// The same mixture with its means nearer to that of the inputs by a factor.
    #[must_use]
    pub fn nearer(&self, factor: f64) -> Self {
        let near = |part: &MixturePart| MixturePart {
            mean: part.mean.iter().map(|m| factor * m).collect(),
            ..part.clone()
        };
        Self { parts: self.parts.iter().map(near).collect() }
    }

    /// The same mixture with each mean moved onto the line along which the severity grows at its component: the
    /// samples of a chain resemble each other, and their mean has errors across that line which a regression over all
    /// runs doesn't have.
    #[must_use]
    pub fn projected(&self, samples: &[(&[f64], f64)]) -> Self {
        let logs: Vec<Vec<f64>> = samples.iter().map(|(u, _)| self.logs(u)).collect();
        let totals: Vec<f64> = logs.iter().map(|logs| log_sum(logs)).collect();
        let of_part = |(part, of_part): (usize, &MixturePart)| {
            let mean = &of_part.mean;
            let share = |index: usize| libm::exp(logs[index][part] - totals[index]);
            let points: Vec<(&[f64], f64, f64)> = (samples.iter().enumerate())
                .map(|(index, (u, severity))| (*u, share(index), *severity))
                .filter(|(_, share, _)| *share > 1e-3)
                .collect();
            let on_line = slope(&points).and_then(|slope| {
                let squared: f64 = slope.iter().map(|s| s * s).sum();
                let along = slope.iter().zip(mean).map(|(s, m)| s * m).sum::<f64>() / squared;
                (along > 0.0).then(|| slope.into_iter().map(|s| along * s).collect())
            });
            MixturePart { mean: on_line.unwrap_or_else(|| mean.clone()), ..of_part.clone() }
        };
        Self { parts: self.parts.iter().enumerate().map(of_part).collect() }
    }

    /// A mixture of mixtures, each with its share.
    #[must_use]
    pub fn of(mixtures: &[(f64, &Self)]) -> Self {
        let parts = mixtures.iter().flat_map(|(share, mixture)| {
            mixture
                .parts
                .iter()
                .map(move |part| MixturePart { weight: share * part.weight, ..part.clone() })
        });
        Self { parts: parts.collect() }
    }

    /// Draws a point. Its noise is drawn as ever.
    #[must_use]
    pub fn draw(&self, draws: &mut Draws) -> RarePoint {
        let total: f64 = self.parts.iter().map(|part| part.weight).sum();
        let mut left = draws.unit() * total;
        let part = self.parts.iter().find(|part| {
            left -= part.weight;
            left <= 0.0
        });
        let Some(part) = part.or(self.parts.last()) else { return RarePoint::drawn(0, draws) };
        let mut point = RarePoint::drawn(part.mean.len(), draws);
        point.u.iter_mut().zip(&part.mean).for_each(|(u, mean)| *u = part.sigma * *u + mean);
        point
    }

    /// Mean of [`Self::log_ratio`] over weighted points.
    #[must_use]
    pub fn likelihood(&self, data: &Weighted<'_>) -> f64 {
        let total: f64 = data.points.iter().map(|(_, weight)| weight).sum();
        data.points.iter().map(|(u, weight)| weight * self.log_ratio(u)).sum::<f64>() / total
    }
}

fn squared(u: &[f64], mean: &[f64]) -> f64 {
    u.iter().zip(mean).map(|(u, m)| (u - m) * (u - m)).sum()
}

fn log_sum(logs: &[f64]) -> f64 {
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return largest;
    }
    largest + libm::log(logs.iter().map(|log| libm::exp(log - largest)).sum())
}
