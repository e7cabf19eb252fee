//! The 39 × 39 error covariance and its kernels.
//!
//! Only the first nine states (φ, δv, δr) change; the thirty parameters are constants. So the
//! transition is `[A B; 0 I]` with nine rows, and propagation costs 9/39 of a full product. All
//! loops have fixed bounds and one order of operations: the same bits everywhere.

/// Number of error states: φ 3, δv 3, δr 3 and thirty parameters.
pub const STATE_COUNT: usize = 39;
/// Number of states with dynamics: φ, δv, δr.
pub const MOVING: usize = 9;
/// Row length in memory, a multiple of the vector registers' width.
const ROW: usize = 40;

/// Index of φ north; east and down follow.
pub const PHI: usize = 0;
/// Index of δv north.
pub const DV: usize = 3;
/// Index of δr north.
pub const DR: usize = 6;
/// Index of the first parameter.
pub const PARAMETERS: usize = 9;

/// One padded row of a matrix over the states.
pub type CovarianceRow = [f64; ROW];

/// The nine moving rows of a transition matrix, `[A B]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Transition {
    /// Rows of φ, δv, δr.
    pub rows: [CovarianceRow; MOVING],
}

#[cfg(feature = "state")]
impl octant_state::State for Transition {
    fn save(&self, to: &mut octant_state::Writer) {
        save_rows(&self.rows, to);
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        load_rows(&mut self.rows, from)
    }
}

/// Serde form of a row: serde has no arrays of forty, so a row is five of eight.
#[cfg(feature = "state")]
type Eights = [[f64; 8]; ROW / 8];

#[cfg(feature = "state")]
pub(crate) fn save_rows(rows: &[CovarianceRow], to: &mut octant_state::Writer) {
    for row in rows {
        let eights: Eights = core::array::from_fn(|i| core::array::from_fn(|j| row[8 * i + j]));
        to.value("row", &eights);
    }
}

#[cfg(feature = "state")]
pub(crate) fn load_rows(
    rows: &mut [CovarianceRow],
    from: &mut octant_state::StateReader<'_>,
) -> Result<(), octant_state::StateError> {
    for row in rows {
        let eights: Eights = from.value("row")?;
        row.copy_from_slice(eights.as_flattened());
    }
    Ok(())
}

impl Transition {
    /// The identity.
    #[must_use]
    pub fn identity() -> Self {
        let mut rows = [[0.0; ROW]; MOVING];
        for (i, row) in rows.iter_mut().enumerate() {
            row[i] = 1.0;
        }
        Self { rows }
    }
}

/// Covariance of attitude and velocity at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolutionCovariance {
    /// Covariance of φ in n (north, east, down), rad².
    pub phi: [[f64; 3]; 3],
    /// Standard deviation of the velocity in n (north, east, down), m/s.
    pub velocity_mps: [f64; 3],
}

/// Symmetric covariance, stored in full.
#[derive(Clone, Debug, PartialEq)]
pub struct Covariance {
    p: [CovarianceRow; STATE_COUNT],
}

#[cfg(feature = "state")]
impl octant_state::State for Covariance {
    fn save(&self, to: &mut octant_state::Writer) {
        save_rows(&self.p, to);
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        load_rows(&mut self.p, from)
    }
}

impl Covariance {
    /// Makes a diagonal covariance from standard deviations.
    #[must_use]
    pub fn from_sigmas(sigmas: &[f64; STATE_COUNT]) -> Self {
        let mut p = [[0.0; ROW]; STATE_COUNT];
        for (i, sigma) in sigmas.iter().enumerate() {
            p[i][i] = sigma * sigma;
        }
        Self { p }
    }

    /// Element (i, j).
    #[must_use]
    #[inline]
    pub fn at(&self, i: usize, j: usize) -> f64 {
        self.p[i][j]
    }

    /// Rows of the matrix, each padded to the length of a [`CovarianceRow`] with zeros.
    #[must_use]
    pub fn rows(&self) -> &[CovarianceRow; STATE_COUNT] {
        &self.p
    }

    /// The same to be changed. The matrix has to stay symmetric, and its padding zero.
    pub fn rows_mut(&mut self) -> &mut [CovarianceRow; STATE_COUNT] {
        &mut self.p
    }

    /// Standard deviation of state `i`.
    #[must_use]
    pub fn sigma(&self, i: usize) -> f64 {
        libm::sqrt(self.p[i][i].max(0.0))
    }

    /// Covariance of attitude and velocity.
    #[must_use]
    pub fn solution(&self) -> SolutionCovariance {
        SolutionCovariance {
            phi: core::array::from_fn(|i| core::array::from_fn(|j| self.at(PHI + i, PHI + j))),
            velocity_mps: core::array::from_fn(|i| self.sigma(DV + i)),
        }
    }

    /// Adds to elements (i, j) and (j, i).
    #[inline]
    pub fn add(&mut self, i: usize, j: usize, value: f64) {
        self.p[i][j] += value;
        if i != j {
            self.p[j][i] += value;
        }
    }

    /// Propagates: `P ← Φ P Φᵀ`.
    pub fn propagate(&mut self, transition: &Transition) {
        let phi = &transition.rows;
        let mut w = [[0.0; ROW]; MOVING];
        for (w_row, phi_row) in w.iter_mut().zip(phi) {
            for (k, p_row) in self.p.iter().enumerate() {
                let factor = phi_row[k];
                for (out, p) in w_row.iter_mut().zip(p_row) {
                    *out += factor * p;
                }
            }
        }
        for i in 0..MOVING {
            for j in i..MOVING {
                // Four partial sums: a fixed order that the compiler can vectorize.
                let mut sums = [0.0; 4];
                for (a, b) in w[i].chunks_exact(4).zip(phi[j].chunks_exact(4)) {
                    for lane in 0..4 {
                        sums[lane] += a[lane] * b[lane];
                    }
                }
                let value = (sums[0] + sums[1]) + (sums[2] + sums[3]);
                self.p[i][j] = value;
                self.p[j][i] = value;
            }
        }
        for i in 0..MOVING {
            self.p[i][MOVING..STATE_COUNT].copy_from_slice(&w[i][MOVING..STATE_COUNT]);
            for j in MOVING..STATE_COUNT {
                self.p[j][i] = w[i][j];
            }
        }
    }

    /// Optimal update by a direct measurement of state `s` with variance `r`; `x` is the estimate of
    /// the error states, `innovation` the measurement minus `x[s]`.
    pub fn update(&mut self, s: usize, r: f64, innovation: f64, x: &mut [f64; STATE_COUNT]) {
        let (row, scale) = self.gain_row(s, r);
        let scaled = row.map(|value| value * scale);
        for (i, p_row) in self.p.iter_mut().enumerate() {
            for (p, u) in p_row.iter_mut().zip(&scaled) {
                *p -= scaled[i] * u;
            }
        }
        for (x, p) in x.iter_mut().zip(&row) {
            *x += p * (scale * scale * innovation);
        }
    }

    /// Updates as [`Self::update`], but the parameters are considered, not estimated (Schmidt):
    /// they keep value and covariance, while their correlation with the moving states stays
    /// correct.
    pub fn update_moving(&mut self, s: usize, r: f64, innovation: f64, x: &mut [f64; STATE_COUNT]) {
        let (row, scale) = self.gain_row(s, r);
        let scaled = row.map(|value| value * scale);
        for i in 0..MOVING {
            for j in 0..STATE_COUNT {
                self.p[i][j] -= scaled[i] * scaled[j];
            }
        }
        for i in MOVING..STATE_COUNT {
            for j in 0..MOVING {
                self.p[i][j] -= scaled[i] * scaled[j];
            }
        }
        for (x, p) in x[..MOVING].iter_mut().zip(&row) {
            *x += p * (scale * scale * innovation);
        }
    }

    /// Subtracts the square of a normalized gain; `held`: the parameters keep their covariance, as in
    /// [`Self::update_moving`].
    pub fn subtract_square(&mut self, gain: &CovarianceRow, held: bool) {
        for (i, p_row) in self.p.iter_mut().enumerate() {
            let end = if held && i >= MOVING { MOVING } else { ROW };
            for (p, u) in p_row[..end].iter_mut().zip(gain) {
                *p -= gain[i] * u;
            }
        }
    }

    /// Updates the true covariance by the gain of another filter, `P ← (I − K h) P (I − K h)ᵀ + K r
    /// Kᵀ` (Joseph form, valid for any gain): the real performance of a filter with too few states.
    pub fn update_with_gain(&mut self, s: usize, r: f64, gain: &[f64; STATE_COUNT]) {
        let row = self.p[s];
        let variance = row[s] + r;
        for i in 0..STATE_COUNT {
            for j in 0..STATE_COUNT {
                self.p[i][j] += gain[i] * gain[j] * variance - gain[i] * row[j] - row[i] * gain[j];
            }
        }
    }

    /// Gain of a direct measurement of state `s` with variance `r`.
    #[must_use]
    pub fn gain(&self, s: usize, r: f64) -> [f64; STATE_COUNT] {
        core::array::from_fn(|i| self.p[s][i] / (self.p[s][s] + r))
    }

    /// Row `s` and 1/√(P_ss + r).
    pub(crate) fn gain_row(&self, s: usize, r: f64) -> (CovarianceRow, f64) {
        let row = self.p[s];
        (row, 1.0 / libm::sqrt(row[s] + r))
    }

    /// Reopens state `i`: zero cross terms and the given standard deviation.
    pub fn reopen(&mut self, i: usize, sigma: f64) {
        for j in 0..STATE_COUNT {
            self.p[i][j] = 0.0;
            self.p[j][i] = 0.0;
        }
        self.p[i][i] = sigma * sigma;
    }

    /// Returns whether every element is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.p.iter().flatten().all(|value| value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SMatrix;

    type Full = SMatrix<f64, STATE_COUNT, STATE_COUNT>;

    /// Numbers without a pattern, the same on every run.
    fn scatter(i: usize, j: usize) -> f64 {
        let n = (i * 7919 + j * 104_729 + 13) % 1009;
        n as f64 / 1009.0 - 0.5
    }

    fn example() -> (Covariance, Full) {
        let a = Full::from_fn(scatter);
        let full = a * a.transpose() + Full::identity();
        let mut p = Covariance::from_sigmas(&[0.0; STATE_COUNT]);
        for i in 0..STATE_COUNT {
            for j in i..STATE_COUNT {
                p.add(i, j, full[(i, j)]);
            }
        }
        (p, full)
    }

    fn assert_equal(p: &Covariance, full: &Full) {
        for i in 0..STATE_COUNT {
            for j in 0..STATE_COUNT {
                assert!((p.at(i, j) - full[(i, j)]).abs() < 1e-10, "element {i}, {j}");
            }
        }
    }

    #[test]
    fn propagation_is_the_full_product() {
        let (mut p, full) = example();
        let mut transition = Transition::identity();
        let mut phi = Full::identity();
        for i in 0..MOVING {
            for j in 0..STATE_COUNT {
                let value = scatter(j + 3, i) + f64::from(u8::from(i == j));
                transition.rows[i][j] = value;
                phi[(i, j)] = value;
            }
        }
        p.propagate(&transition);
        assert_equal(&p, &(phi * full * phi.transpose()));
    }

    #[test]
    fn update_is_the_textbook_one_and_its_joseph_form() {
        let (mut p, full) = example();
        let (mut joseph, _) = example();
        let (s, r) = (4, 0.3);
        let gain = p.gain(s, r);
        let mut x = [0.0; STATE_COUNT];
        p.update(s, r, 2.0, &mut x);
        let k = full.column(s) / (full[(s, s)] + r);
        assert_equal(&p, &(full - k * full.row(s)));
        joseph.update_with_gain(s, r, &gain);
        assert_equal(&joseph, &(full - k * full.row(s)));
        for i in 0..STATE_COUNT {
            assert!((x[i] - 2.0 * k[i]).abs() < 1e-12);
        }
    }

    #[test]
    fn a_considered_update_is_the_joseph_form_with_no_gain_for_the_parameters() {
        let (mut p, _) = example();
        let (mut joseph, _) = example();
        let (s, r) = (5, 0.7);
        let mut gain = p.gain(s, r);
        gain[MOVING..].fill(0.0);
        p.update_moving(s, r, 1.0, &mut [0.0; STATE_COUNT]);
        joseph.update_with_gain(s, r, &gain);
        for i in 0..STATE_COUNT {
            for j in 0..STATE_COUNT {
                assert!((p.at(i, j) - joseph.at(i, j)).abs() < 1e-10, "element {i}, {j}");
            }
        }
    }
}
