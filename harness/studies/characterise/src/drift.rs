//! Steady change of the rate, by generalized least squares on means over equal blocks.
//!
//! Differences of neighbouring block means are second differences of the phase, whose covariances follow from the
//! fitted terms ([`super::kernel`]), with those that may be there too. The best linear estimate of the ramp weighs them with the inverse of this matrix;
//! its interval has Student's distribution with the degrees of freedom with which its variance is known.

use super::deviations::RateChannels;
use super::fit::RandomTermsFit;
use super::kernel::{DifferenceOrder, Kernel, RandomTerm, TERMS};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Most blocks of a recording.
const BLOCKS: u64 = 128;

/// Steady change of the rate of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RampEstimate {
    /// Change, rad/s² or m/s³; `None`: its interval has zero.
    pub value: Option<f64>,
    /// Interval of 95 %; without a value that of the size, from 0 to the upper end of the interval.
    pub interval: [f64; 2],
}

/// Means over equal blocks within stretches.
#[derive(Clone, Debug)]
pub struct BlockMeans {
    samples: u64,
    present: RateChannels,
    count: u64,
    /// Means of each stretch.
    stretches: Vec<Vec<RateChannels>>,
}

impl BlockMeans {
    /// Prepares for stretches of these lengths, in samples.
    #[must_use]
    pub fn new(lengths: &[u64]) -> Self {
        let total: u64 = lengths.iter().sum();
        let samples = total.div_ceil(BLOCKS).max(1);
        Self { samples, present: [0.0; 6], count: 0, stretches: vec![Vec::new()] }
    }

    /// Takes the next sample of a stretch.
    pub fn push(&mut self, rates: &RateChannels) {
        for (sum, rate) in self.present.iter_mut().zip(rates) {
            *sum += rate;
        }
        self.count += 1;
        if self.count == self.samples {
            let mean = self.present.map(|sum| sum / self.samples as f64);
            if let Some(last) = self.stretches.last_mut() {
                last.push(mean);
            }
            (self.present, self.count) = ([0.0; 6], 0);
        }
    }

    /// Ends a stretch.
    pub fn end_stretch(&mut self) {
        (self.present, self.count) = ([0.0; 6], 0);
        self.stretches.push(Vec::new());
    }

    /// Estimates the ramp of a channel; `None` with fewer than four differences.
    #[must_use]
    pub fn ramp(
        &self,
        channel: usize,
        noise: &RandomTermsFit,
        period_s: f64,
    ) -> Option<RampEstimate> {
        let (squares, kernel) = noise.wide(period_s);
        let block_s = self.samples as f64 * period_s;
        let (mut weight, mut sum, mut parts, mut count) = (0.0, 0.0, [0.0; TERMS], 0);
        for means in &self.stretches {
            let n = means.len().saturating_sub(1);
            if n == 0 {
                continue;
            }
            count += n;
            let covariance =
                |lag: usize, squares: &[f64; TERMS]| covariance(&kernel, squares, block_s, lag);
            let matrix = toeplitz(n, |lag| covariance(lag, &squares));
            // x = C⁻¹ 1, so that the ramp is x·d / (x·1).
            let x = cholesky_solve(matrix, vec![1.0; n])?;
            let d = means.windows(2).map(|pair| (pair[1][channel] - pair[0][channel]) / block_s);
            sum += x.iter().zip(d).map(|(x, d)| x * d).sum::<f64>();
            weight += x.iter().sum::<f64>();
            for (term, part) in parts.iter_mut().enumerate() {
                let mut one = [0.0; TERMS];
                one[term] = 1.0;
                if squares[term] > 0.0 {
                    let lags: Vec<f64> = (0..n).map(|lag| covariance(lag, &one)).collect();
                    for i in 0..n {
                        for j in 0..n {
                            *part += x[i] * x[j] * lags[i.abs_diff(j)];
                        }
                    }
                }
            }
        }
        if count < 4 || !(weight > 0.0) {
            return None;
        }
        let (value, variance) = (sum / weight, 1.0 / weight);
        // Variance of the variance, from that of the squared coefficients.
        let parts = parts.map(|part| part / (weight * weight));
        let mut spread = 0.0;
        for p in 0..TERMS {
            for q in 0..TERMS {
                spread += parts[p] * parts[q] * noise.covariance()[p][q];
            }
        }
        let freedom = (2.0 * variance * variance / spread).clamp(1.0, 1e6);
        let student = StudentsT::new(0.0, libm::sqrt(variance), freedom).ok()?;
        let half = student.inverse_cdf(0.975);
        let shown = value.abs() > half;
        Some(if shown {
            RampEstimate { value: Some(value), interval: [value - half, value + half] }
        } else {
            // The two-sided end: whether a ramp is shown is told by the same data, and each end may miss 2.5 % in all.
            RampEstimate { value: None, interval: [0.0, value.abs() + half] }
        })
    }
}

/// Covariance of two differences of neighbouring block means, divided by the length of a block.
fn covariance(kernel: &Kernel, squares: &[f64; TERMS], block_s: f64, lag: usize) -> f64 {
    let of = |(term, square): (&RandomTerm, &f64)| {
        if *square > 0.0 {
            square
                * kernel.covariance(*term, DifferenceOrder::Second, block_s, lag as f64 * block_s)
        } else {
            0.0
        }
    };
    RandomTerm::ALL.iter().zip(squares).map(of).sum::<f64>()
        / (block_s * block_s * block_s * block_s)
}

fn toeplitz(n: usize, at: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
    let lags: Vec<f64> = (0..n).map(at).collect();
    (0..n).map(|i| (0..=i).map(|j| lags[i - j]).collect()).collect()
}

/// Solves with a symmetric matrix, of which the lower triangle is given.
fn cholesky_solve(mut matrix: Vec<Vec<f64>>, mut x: Vec<f64>) -> Option<Vec<f64>> {
    let n = x.len();
    for i in 0..n {
        for j in 0..=i {
            let mut value = matrix[i][j];
            for k in 0..j {
                value -= matrix[i][k] * matrix[j][k];
            }
            if i > j {
                matrix[i][j] = value / matrix[j][j];
            } else if value > 0.0 {
                matrix[i][i] = libm::sqrt(value);
            } else {
                return None;
            }
        }
        for k in 0..i {
            x[i] -= matrix[i][k] * x[k];
        }
        x[i] /= matrix[i][i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            x[i] -= matrix[k][i] * x[k];
        }
        x[i] /= matrix[i][i];
    }
    Some(x)
}
