//! Percentiles of the errors over time: in the units of `statistics.json`, and in those of the page.

use super::columns::{Collected, CurveColumns};
use super::curves::StoredCurve;
use octant_statistics::sample::percentile_of_ranks;
use serde::Serialize;
use std::cmp::Ordering;

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
    pub(super) fn of(curves: impl Iterator<Item = StoredCurve>, beyond: usize) -> Option<Self> {
        let curves = curves.map(|curve| (curve, [1.0; 2]));
        let ShownEnvelope { hours, latitude, longitude } = ShownEnvelope::of(curves, beyond)?;
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
    pub(super) fn of(
        curves: impl Iterator<Item = (StoredCurve, [f64; 2])>,
        beyond: usize,
    ) -> Option<Self> {
        let mut first = None;
        let kept = curves.inspect(|(curve, _)| _ = first.get_or_insert_with(|| curve.clone()));
        let Collected::Columns(mut columns) = CurveColumns::of(kept) else { return None };
        let mut values = Vec::with_capacity(columns.count);
        let mut of = |axis: usize| {
            let mut found = vec![Vec::with_capacity(columns.points); PERCENTILES.len()];
            for point in 0..columns.points {
                if let Err(error) = columns.read(axis, point, &mut values) {
                    first.as_ref()?.fail(error);
                    return None;
                }
                let at_point = percentiles(&mut values, beyond)?;
                found.iter_mut().zip(at_point).for_each(|(curve, value)| curve.push(value));
            }
            Some(found)
        };
        let (latitude, longitude) = (of(0)?, of(1)?);
        let hours = (0..columns.points).map(|k| k as f64 * columns.step_s / 3600.0).collect();
        Some(Self { hours, latitude, longitude })
    }
}

impl From<&EnvelopeFigures> for ShownEnvelope {
    /// Takes the percentiles as they are: in minutes of arc.
    fn from(figures: &EnvelopeFigures) -> Self {
        let EnvelopeFigures { hours, latitude_arcmin, longitude_arcmin, .. } = figures.clone();
        Self { hours, latitude: latitude_arcmin, longitude: longitude_arcmin }
    }
}

/// Percentiles of errors, [`PERCENTILES`] in their order; `None` if an error is no number.
///
/// An error has a sign, and one beyond every number may have either: it counts as far below for
/// the percentiles under the median and as far above for those over it. The median of such a
/// sample isn't defined.
fn percentiles(values: &mut [f64], beyond: usize) -> Option<[f64; PERCENTILES.len()]> {
    if values.iter().any(|value| value.is_nan()) {
        return None;
    }
    values.sort_unstable_by(f64::total_cmp);
    let count = values.len() + beyond;
    let below = |rank: usize| {
        let rank = rank.checked_sub(beyond);
        rank.and_then(|rank| values.get(rank)).copied().unwrap_or(f64::NEG_INFINITY)
    };
    let above = |rank: usize| values.get(rank).copied().unwrap_or(f64::INFINITY);
    let of = |p: f64| match p.total_cmp(&0.5) {
        Ordering::Less => percentile_of_ranks(count, p, below),
        Ordering::Equal if beyond > 0 => Some(f64::NAN),
        _ => percentile_of_ranks(count, p, above),
    };
    let mut found = [f64::NAN; PERCENTILES.len()];
    for (found, p) in found.iter_mut().zip(PERCENTILES) {
        *found = of(p)?;
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::super::curves::{Curve, CurveWriter};
    use super::*;

    /// More curves than a block has, of different lengths.
    #[test]
    fn percentiles_of_many_curves_are_those_of_each_time() {
        let mut writer = CurveWriter::new();
        let count = 2500;
        let value = |case: usize, point: usize| ((case * 7919) % count) as f64 - point as f64;
        let curves: Vec<StoredCurve> = (0..count)
            .map(|case| {
                let of = |factor: f64| -> Vec<f64> {
                    (0..5 + case % 3).map(|point| factor * value(case, point)).collect()
                };
                let (latitude_arcmin, longitude_arcmin) = (of(1.0), of(-2.0));
                writer.push(&Curve { step_s: 60.0, latitude_arcmin, longitude_arcmin }).unwrap()
            })
            .collect();
        writer.flush().unwrap();
        let found = EnvelopeFigures::of(curves.iter().cloned(), 0).unwrap();
        assert_eq!(found.hours.len(), 5);
        for (k, p) in PERCENTILES.into_iter().enumerate() {
            for point in 0..5 {
                let all: Vec<f64> = (0..count).map(|case| value(case, point)).collect();
                let doubled: Vec<f64> = all.iter().map(|value| -2.0 * value).collect();
                let of = octant_statistics::sample::percentile;
                assert_eq!(Some(found.latitude_arcmin[k][point]), of(&all, p));
                assert_eq!(Some(found.longitude_arcmin[k][point]), of(&doubled, p));
            }
        }
        let shown = ShownEnvelope::of(curves.iter().cloned().zip([[3.0, 1.0]; 2500]), 0).unwrap();
        assert_eq!(shown.latitude[2][1], 3.0 * found.latitude_arcmin[2][1]);
        let other = Curve { step_s: 1.0, latitude_arcmin: vec![0.0], longitude_arcmin: vec![0.0] };
        let other = writer.push(&other).unwrap();
        writer.flush().unwrap();
        assert_eq!(EnvelopeFigures::of(curves.into_iter().chain([other]), 0), None);
    }

    #[test]
    fn an_error_beyond_every_number_is_on_both_sides() {
        let mut values: Vec<f64> = (0..9).map(f64::from).collect();
        let [least, low, middle, high, greatest] = percentiles(&mut values, 2).unwrap();
        assert_eq!((least, greatest), (f64::NEG_INFINITY, f64::INFINITY));
        assert!(middle.is_nan());
        assert_eq!((low, high), (0.5, 7.5));
        assert_eq!(percentiles(&mut [1.0, f64::NAN], 0), None);
    }
}
