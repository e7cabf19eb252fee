//! Uncertainty of coefficients that are fitted as if octaves were independent, which they aren't.

use super::scoring::{Model, Rows};
use crate::freedom::Covariances;
use crate::kernel::TERMS;
use nalgebra::SMatrix;

/// Parameters: the squared coefficients, and the logarithm of the correlation time.
const PARAMETERS: usize = TERMS + 1;
type Square = SMatrix<f64, PARAMETERS, PARAMETERS>;
/// Step in the logarithm of the correlation time for its derivative.
const STEP: f64 = 1e-3;

/// Inverse of the information as if octaves were independent, and the true covariance.
pub(super) struct Uncertainty {
    naive: Square,
    sandwich: Square,
}

impl Uncertainty {
    /// Computes both for the free terms of a model; with the Gauss-Markov term its correlation time is free too.
    pub(super) fn of(
        rows: &Rows,
        covariances: &Covariances,
        model: &Model,
        free: &[usize],
    ) -> Self {
        let terms = rows.terms(model.time_s);
        let gauss_markov = TERMS - 1;
        let with_time = free.contains(&gauss_markov) && model.squares[gauss_markov] > 0.0;
        let later = with_time.then(|| rows.terms(model.time_s * libm::exp(STEP)));
        // Derivatives as multiples of the mean, in units that make the columns alike.
        let mut columns: Vec<[f64; PARAMETERS]> = Vec::with_capacity(rows.len());
        let mut weights = Vec::with_capacity(rows.len());
        let mut means = Vec::with_capacity(rows.len());
        for (index, (row, terms)) in rows.all.iter().zip(&terms).enumerate() {
            let mean: f64 = terms.iter().zip(&model.squares).map(|(a, b)| a * b).sum();
            let mut column = [0.0; PARAMETERS];
            for &i in free {
                column[i] = terms[i] / mean;
            }
            if let Some(later) = &later {
                let change = later[index][gauss_markov] - terms[gauss_markov];
                column[TERMS] = model.squares[gauss_markov] * change / STEP / mean;
            }
            columns.push(column);
            weights.push(0.5 * row.freedom);
            means.push(mean);
        }
        let mut scale = [0.0f64; PARAMETERS];
        for (column, weight) in columns.iter().zip(&weights) {
            for p in 0..PARAMETERS {
                scale[p] += weight * column[p] * column[p];
            }
        }
        let scale = scale.map(|square| if square > 0.0 { 1.0 / libm::sqrt(square) } else { 0.0 });
        let (mut information, mut variance) = (Square::zeros(), Square::zeros());
        for (i, a) in columns.iter().enumerate() {
            for p in 0..PARAMETERS {
                for q in 0..PARAMETERS {
                    information[(p, q)] += weights[i] * a[p] * a[q] * scale[p] * scale[q];
                }
            }
            for (j, b) in columns.iter().enumerate() {
                let (row, other) = (rows.all[i].number, rows.all[j].number);
                let shared = covariances.at(row, other, &model.squares) / (means[i] * means[j]);
                let weight = weights[i] * weights[j] * shared;
                for p in 0..PARAMETERS {
                    for q in 0..PARAMETERS {
                        variance[(p, q)] += weight * a[p] * b[q] * scale[p] * scale[q];
                    }
                }
            }
        }
        for p in 0..PARAMETERS {
            if scale[p] == 0.0 {
                information[(p, p)] = 1.0;
            }
        }
        let naive = information.try_inverse().unwrap_or_else(Square::identity);
        let sandwich = naive * variance * naive;
        let back = Square::from_fn(|p, q| scale[p] * scale[q]);
        Self { naive: naive.component_mul(&back), sandwich: sandwich.component_mul(&back) }
    }

    /// Factor of the rise of the deviance along a parameter, against χ².
    pub(super) fn factor(&self, parameter: usize) -> f64 {
        let factor = self.sandwich[(parameter, parameter)] / self.naive[(parameter, parameter)];
        if factor > 0.0 && factor.is_finite() { factor } else { 1.0 }
    }

    /// Covariance of the squared coefficients.
    pub(super) fn covariance(&self) -> [[f64; TERMS]; TERMS] {
        core::array::from_fn(|p| core::array::from_fn(|q| self.sandwich[(p, q)]))
    }

    /// Mean and variance of the deviance if the model is true.
    pub(super) fn deviance(
        &self,
        rows: &Rows,
        covariances: &Covariances,
        model: &Model,
    ) -> (f64, f64) {
        let terms = rows.terms(model.time_s);
        let mean =
            |i: usize| -> f64 { terms[i].iter().zip(&model.squares).map(|(a, b)| a * b).sum() };
        let mut sum = 0.0;
        for (i, a) in rows.all.iter().enumerate() {
            for (j, b) in rows.all.iter().enumerate() {
                let shared = covariances.at(a.number, b.number, &model.squares);
                let part = 0.5 * shared * libm::sqrt(a.freedom * b.freedom) / (mean(i) * mean(j));
                sum += 2.0 * part * part;
            }
        }
        let fitted = (0..PARAMETERS).filter(|p| self.naive[(*p, *p)] > 0.0).count() as f64;
        let left = (rows.len() as f64 - fitted).max(1.0);
        (left, sum * left / rows.len() as f64)
    }
}
