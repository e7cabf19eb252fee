//! Whether a filter's innovations are white, as its noise of measurement is.
//!
//! A filter that takes the sway of a ship for white noise of its reference has innovations that follow the sway. Its
//! σ count each of them as news.

use octant_sample::{Innovation, InnovationOf};

/// Square of a whitened innovation, three axes, above which the filter doesn't use it.
const OUTLIER: f64 = 25.0;
/// Smallest number of pairs for a statement.
const PAIRS_LEAST: u64 = 100;
/// Number of earlier innovations with which one is compared. A sway whose period is four times that of the reference has
/// no correlation with the one before, but with that before it.
const LAGS: usize = 4;
/// Magnitude of a correlation from which innovations aren't white. Of a hundred white pairs on three axes it is 0.06 (1σ).
const CORRELATED: f64 = 0.3;
/// Mean NIS on three axes from which the σ of a filter are too small to be believed.
const NIS_MAX: f64 = 3.5;

/// Correlations of innovations with those before them.
#[derive(Clone, Debug, Default)]
pub struct Whiteness {
    /// Whitened innovations in a row, the last one first.
    last: [[f64; 3]; LAGS],
    in_a_row: usize,
    products: [f64; LAGS],
    squares: [f64; LAGS],
    pairs: [u64; LAGS],
}

impl Whiteness {
    /// Takes the innovation of the next measurement.
    pub fn push(&mut self, innovation: &Innovation) {
        let whitened: [f64; 3] =
            std::array::from_fn(|axis| innovation.value[axis] / innovation.sigma[axis]);
        let square: f64 = whitened.iter().map(|z| z * z).sum();
        if innovation.of != InnovationOf::Position || !(square <= OUTLIER) {
            self.in_a_row = 0;
            return;
        }
        for lag in 0..self.in_a_row {
            self.products[lag] +=
                (0..3).map(|axis| self.last[lag][axis] * whitened[axis]).sum::<f64>();
            self.squares[lag] += square;
            self.pairs[lag] += 1;
        }
        self.last.rotate_right(1);
        self.last[0] = whitened;
        self.in_a_row = LAGS.min(self.in_a_row + 1);
    }

    /// Largest correlation in magnitude of innovations of a position with earlier ones, and how many measurements lie
    /// between; `None` before there are enough.
    #[must_use]
    pub fn correlation(&self) -> Option<(f64, usize)> {
        (0..LAGS)
            .filter(|lag| self.pairs[*lag] >= PAIRS_LEAST && self.squares[*lag] > 0.0)
            .map(|lag| (self.products[lag] / self.squares[lag], lag + 1))
            .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
    }

    /// Says that the sway isn't the white noise that the filter takes it for, where innovations of this mean NIS
    /// show it.
    #[must_use]
    pub fn doubt(&self, nis_mean: f64) -> Option<String> {
        let (correlation, lag) =
            self.correlation().filter(|(found, _)| found.abs() >= CORRELATED)?;
        (nis_mean > NIS_MAX).then(|| {
            format!(
                "the sway isn't the white noise that the filter takes it for: innovations follow earlier ones \
                 (correlation {correlation:.2} with the one {lag} measurements before, expected 0), their mean NIS is {nis_mean:.2}, expected 3, and the \
                 published uncertainties are too small. procedure.calibration.aiding.sway = \"coloured\" estimates the sway"
            )
        })
    }
}
