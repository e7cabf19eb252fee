//! Secular slope of an oscillating error: regression on a line and on the oscillations.
//!
//! A straight line fitted to a Schuler oscillation has a slope of its own, even over whole periods
//! (−6A/πnT for a sine). So the oscillations are regressed together with the line, over a window of
//! whole periods, in which the columns are nearly orthogonal.

use nalgebra::{SMatrix, SVector};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};

/// Length of a sidereal day 2π/Ω, s.
pub(super) const SIDEREAL_DAY_S: f64 = 2.0 * core::f64::consts::PI / EARTH_RATE_RADPS;

const SECONDS_PER_DAY: f64 = 86_400.0;

/// Number of columns: 1, t, cos and sin at the Schuler frequency, cos and sin at the Earth rate.
const COLUMNS: usize = 6;

/// Normal equations of both errors, accumulated sample by sample.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    samples: u64,
    normal: SMatrix<f64, COLUMNS, COLUMNS>,
    latitude: SVector<f64, COLUMNS>,
    longitude: SVector<f64, COLUMNS>,
}

/// Streaming regression, with a copy of the sums at the last whole Schuler period and the last whole
/// sidereal day.
#[derive(Clone, Debug)]
pub(super) struct SecularSlope {
    schuler_period_s: f64,
    sums: Sums,
    schuler: (u32, Sums),
    sidereal: (u32, Sums),
}

/// Slopes in the unit of the errors per day, with their window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slopes {
    pub(super) latitude_per_day: f64,
    pub(super) longitude_per_day: f64,
    /// Number of whole periods in the window.
    pub(super) periods: u32,
    /// True for sidereal days, false for Schuler periods.
    pub(super) sidereal: bool,
    pub(super) window_s: f64,
}

impl SecularSlope {
    pub(super) fn new(latitude_rad: f64, height_m: f64) -> Self {
        Self {
            schuler_period_s: Ellipsoid::at(latitude_rad, height_m).schuler_period_s(),
            sums: Sums::default(),
            schuler: (0, Sums::default()),
            sidereal: (0, Sums::default()),
        }
    }

    /// Adds the errors at `t_s`; times must increase.
    pub(super) fn push(&mut self, t_s: f64, latitude: f64, longitude: f64) {
        for (period_s, kept) in
            [(self.schuler_period_s, &mut self.schuler), (SIDEREAL_DAY_S, &mut self.sidereal)]
        {
            // The sums so far end at the last sample within the whole periods. A sample on the boundary
            // begins the next period: a window is half open.
            let whole = (t_s / period_s + 1e-9) as u32;
            if whole > kept.0 {
                *kept = (whole, self.sums);
            }
        }
        let (schuler_sin, schuler_cos) =
            libm::sincos(2.0 * core::f64::consts::PI * t_s / self.schuler_period_s);
        let (earth_sin, earth_cos) = libm::sincos(EARTH_RATE_RADPS * t_s);
        let row = SVector::<f64, COLUMNS>::new(
            1.0,
            t_s / SECONDS_PER_DAY,
            schuler_cos,
            schuler_sin,
            earth_cos,
            earth_sin,
        );
        self.sums.samples += 1;
        self.sums.normal += row * row.transpose();
        self.sums.latitude += row * latitude;
        self.sums.longitude += row * longitude;
    }

    /// Slopes over the longest window of whole periods; `None` before the end of the first period.
    pub(super) fn slopes(&self) -> Option<Slopes> {
        let (days, sums) = self.sidereal;
        if days > 0 {
            let (latitude_per_day, longitude_per_day) = solve(&sums, COLUMNS)?;
            return Some(Slopes {
                latitude_per_day,
                longitude_per_day,
                periods: days,
                sidereal: true,
                window_s: f64::from(days) * SIDEREAL_DAY_S,
            });
        }
        let (periods, sums) = self.schuler;
        // In less than a day the Earth-rate columns can't be distinguished from a parabola, and are
        // left out.
        let (latitude_per_day, longitude_per_day) = solve(&sums, 4)?;
        Some(Slopes {
            latitude_per_day,
            longitude_per_day,
            periods,
            sidereal: false,
            window_s: f64::from(periods) * self.schuler_period_s,
        })
    }
}

/// Solves for all columns, or without those at the Earth rate; returns the slopes of latitude and
/// longitude per day.
fn solve(sums: &Sums, columns: usize) -> Option<(f64, f64)> {
    if sums.samples < 2 * columns as u64 {
        return None;
    }
    let Sums { mut normal, mut latitude, mut longitude, .. } = *sums;
    for i in columns..COLUMNS {
        // An omitted column becomes an equation of its own: 1 · x = 0.
        normal.row_mut(i).fill(0.0);
        normal.column_mut(i).fill(0.0);
        normal[(i, i)] = 1.0;
        latitude[i] = 0.0;
        longitude[i] = 0.0;
    }
    let factor = normal.lu();
    let slopes = (factor.solve(&latitude)?[1], factor.solve(&longitude)?[1]);
    (slopes.0.is_finite() && slopes.1.is_finite()).then_some(slopes)
}
