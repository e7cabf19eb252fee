//! Radial error rate and time-RMS of one run, and their percentiles over runs.

use crate::quantile;
use crate::sample::{ConfidenceInterval, percentile};
use serde::{Deserialize, Serialize};

/// Radial error at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadialSample {
    /// Time since the start of the navigation, h.
    pub t_h: f64,
    /// Radial error, nmi.
    pub radial_nmi: f64,
}

/// Radial error rate, nmi/h: the slope of the regression of radial error on time through the origin, Σ
/// r t / Σ t². `None` without a sample after the start, or with one that isn't finite.
#[must_use]
pub fn radial_rate_nmi_per_h(samples: &[RadialSample]) -> Option<f64> {
    let (mut product, mut square) = (0.0, 0.0);
    for RadialSample { t_h, radial_nmi } in samples {
        product += radial_nmi * t_h;
        square += t_h * t_h;
    }
    let rate = product / square;
    rate.is_finite().then_some(rate)
}

/// Time-RMS, √(1/T ∫ r² dt), of a radial error with linear interpolation between samples, nmi: exact
/// for a ramp. `None` for fewer than two samples, or if time doesn't increase.
#[must_use]
pub fn time_rms_nmi(samples: &[RadialSample]) -> Option<f64> {
    let mut integral = 0.0;
    for pair in samples.windows(2) {
        let (a, b) = (pair[0].radial_nmi, pair[1].radial_nmi);
        let dt = pair[1].t_h - pair[0].t_h;
        if !(dt > 0.0) {
            return None;
        }
        integral += dt * (a * a + a * b + b * b) / 3.0;
    }
    let duration = samples.last()?.t_h - samples.first()?.t_h;
    let rms = libm::sqrt(integral / duration);
    rms.is_finite().then_some(rms)
}

/// 50th and 95th percentile of radial error rates (regression through the origin), nmi/h. The first one
/// names a class: 0.8 nmi/h CEP.
#[must_use]
pub fn radial_rates(rates_nmi_per_h: &[f64]) -> Option<[f64; 2]> {
    Some([percentile(rates_nmi_per_h, 0.5)?, percentile(rates_nmi_per_h, 0.95)?])
}

/// Radial error rates of many runs, nmi/h, with distribution-free intervals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RateBounds {
    /// Median.
    pub rate50: ConfidenceInterval,
    /// 95th percentile.
    pub rate95: ConfidenceInterval,
}

/// 50th and 95th percentile of rates with their intervals; `None` without rates.
#[must_use]
pub fn rate_bounds(rates_nmi_per_h: &[f64], confidence: f64) -> Option<RateBounds> {
    Some(RateBounds {
        rate50: quantile::interval(rates_nmi_per_h, 0.5, confidence)?,
        rate95: quantile::interval(rates_nmi_per_h, 0.95, confidence)?,
    })
}
