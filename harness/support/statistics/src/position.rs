//! Position errors of many runs at one time: CEP50, R95, drms.

use crate::quantile;
use crate::sample::{ConfidenceInterval, percentile, rms};
use serde::{Deserialize, Serialize};

/// Circular error probable of a Gaussian error, 0.5887 (σ_lat + σ_lon): accurate within 3 % if one σ is
/// at most twice the other.
#[must_use]
pub fn cep50(sigma_latitude: f64, sigma_longitude: f64) -> f64 {
    0.5887 * (sigma_latitude + sigma_longitude)
}

/// Statistics of an ensemble of position errors, in the unit of the errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PositionStatistics {
    /// 0.5887 (σ_lat + σ_lon), σ about zero: a common offset counts as an error.
    pub cep50_gaussian: f64,
    /// Median of the radial errors.
    pub cep50_empirical: f64,
    /// 95th percentile of the radial errors.
    pub r95: f64,
    /// Square root of the mean squared radial error.
    pub drms: f64,
}

/// Radial errors of north and east errors.
#[must_use]
pub fn radial(north_east: &[[f64; 2]]) -> Vec<f64> {
    north_east.iter().map(|e| libm::sqrt(e[0] * e[0] + e[1] * e[1])).collect()
}

/// Statistics of the north and east errors of an ensemble at one time; `None` without errors.
#[must_use]
pub fn position_statistics(north_east: &[[f64; 2]]) -> Option<PositionStatistics> {
    let column = |i: usize| north_east.iter().map(|e| e[i]).collect::<Vec<_>>();
    let radial = radial(north_east);
    Some(PositionStatistics {
        cep50_gaussian: cep50(rms(&column(0))?, rms(&column(1))?),
        cep50_empirical: percentile(&radial, 0.5)?,
        r95: percentile(&radial, 0.95)?,
        drms: rms(&radial)?,
    })
}

/// CEP50 and R95 with their distribution-free two-sided intervals ([`quantile::interval`]).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PositionBounds {
    /// Median of the radial errors.
    pub cep50: ConfidenceInterval,
    /// 95th percentile of the radial errors.
    pub r95: ConfidenceInterval,
}

/// Bounds of CEP50 and R95 with this confidence; `None` without errors.
#[must_use]
pub fn position_bounds(north_east: &[[f64; 2]], confidence: f64) -> Option<PositionBounds> {
    let radial = radial(north_east);
    Some(PositionBounds {
        cep50: quantile::interval(&radial, 0.5, confidence)?,
        r95: quantile::interval(&radial, 0.95, confidence)?,
    })
}
