//! The mean NIS that is expected of one run of a filter with considered states.
//!
//! S has the variance that considered states give to innovations, so over runs whose errors are drawn as the filter considers
//! them the mean NIS is 3. In one run such an error has one value, and moves all innovations by it. With the innovation
//! `ν = ν₀ + Γ c`, c in units of their σ, and `Γ = cov(ν, c)`,
//!
//! ```text
//! E[νᵀ S⁻¹ ν | c] = 3 + cᵀ A c − tr A,   A = Γᵀ S⁻¹ Γ
//! ```
//!
//! because `S = S₀ + Γ Γᵀ`. The mean of A over the measurements says how the mean NIS follows from c, and how it scatters
//! from run to run where c is normal: a sum of χ² of one degree of freedom weighted by the eigenvalues of A, here by one χ²
//! with its mean and variance (Satterthwaite, 1946). A Gauss-Markov bias counts as a constant: it scatters less.

use super::border::{BORDER_COUNT, Border};
use crate::covariance::Covariance;
#[cfg(feature = "state")]
use crate::covariance::{load_rows, save_rows};
use nalgebra::{Matrix3, Vector3};

/// 97.5 % of a standard normal distribution are below it.
const NORMAL_975: f64 = 1.959_964;

/// Mean NIS that is expected of a run whose filter considers states: 95 % of runs are between the two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpectedNis {
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
}

/// Sum of A over measurements.
#[derive(Clone, Debug)]
pub(super) struct NisSpread {
    considered: [bool; BORDER_COUNT],
    rows: [[f64; BORDER_COUNT]; BORDER_COUNT],
    count: u64,
}

impl NisSpread {
    /// Makes an empty sum; `None` where no state is considered.
    pub(super) fn new(considered: [bool; BORDER_COUNT]) -> Option<Self> {
        considered.contains(&true).then_some(Self {
            considered,
            rows: [[0.0; BORDER_COUNT]; BORDER_COUNT],
            count: 0,
        })
    }

    /// Takes a measurement of the states from `first` on, before the update.
    pub(super) fn take(&mut self, border: &Border, errors: &Covariance, first: usize, r: f64) {
        let s = Matrix3::from_fn(|i, j| errors.at(first + i, first + j))
            + Matrix3::from_diagonal_element(r);
        let Some(inverse) = s.try_inverse() else { return };
        let mut effects = [Vector3::zeros(); BORDER_COUNT];
        let considered = self.considered;
        let states = (0..BORDER_COUNT).filter(|k| considered[*k]);
        for k in states.clone() {
            let (row, variance) = (&border.cross[k], border.own[k][k]);
            let effect = Vector3::new(row[first], row[first + 1], row[first + 2]);
            effects[k] = effect / libm::sqrt(variance.max(f64::MIN_POSITIVE));
        }
        for k in states.clone() {
            let weighted = inverse * effects[k];
            for l in states.clone() {
                self.rows[k][l] += weighted.dot(&effects[l]);
            }
        }
        self.count += 1;
    }

    /// Mean NIS that is expected of the run so far.
    pub(super) fn range(&self) -> ExpectedNis {
        let count = self.count.max(1) as f64;
        let (mut trace, mut square) = (0.0, 0.0);
        for (k, row) in self.rows.iter().enumerate() {
            trace += row[k] / count;
            square += row.iter().map(|a| a * a).sum::<f64>() / (count * count);
        }
        // The part of noise: three squares a measurement.
        let noise = NORMAL_975 * libm::sqrt(6.0 / count);
        let (mut low, mut high) = (0.0, 0.0);
        if square > 0.0 {
            let (scale, freedom) = (square / trace, trace * trace / square);
            low = scale * chi_square(freedom, -NORMAL_975) - trace;
            high = scale * chi_square(freedom, NORMAL_975) - trace;
        }
        ExpectedNis { low: 3.0 + low - noise, high: 3.0 + high + noise }
    }

    /// Mean NIS that is expected of the run so far where the states of the border have these values, in units of their σ.
    #[cfg(feature = "state")]
    pub(super) fn of(&self, values: &[f64]) -> f64 {
        let at = |k: usize| values.get(k).copied().unwrap_or(0.0);
        let mut mean = 3.0;
        for (k, row) in self.rows.iter().enumerate() {
            for (l, a) in row.iter().enumerate() {
                let drawn = if k == l { 1.0 } else { 0.0 };
                mean += a * (at(k) * at(l) - drawn) / self.count.max(1) as f64;
            }
        }
        mean
    }
}

/// Quantile of χ² with these degrees of freedom, where a standard normal variable has it at `z` (Wilson and Hilferty, 1931).
fn chi_square(freedom: f64, z: f64) -> f64 {
    let share = 2.0 / (9.0 * freedom);
    let root = (1.0 - share + z * libm::sqrt(share)).max(0.0);
    freedom * root * root * root
}

#[cfg(feature = "state")]
impl octant_state::State for NisSpread {
    fn save(&self, to: &mut octant_state::Writer) {
        let Self { considered: _, rows, count } = self;
        save_rows(rows, to);
        to.value("count", count);
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        load_rows(&mut self.rows, from)?;
        self.count = from.value("count")?;
        octant_state::check_count("nis self.count", self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::chi_square;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // 2.5 % and 97.5 % of χ² with 1, 3 and 10 degrees of freedom. The approximation is within 0.1, and 0.04 at the lower end.
        for (freedom, low, high) in
            [(1.0, 0.001, 5.024), (3.0, 0.216, 9.348), (10.0, 3.247, 20.483)]
        {
            assert!((chi_square(freedom, 1.959_964) - high).abs() < 0.11, "{freedom}");
            assert!((chi_square(freedom, -1.959_964) - low).abs() < 0.04, "{freedom}");
        }
    }
}
