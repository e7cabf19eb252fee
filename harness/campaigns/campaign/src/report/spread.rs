//! Percentiles of a measure over many cases, with their intervals.

use octant_statistics::quantile::interval;
use octant_statistics::sample::{ConfidenceInterval, rms};
use serde::Serialize;

/// Default confidence of all intervals, two-sided.
pub const CONFIDENCE: f64 = 0.95;
/// Radial position errors of many cases, nmi.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Position {
    /// Number of cases that have it.
    pub cases: usize,
    /// Median.
    pub cep50: ConfidenceInterval,
    /// 95th percentile.
    pub r95: ConfidenceInterval,
    /// Root mean square.
    pub drms: f64,
}

impl Position {
    pub(super) fn of(radial_nmi: &[f64]) -> Option<Self> {
        Some(Self {
            cases: radial_nmi.len(),
            cep50: interval(radial_nmi, 0.5, CONFIDENCE)?,
            r95: interval(radial_nmi, 0.95, CONFIDENCE)?,
            drms: rms(radial_nmi)?,
        })
    }
}

/// Median and 95th percentile of a measure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Median.
    pub p50: ConfidenceInterval,
    /// 95th percentile.
    pub p95: ConfidenceInterval,
}

impl Spread {
    pub(super) fn of(values: &[f64]) -> Option<Self> {
        Some(Self {
            p50: interval(values, 0.5, CONFIDENCE)?,
            p95: interval(values, 0.95, CONFIDENCE)?,
        })
    }
}
