//! Percentiles of the errors over time: in the units of `statistics.json`, and in those of the page.

use super::curves::StoredCurve;
use octant_statistics::envelope::envelope;
use serde::Serialize;

/// Largest number of points of each curve that are in memory at a time.
const BLOCK: usize = 64;
/// Number of points of all curves together that are in memory at a time.
const VALUES: usize = 1 << 22;

/// Percentiles of the envelopes.
pub const PERCENTILES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// Percentiles of latitude and longitude error over time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EnvelopeFigures {
    /// Times, h.
    pub hours: Vec<f64>,
    /// Percentiles, 0 to 1.
    pub percentiles: Vec<f64>,
    /// Latitude error, arcmin: a curve for each percentile.
    pub latitude_arcmin: Vec<Vec<f64>>,
    /// Longitude error, arcmin.
    pub longitude_arcmin: Vec<Vec<f64>>,
}

impl EnvelopeFigures {
    /// Builds the envelope up to the end of the shortest navigation; `None` for navigations whose
    /// lengths differ so much that their grids differ.
    pub(super) fn of(curves: &[&StoredCurve], beyond: usize) -> Option<Self> {
        let curves: Vec<_> = curves.iter().map(|curve| (*curve, [1.0; 2])).collect();
        let ShownEnvelope { hours, latitude, longitude } = ShownEnvelope::of(&curves, beyond)?;
        let percentiles = PERCENTILES.to_vec();
        Some(Self { hours, percentiles, latitude_arcmin: latitude, longitude_arcmin: longitude })
    }
}

/// Percentiles of latitude and longitude error over time, in units of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct ShownEnvelope {
    /// Times, h.
    pub hours: Vec<f64>,
    /// Latitude error: a curve for each percentile.
    pub latitude: Vec<Vec<f64>>,
    /// Longitude error.
    pub longitude: Vec<Vec<f64>>,
}

impl ShownEnvelope {
    /// Builds the envelope of errors, each with the number of units in a minute of arc of latitude and of
    /// longitude at its site. The errors are converted first: where the sites differ, percentiles of
    /// distances aren't the distances of percentiles.
    pub(super) fn of(curves: &[(&StoredCurve, [f64; 2])], beyond: usize) -> Option<Self> {
        let step_s = curves.first()?.0.step_s;
        if curves.iter().any(|(curve, _)| curve.step_s != step_s) {
            return None;
        }
        let points = curves.iter().map(|(curve, _)| curve.points).min()?;
        // Some points of all curves at a time.
        let block = (VALUES / curves.len().max(1)).clamp(1, BLOCK);
        let of = |axis: usize| {
            let mut found = vec![Vec::with_capacity(points); PERCENTILES.len()];
            for from in (0..points).step_by(block) {
                let count = block.min(points - from);
                let one = |(curve, factors): &(&StoredCurve, [f64; 2])| {
                    let mut values = curve.read(axis, from, count)?;
                    values.iter_mut().for_each(|value| *value *= factors[axis]);
                    Some(values)
                };
                let all = curves.iter().map(one).collect::<Option<Vec<Vec<f64>>>>()?;
                let block = percentiles(&all, count, beyond)?;
                found.iter_mut().zip(block).for_each(|(curve, more)| curve.extend(more));
            }
            Some(found)
        };
        Some(Self {
            hours: (0..points).map(|k| k as f64 * step_s / 3600.0).collect(),
            latitude: of(0)?,
            longitude: of(1)?,
        })
    }
}

impl From<&EnvelopeFigures> for ShownEnvelope {
    /// Takes the percentiles as they are: in minutes of arc.
    fn from(figures: &EnvelopeFigures) -> Self {
        let EnvelopeFigures { hours, latitude_arcmin, longitude_arcmin, .. } = figures.clone();
        Self { hours, latitude: latitude_arcmin, longitude: longitude_arcmin }
    }
}

/// Percentiles of columns at each point, a curve for each of [`PERCENTILES`].
///
/// An error has a sign, and one beyond every number may have either: it counts as far below for
/// the percentiles under the median and as far above for those over it. The median of such a
/// sample isn't defined.
fn percentiles(all: &[Vec<f64>], points: usize, beyond: usize) -> Option<Vec<Vec<f64>>> {
    let with = |far: f64, percentiles: &[f64]| {
        let far = vec![far; points];
        let rest = std::iter::repeat_n(far.as_slice(), beyond);
        let all: Vec<&[f64]> = all.iter().map(Vec::as_slice).chain(rest).collect();
        envelope(&all, points, percentiles).ok()
    };
    let curve = |p: f64| match p.total_cmp(&0.5) {
        std::cmp::Ordering::Less => with(f64::NEG_INFINITY, &[p])?.curves.pop(),
        std::cmp::Ordering::Equal if beyond > 0 => Some(vec![f64::NAN; points]),
        _ => with(f64::INFINITY, &[p])?.curves.pop(),
    };
    PERCENTILES.into_iter().map(curve).collect()
}
