//! Mixtures of normal distributions that are moved to the failures.
//!
//! Every component has the covariance of the inputs, the identity. A narrower one would let the weights grow without
//! bound at its edges, and where the noise decides, far from its centre, failures still occur.

use crate::point::RarePoint;
use octant_random::draws::Draws;

/// Rounds of expectation and maximization.
const ROUNDS: usize = 30;

/// A mixture of normal distributions with identity covariance.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMixture {
    /// Weight, mean.
    pub parts: Vec<(f64, Vec<f64>)>,
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
        Self { parts: vec![(1.0, vec![0.0; dimension])] }
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
        let mut parts: Vec<(f64, Vec<f64>)> = Vec::new();
        let share = 1.0 / count as f64;
        while parts.len() < count {
            let distances: Vec<f64> = (data.points.iter())
                .map(|(u, weight)| {
                    let nearest = parts.iter().map(|(_, mean)| squared(u, mean));
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
            parts.push((share, u.to_vec()));
        }
        Self { parts }
    }

    /// One round: shares of the components in each point, then their weights and means.
    fn maximized(&mut self, data: &Weighted<'_>) {
        let dimension = self.parts.first().map_or(0, |(_, mean)| mean.len());
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
            part.0 = sum.max(least) / whole;
            if sum > 1e-9 * total {
                part.1 = mean.into_iter().map(|mean| mean / sum).collect();
            }
        }
    }

    /// ln(weight × density / density of the inputs) of each component.
    fn logs(&self, u: &[f64]) -> Vec<f64> {
        let of_part = |(weight, mean): &(f64, Vec<f64>)| {
            let (along, squared) = mean
                .iter()
                .zip(u)
                .fold((0.0, 0.0), |(along, squared), (m, u)| (along + m * u, squared + m * m));
            libm::log(*weight) + along - 0.5 * squared
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
        let near = |(weight, mean): &(f64, Vec<f64>)| {
            (*weight, mean.iter().map(|m| factor * m).collect())
        };
        Self { parts: self.parts.iter().map(near).collect() }
    }

    /// A mixture of mixtures, each with its share.
    #[must_use]
    pub fn of(mixtures: &[(f64, &Self)]) -> Self {
        let parts = mixtures.iter().flat_map(|(share, mixture)| {
            mixture.parts.iter().map(move |(weight, mean)| (share * weight, mean.clone()))
        });
        Self { parts: parts.collect() }
    }

    /// Draws a point. Its noise is drawn as ever.
    #[must_use]
    pub fn draw(&self, draws: &mut Draws) -> RarePoint {
        let total: f64 = self.parts.iter().map(|(weight, _)| weight).sum();
        let mut left = draws.unit() * total;
        let part = self.parts.iter().find(|(weight, _)| {
            left -= weight;
            left <= 0.0
        });
        let mean = part.or(self.parts.last()).map_or(&[][..], |(_, mean)| mean);
        let mut point = RarePoint::drawn(mean.len(), draws);
        point.u.iter_mut().zip(mean).for_each(|(u, mean)| *u += mean);
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
