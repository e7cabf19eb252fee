//! Whether a filter's innovations are white, as its noise of measurement is.
//!
//! A filter that takes the sway of a ship for white noise of its reference has innovations that follow the sway. Its
//! σ count each of them as news.

use octant_sample::{Innovation, InnovationOf};

/// Square of a whitened innovation, three axes, above which the filter doesn't use it.
const OUTLIER: f64 = 25.0;
/// Smallest number of pairs for a statement.
const PAIRS_LEAST: u64 = 100;
/// Correlation from which innovations aren't white. Of a hundred white pairs on three axes it is 0.06 (1σ).
const CORRELATED: f64 = 0.3;
/// Mean NIS on three axes from which the σ of a filter are too small to be believed.
const NIS_MAX: f64 = 3.5;

/// Correlation of innovations with those before them.
#[derive(Clone, Debug, Default)]
pub struct Whiteness {
    last: Option<[f64; 3]>,
    products: f64,
    squares: f64,
    pairs: u64,
}

impl Whiteness {
    /// Takes the innovation of the next measurement.
    pub fn push(&mut self, innovation: &Innovation) {
        let whitened: [f64; 3] =
            std::array::from_fn(|axis| innovation.value[axis] / innovation.sigma[axis]);
        let square: f64 = whitened.iter().map(|z| z * z).sum();
        if innovation.of != InnovationOf::Position || !(square <= OUTLIER) {
            self.last = None;
            return;
        }
        if let Some(last) = self.last.replace(whitened) {
            self.products += (0..3).map(|axis| last[axis] * whitened[axis]).sum::<f64>();
            self.squares += square;
            self.pairs += 1;
        }
    }

    /// Correlation of successive innovations of a position; `None` before there are enough.
    #[must_use]
    pub fn correlation(&self) -> Option<f64> {
        (self.pairs >= PAIRS_LEAST && self.squares > 0.0).then(|| self.products / self.squares)
    }

    /// Says that the sway isn't the white noise that the filter takes it for, where innovations of this mean NIS
    /// show it.
    #[must_use]
    pub fn doubt(&self, nis_mean: f64) -> Option<String> {
        let correlation = self.correlation().filter(|correlation| *correlation >= CORRELATED)?;
        (nis_mean > NIS_MAX).then(|| {
            format!(
                "the sway isn't the white noise that the filter takes it for: innovations follow those before them \
                 (correlation {correlation:.2}, expected 0), their mean NIS is {nis_mean:.2}, expected 3, and the \
                 published uncertainties are too small. procedure.calibration.aiding.sway = \"coloured\" estimates the sway"
            )
        })
    }
}
