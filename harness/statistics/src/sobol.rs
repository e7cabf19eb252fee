//! Sobol indices: which part of an output's variance a factor makes, alone and with the others.
//!
//! The design is that of Saltelli et al., "Variance based sensitivity analysis of model output",
//! Computer Physics Communications 181, 2010: two independent samples A and B of n rows, and for each
//! of k factors the rows of A with that one factor from B; n (k + 2) runs.

use crate::draw::unit;
use crate::sample::{Interval, percentile};
use octant_random::philox::block;
use octant_random::stream::{Phase, key};
use serde::{Deserialize, Serialize};

/// Resamples of the bootstrap of the indices.
const RESAMPLES: usize = 1000;

/// Which sample a run of the design is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// Of the first sample.
    A,
    /// Of the second.
    B,
    /// Of the first, with this factor from the second.
    Mixed(usize),
}

/// A design for factors of these names. Runs come row by row: A, B, then the mixed ones in the order of
/// the factors; so a longer design begins with a shorter one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Design {
    names: Vec<String>,
    rows: usize,
    seed: u64,
}

/// Why indices can't be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SobolError {
    /// Not the outputs of this design.
    #[error("make Sobol indices: found {found} outputs, the design has {expected} runs")]
    Outputs {
        /// Found.
        found: usize,
        /// Runs of the design.
        expected: usize,
    },
    /// One is not a number.
    #[error("make Sobol indices: the output of run {run} is not finite")]
    NotFinite {
        /// The run, from 0.
        run: usize,
    },
    /// All are the same.
    #[error(
        "make Sobol indices: the output is the same in all runs, there is no variance to divide"
    )]
    Constant,
}

impl Design {
    /// A design of `rows` rows, (factors + 2) runs each.
    #[must_use]
    pub fn new(names: &[String], rows: usize, seed: u64) -> Self {
        Self { names: names.to_vec(), rows, seed }
    }

    /// Runs of the whole design.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.rows * (self.names.len() + 2)
    }

    /// Row and role of a run.
    #[must_use]
    pub fn place(&self, run: usize) -> (usize, Role) {
        let width = self.names.len() + 2;
        let role = match run % width {
            0 => Role::A,
            1 => Role::B,
            at => Role::Mixed(at - 2),
        };
        (run / width, role)
    }

    /// The factors of a run as probabilities in (0, 1): [`crate::draw::Factor::at`] makes values of
    /// them. That of sample A is the factor's Monte Carlo draw of the row, that of B its second word.
    #[must_use]
    pub fn units(&self, run: usize) -> Vec<f64> {
        let (row, role) = self.place(run);
        let from_b = |factor: usize| match role {
            Role::A => false,
            Role::B => true,
            Role::Mixed(mixed) => mixed == factor,
        };
        let draw = |(factor, name): (usize, &String)| {
            unit(self.seed, name, row as u64, usize::from(from_b(factor)))
        };
        self.names.iter().enumerate().map(draw).collect()
    }

    /// First-order and total index of every factor from the outputs of all runs, with the interval of
    /// a bootstrap over the rows at this confidence.
    ///
    /// First order by Saltelli et al. 2010, table 2 (b): mean of f(B) (f(AB) − f(A)) over the variance;
    /// total by Jansen, table 2 (f): mean of (f(A) − f(AB))² / 2 over the variance. Outputs are taken
    /// about their mean, which the first estimator needs to be sharp.
    ///
    /// # Errors
    /// If the outputs aren't those of this design, one isn't finite, or all are the same.
    pub fn indices(&self, outputs: &[f64], confidence: f64) -> Result<Vec<Index>, SobolError> {
        let (width, rows) = (self.names.len() + 2, self.rows);
        if outputs.len() != self.runs() || rows == 0 {
            return Err(SobolError::Outputs { found: outputs.len(), expected: self.runs() });
        }
        if let Some(run) = outputs.iter().position(|v| !v.is_finite()) {
            return Err(SobolError::NotFinite { run });
        }
        let all: Vec<usize> = (0..rows).collect();
        let estimate = |rows: &[usize]| estimate(outputs, width, rows);
        let values = estimate(&all).ok_or(SobolError::Constant)?;
        let mut resampled: Vec<Vec<(f64, f64)>> = vec![Vec::new(); self.names.len()];
        let stream = key(self.seed, "sobol bootstrap", Phase::Draw);
        let mut chosen = vec![0; rows];
        for resample in 0..RESAMPLES {
            for (at, slot) in chosen.iter_mut().enumerate() {
                let word = block(stream, [at as u64, resample as u64, 0, 0])[0];
                // The high half of a product: even to 2⁻⁶⁴ of the rows.
                *slot = ((u128::from(word) * rows as u128) >> 64) as usize;
            }
            for (of, pair) in resampled.iter_mut().zip(estimate(&chosen).into_iter().flatten()) {
                of.push(pair);
            }
        }
        let tail = 0.5 * (1.0 - confidence);
        let interval = |value: f64, all: &[f64]| Interval {
            value,
            low: percentile(all, tail).unwrap_or(f64::NEG_INFINITY),
            high: percentile(all, 1.0 - tail).unwrap_or(f64::INFINITY),
        };
        let named = self.names.iter().zip(values).zip(resampled);
        Ok(named
            .map(|((name, (first, total)), all)| {
                let (firsts, totals): (Vec<f64>, Vec<f64>) = all.into_iter().unzip();
                Index {
                    factor: name.clone(),
                    first_order: interval(first, &firsts),
                    total: interval(total, &totals),
                }
            })
            .collect())
    }
}

/// First-order and total index of each factor from these rows; `None` without variance.
fn estimate(outputs: &[f64], width: usize, rows: &[usize]) -> Option<Vec<(f64, f64)>> {
    let n = rows.len() as f64;
    let at = |row: usize, column: usize| outputs[row * width + column];
    let both = |f: &dyn Fn(f64) -> f64| {
        rows.iter().map(|r| f(at(*r, 0)) + f(at(*r, 1))).sum::<f64>() / (2.0 * n)
    };
    let mean = both(&|v| v);
    let variance = both(&|v| (v - mean) * (v - mean));
    if !(variance > 0.0) {
        return None;
    }
    let factor = |column: usize| {
        let (mut first, mut total) = (0.0, 0.0);
        for row in rows {
            let (a, b, mixed) = (at(*row, 0), at(*row, 1), at(*row, column));
            first += (b - mean) * (mixed - a);
            total += (a - mixed) * (a - mixed);
        }
        (first / n / variance, total / (2.0 * n) / variance)
    };
    Some((2..width).map(factor).collect())
}

/// The indices of one factor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Index {
    /// The factor.
    pub factor: String,
    /// Part of the variance that it makes alone.
    pub first_order: Interval,
    /// Part that it makes alone and with others.
    pub total: Interval,
}
