//! Repeatability of the settle point over run-ups.

use crate::angle;
use crate::settle::SettlePoint;

/// Greatest difference of the settle points of any two run-ups, deg: of their errors, or of their headings where the true
/// heading isn't known. `None` with fewer than two run-ups, or if one of them has no settle point.
///
/// Differences of errors leave out a base that was turned between two run-ups.
#[must_use]
pub fn greatest_difference_deg(points: &[Option<SettlePoint>]) -> Option<f64> {
    let points: Vec<SettlePoint> = points.iter().copied().collect::<Option<_>>()?;
    if points.len() < 2 {
        return None;
    }
    let errors: Option<Vec<f64>> = points.iter().map(|point| point.error_deg).collect();
    let values = errors.unwrap_or_else(|| points.iter().map(|point| point.heading_deg).collect());
    angle::band(&values)
}
