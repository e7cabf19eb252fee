//! What the standard deviations that a reference states leave open of the largest, mean and last errors.

/// Standard deviations in an expanded uncertainty (95 %).
pub(crate) const EXPANDED: f64 = 1.96;

/// Uncertainty of one error by the reference's own standard deviations, as far as it has some.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StatedBand {
    points: u64,
    square: f64,
    /// Largest magnitude; of magnitude and uncertainty together; of their difference.
    max: f64,
    max_with: f64,
    max_without: f64,
    /// Largest uncertainty, and the last one.
    largest: f64,
    last: f64,
}

impl StatedBand {
    /// Takes an error and the standard deviation of its reference.
    pub(crate) fn push(&mut self, error: f64, sigma: f64) {
        let (size, uncertainty) = (error.abs(), EXPANDED * sigma);
        self.points += 1;
        self.square += uncertainty * uncertainty;
        self.max = self.max.max(size);
        self.max_with = self.max_with.max(size + uncertainty);
        self.max_without = self.max_without.max(size - uncertainty);
        self.largest = self.largest.max(uncertainty);
        self.last = uncertainty;
    }

    /// Expanded uncertainty (95 %) of a score of these errors by its name: `max`, `rms`, `final`; of others the largest one. For
    /// a maximum it is that with which the true one can't be on the other side of a limit that is so far away: each error
    /// has the uncertainty of its own time. `None`: the reference states none.
    #[must_use]
    pub fn of(&self, score: &str) -> Option<f64> {
        if self.points == 0 {
            return None;
        }
        Some(match score {
            "max" => (self.max - self.max_without).max(self.max_with - self.max),
            "rms" => libm::sqrt(self.square / self.points as f64),
            "final" => self.last,
            _ => self.largest,
        })
    }

    /// Root mean square of the standard deviations.
    #[must_use]
    pub fn sigma(&self) -> Option<f64> {
        let rms = libm::sqrt(self.square / self.points as f64) / EXPANDED;
        (self.points > 0).then_some(rms)
    }
}
