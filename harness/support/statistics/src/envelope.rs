//! Percentile envelopes over time of many runs.

use crate::sample::of_sorted;
use serde::{Deserialize, Serialize};

/// Error of series that make no envelope.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EnvelopeError {
    /// No runs were given.
    #[error("make an envelope: there is no run")]
    Empty,
    /// A run has another grid.
    #[error("make an envelope: run {run} has {found} points, the grid has {expected}")]
    Length {
        /// Number of the run, from 0.
        run: usize,
        /// Number of its points.
        found: usize,
        /// Number of points of the grid.
        expected: usize,
    },
    /// A value is NaN.
    #[error("make an envelope: run {run} is not a number at point {point}")]
    NotANumber {
        /// Number of the run, from 0.
        run: usize,
        /// Index of the point, from 0.
        point: usize,
    },
}

/// Percentiles over runs at each point of a grid.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Envelope {
    /// The percentiles, 0 to 1.
    pub percentiles: Vec<f64>,
    /// One curve for each percentile.
    pub curves: Vec<Vec<f64>>,
}

/// Resamples a series of points, in order of x, on a grid by linear interpolation; `None` if the grid,
/// in ascending order, extends beyond the points, or there are no points.
#[must_use]
pub fn resampled(points: &[[f64; 2]], grid: &[f64]) -> Option<Vec<f64>> {
    let (first, last) = (points.first()?, points.last()?);
    let mut at = 0;
    grid.iter()
        .map(|x| {
            if !(first[0] <= *x && *x <= last[0]) {
                return None;
            }
            while at + 1 < points.len() && points[at + 1][0] < *x {
                at += 1;
            }
            let [x0, y0] = points[at];
            let [x1, y1] = points.get(at + 1).copied().unwrap_or(points[at]);
            let part = if x1 > x0 { (x - x0) / (x1 - x0) } else { 0.0 };
            Some(y0 + part * (y1 - y0))
        })
        .collect()
}

/// Exact percentiles of the runs' series on a common grid of `points`: all runs are used, with the
/// interpolation of [`crate::sample::percentile`] between order statistics.
///
/// # Errors
/// If there is no run, or one has another number of points or a NaN.
pub fn envelope<S: AsRef<[f64]>>(
    series: &[S],
    points: usize,
    percentiles: &[f64],
) -> Result<Envelope, EnvelopeError> {
    if series.is_empty() {
        return Err(EnvelopeError::Empty);
    }
    for (run, values) in series.iter().enumerate() {
        let values = values.as_ref();
        if values.len() != points {
            return Err(EnvelopeError::Length { run, found: values.len(), expected: points });
        }
        if let Some(point) = values.iter().position(|v| v.is_nan()) {
            return Err(EnvelopeError::NotANumber { run, point });
        }
    }
    let mut curves = vec![Vec::with_capacity(points); percentiles.len()];
    let mut column = Vec::with_capacity(series.len());
    for point in 0..points {
        column.clear();
        column.extend(series.iter().map(|values| values.as_ref()[point]));
        column.sort_by(f64::total_cmp);
        for (curve, p) in curves.iter_mut().zip(percentiles) {
            curve.extend(of_sorted(&column, *p));
        }
    }
    Ok(Envelope { percentiles: percentiles.to_vec(), curves })
}
