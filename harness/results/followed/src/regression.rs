//! Normal equations of a regression on some regressors of which one is wanted at a time, with nuisance, over blocks of
//! rows from which a line in time is taken.

/// Sums of products of N columns: nuisance first, then the regressors, then the response.
#[derive(Clone, Debug)]
pub struct Normal<const N: usize> {
    sums: [[f64; N]; N],
    /// Number of rows, less the lines that were taken from them.
    free: u64,
}

/// Largest number of rows in a block.
pub const BLOCK: usize = 12;
/// Smallest number of rows from which a line is taken.
const BLOCK_LEAST: usize = 4;

/// Rows that follow each other in time. What changes slowly isn't the noise of the samples: a line in time is taken from
/// each column of a block before it enters the regression.
#[derive(Clone, Debug)]
pub struct Block<const N: usize> {
    rows: [[f64; N]; BLOCK],
    filled: usize,
    full: usize,
}

impl<const N: usize> Block<N> {
    /// Creates blocks of this number of rows.
    #[must_use]
    pub fn of(full: usize) -> Self {
        Self { rows: [[0.0; N]; BLOCK], filled: 0, full: full.clamp(BLOCK_LEAST, BLOCK) }
    }

    /// Takes a row; a full block goes to the regression.
    pub fn push(&mut self, row: &[f64; N], to: &mut Normal<N>) {
        self.rows[self.filled] = *row;
        self.filled += 1;
        if self.filled == self.full {
            self.end(to);
        }
    }

    /// Ends a block, which goes to the regression if a line in it leaves something.
    pub fn end(&mut self, to: &mut Normal<N>) {
        let filled = std::mem::take(&mut self.filled);
        if filled < BLOCK_LEAST {
            return;
        }
        let rows = &mut self.rows[..filled];
        let count = filled as f64;
        let time = |row: usize| row as f64 - 0.5 * (count - 1.0);
        let squares = count * (count * count - 1.0) / 12.0;
        for column in 0..N {
            let (mut mean, mut slope) = (0.0, 0.0);
            for (k, row) in rows.iter().enumerate() {
                mean += row[column] / count;
                slope += row[column] * time(k) / squares;
            }
            for (k, row) in rows.iter_mut().enumerate() {
                row[column] -= mean + slope * time(k);
            }
        }
        rows.iter().for_each(|row| to.add(row));
        to.free += filled as u64 - 2;
    }
}

/// Result of a regression on one regressor and the nuisance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// Slope on the regressor.
    pub value: f64,
    /// Its standard deviation, from the residuals.
    pub sigma: f64,
    /// Root mean square of the regressor, with what the nuisance explains taken away.
    pub regressor_rms: f64,
    /// Root mean square of the residuals.
    pub residual_rms: f64,
}

/// Share of a column's square sum below which the columns before explain it.
const DEPENDENT: f64 = 1e-9;

impl<const N: usize> Default for Normal<N> {
    fn default() -> Self {
        Self { sums: [[0.0; N]; N], free: 0 }
    }
}

impl<const N: usize> Normal<N> {
    /// Takes a row by itself.
    pub fn push(&mut self, row: &[f64; N]) {
        self.free += 1;
        self.add(row);
    }

    fn add(&mut self, row: &[f64; N]) {
        for (i, sums) in self.sums.iter_mut().enumerate() {
            // Lags that are longer than the window.
            if row[i] == 0.0 {
                continue;
            }
            for (sum, value) in sums[i..].iter_mut().zip(&row[i..]) {
                *sum += row[i] * value;
            }
        }
    }

    /// Regresses column `response` on column `of` before it and the first `nuisance` ones; `None` where the rows don't
    /// suffice or the nuisance explains the regressor.
    #[must_use]
    pub fn slope(&self, nuisance: usize, of: usize, response: usize) -> Option<Slope> {
        // Sweeps the nuisance out of the two columns that are left.
        let (mut m, mut rank) = (self.sums, 0);
        for pivot in 0..nuisance {
            let size = m[pivot][pivot];
            if !(size > DEPENDENT * self.sums[pivot][pivot]) {
                continue;
            }
            rank += 1;
            let row = m[pivot];
            let columns = || (pivot + 1..nuisance).chain([of, response]);
            for i in columns() {
                let factor = row[i] / size;
                for j in columns().filter(|j| *j >= i) {
                    m[i][j] -= factor * row[j];
                }
            }
        }
        let (own, with, all) = (m[of][of], m[of][response], m[response][response]);
        let free = self.free.checked_sub(rank + 1).filter(|free| *free > rank)? as f64;
        if !(own > DEPENDENT * self.sums[of][of]) {
            return None;
        }
        let value = with / own;
        let residual = (all - value * with).max(0.0) / free;
        Some(Slope {
            value,
            sigma: libm::sqrt(residual / own),
            regressor_rms: libm::sqrt(own / self.free as f64),
            residual_rms: libm::sqrt(residual),
        })
    }
}
