//! Correlations of factors, defined by their normal scores.

use super::distribution::Factor;
use super::error::DrawError;
use crate::normal;
use crate::sample::ranks;
use serde::{Deserialize, Serialize};

/// Correlation of two factors: that of the Gaussian copula that joins them. For normal factors it is
/// their own correlation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FactorCorrelation {
    /// First factor.
    pub first: String,
    /// Second factor.
    pub second: String,
    /// Value above −1 and below 1.
    pub value: f64,
}

/// Correlated factors, with the lower triangular root of their matrix.
#[derive(Clone, Debug)]
pub struct Correlations {
    /// Indices of the factors, in ascending order.
    columns: Vec<usize>,
    /// Root L with L Lᵀ = C.
    root: Vec<Vec<f64>>,
}

/// Lower triangular root L with L Lᵀ = `matrix`; the error is the row at which it isn't positive
/// definite.
fn cholesky(matrix: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, usize> {
    let n = matrix.len();
    let mut root = vec![vec![0.0; n]; n];
    for i in 0..n {
        for j in 0..=i {
            let dot: f64 = (0..j).map(|k| root[i][k] * root[j][k]).sum();
            let rest = matrix[i][j] - dot;
            if i == j {
                // A rounding residue of an exact 0 isn't positive.
                if !(rest > 1e-12) {
                    return Err(i);
                }
                root[i][i] = libm::sqrt(rest);
            } else {
                root[i][j] = rest / root[j][j];
            }
        }
    }
    Ok(root)
}

impl Correlations {
    /// Makes the correlations of these factors.
    ///
    /// # Errors
    /// If a correlation names an unknown factor, a choice, the same factor twice or a pair a second
    /// time, if a value isn't between −1 and 1, or if the matrix isn't positive definite.
    pub fn new(factors: &[Factor], correlations: &[FactorCorrelation]) -> Result<Self, DrawError> {
        let mut columns: Vec<usize> = Vec::new();
        let mut pairs: Vec<(usize, usize, f64)> = Vec::new();
        for correlation in correlations {
            let wrong = |message: String| DrawError::Correlation {
                first: correlation.first.clone(),
                second: correlation.second.clone(),
                message,
            };
            let at = |name: &str| match factors.iter().position(|f| f.name == name) {
                None => Err(wrong(format!("there is no factor {name}"))),
                Some(at) if factors[at].is_choice() => {
                    Err(wrong(format!("{name} is a choice, which has no order")))
                }
                Some(at) => Ok(at),
            };
            let (a, b) = (at(&correlation.first)?, at(&correlation.second)?);
            let (a, b) = (a.min(b), a.max(b));
            if a == b {
                return Err(wrong("a factor is correlated with itself".to_owned()));
            }
            if !(correlation.value > -1.0 && correlation.value < 1.0) {
                let found = format!("found {}", correlation.value);
                return Err(wrong(format!("{found}, expected more than -1 and less than 1")));
            }
            if pairs.iter().any(|(i, j, _)| (*i, *j) == (a, b)) {
                return Err(wrong("it is there a second time".to_owned()));
            }
            pairs.push((a, b, correlation.value));
            columns.extend([a, b]);
        }
        columns.sort_unstable();
        columns.dedup();
        let n = columns.len();
        let mut matrix = vec![vec![0.0; n]; n];
        for i in 0..n {
            matrix[i][i] = 1.0;
        }
        for (a, b, value) in pairs {
            let place = |of: usize| columns.partition_point(|column| *column < of);
            matrix[place(a)][place(b)] = value;
            matrix[place(b)][place(a)] = value;
        }
        let name = |at: usize| factors[columns[at]].name.clone();
        let root = cholesky(&matrix).map_err(|at| DrawError::NotPositiveDefinite {
            factors: (0..n).map(name).collect(),
            breaks_at: name(at),
        })?;
        Ok(Self { columns, root })
    }

    /// Correlates independent probabilities: through their normal scores, by the root of the matrix.
    pub fn apply(&self, units: &mut [f64]) {
        let scores: Vec<f64> = self.columns.iter().map(|at| normal::quantile(units[*at])).collect();
        for (row, at) in self.columns.iter().enumerate().skip(1) {
            let score: f64 = (0..=row).map(|k| self.root[row][k] * scores[k]).sum();
            // Never exactly 0 or 1, at which a distribution has no value.
            units[*at] = normal::cdf(score).clamp(f64::MIN_POSITIVE, 1.0 - f64::EPSILON / 2.0);
        }
    }

    /// Rearranges columns of probabilities so that they are correlated.
    pub(super) fn rearrange(&self, columns: &mut [Vec<f64>]) -> Result<(), DrawError> {
        let k = self.columns.len();
        let runs = columns.first().map_or(0, Vec::len);
        if k == 0 {
            return Ok(());
        }
        let few = DrawError::Runs { found: runs, expected: k + 2 };
        if runs < k + 2 {
            return Err(few);
        }
        // Van der Waerden scores in the order of the columns.
        let scores: Vec<Vec<f64>> = self
            .columns
            .iter()
            .map(|at| {
                let ranks = ranks(&columns[*at]);
                ranks.iter().map(|r| normal::quantile(r / (runs + 1) as f64)).collect()
            })
            .collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        // All columns have the same scores with mean 0, so the products give the correlations.
        let square = dot(&scores[0], &scores[0]);
        let found: Vec<Vec<f64>> = (0..k)
            .map(|i| (0..k).map(|j| dot(&scores[i], &scores[j]) / square).collect())
            .collect();
        let found = cholesky(&found).map_err(|_| few)?;
        let mut wanted = vec![vec![0.0; runs]; k];
        for run in 0..runs {
            // The chance correlation is removed first, then the wanted one is applied.
            let mut free = vec![0.0; k];
            for i in 0..k {
                let known: f64 = (0..i).map(|j| found[i][j] * free[j]).sum();
                free[i] = (scores[i][run] - known) / found[i][i];
                wanted[i][run] = (0..=i).map(|j| self.root[i][j] * free[j]).sum();
            }
        }
        for (wanted, at) in wanted.iter().zip(&self.columns) {
            let mut sorted = columns[*at].clone();
            sorted.sort_by(f64::total_cmp);
            let mut order: Vec<usize> = (0..runs).collect();
            order.sort_by(|a, b| wanted[*a].total_cmp(&wanted[*b]));
            for (value, run) in sorted.into_iter().zip(order) {
                columns[*at][run] = value;
            }
        }
        Ok(())
    }
}
