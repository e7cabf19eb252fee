//! Straight line through all stamps, for the rate over the whole and its uncertainty.

/// Rate and scatter of the stamps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampRate {
    /// Rate by the stamps, Hz.
    pub hz: f64,
    /// Difference from the configured rate, ppm.
    pub ppm: f64,
    /// Standard deviation of that, ppm: of white scatter.
    pub sigma_ppm: f64,
    /// Standard deviation of the stamps about the fit, s.
    pub scatter_s: f64,
    /// Largest distance of a stamp from the fit, s.
    pub scatter_max_s: f64,
}

/// Sums of a regression of stamps on the count of readings, about their means (Welford's updates).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Regression {
    n: f64,
    /// Mean count, and mean distance of the stamps from the nominal rate, ns.
    count: f64,
    late_ns: f64,
    /// Sums of squares and of the product.
    count2: f64,
    late2: f64,
    both: f64,
}

impl Regression {
    /// Adds a stamp with its count.
    #[inline]
    pub(super) fn add(&mut self, count: f64, stamp_ns: u64, origin_ns: u64, nominal_ns: f64) {
        let since = (i128::from(stamp_ns) - i128::from(origin_ns)) as f64;
        let late_ns = since - count * nominal_ns;
        self.n += 1.0;
        let (dc, dl) = (count - self.count, late_ns - self.late_ns);
        self.count += dc / self.n;
        self.late_ns += dl / self.n;
        self.count2 += dc * (count - self.count);
        self.late2 += dl * (late_ns - self.late_ns);
        self.both += dc * (late_ns - self.late_ns);
    }

    /// Rate of the stamps; `None` of fewer than three.
    pub(super) fn rate(&self, nominal_ns: f64, scatter_max_ns: f64) -> Option<StampRate> {
        if self.n < 3.0 || self.count2 <= 0.0 {
            return None;
        }
        let slope_ns = self.both / self.count2;
        let residual = (self.late2 - slope_ns * self.both).max(0.0) / (self.n - 2.0);
        let period_ns = nominal_ns + slope_ns;
        if period_ns <= 0.0 {
            return None;
        }
        let sigma_ns = libm::sqrt(residual / self.count2);
        Some(StampRate {
            hz: 1e9 / period_ns,
            ppm: -1e6 * slope_ns / period_ns,
            sigma_ppm: 1e6 * sigma_ns / period_ns,
            scatter_s: libm::sqrt(residual) * 1e-9,
            scatter_max_s: scatter_max_ns * 1e-9,
        })
    }
}
