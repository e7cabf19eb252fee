//! Secular slope and Schuler oscillation of errors: regression on a line and on the oscillations.
//!
//! A straight line fitted to a Schuler oscillation has a slope of its own, even over whole periods
//! (−6A/πnT for a sine). So the oscillations are regressed together with the line, over a window of
//! whole periods, in which the columns are nearly orthogonal.
//!
//! The amplitude of the Schuler oscillation changes with time: its plane turns as that of Foucault's
//! pendulum, once in 2π/(Ω sin L), and noise excites it. So it is fitted in each Schuler period by
//! itself, together with a line, and the amplitudes are averaged as squares. An oscillation at the
//! Earth rate leaks into it by 2(Ω/ω_s)² of its amplitude, 0.7 %.

use nalgebra::{SMatrix, SVector};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};

/// Length of a sidereal day 2π/Ω, s.
pub(super) const SIDEREAL_DAY_S: f64 = 2.0 * core::f64::consts::PI / EARTH_RATE_RADPS;

const SECONDS_PER_DAY: f64 = 86_400.0;

/// Number of columns: 1, t, cos and sin at the Schuler frequency, cos and sin at the Earth rate.
const COLUMNS: usize = 6;
/// Columns without those at the Earth rate. In less than a day these can't be distinguished from a
/// parabola.
const SHORT: usize = 4;

/// Normal equations of `N` errors, accumulated sample by sample.
#[derive(Clone, Copy, Debug)]
struct Sums<const N: usize> {
    samples: u64,
    normal: SMatrix<f64, COLUMNS, COLUMNS>,
    errors: [SVector<f64, COLUMNS>; N],
}

impl<const N: usize> Sums<N> {
    fn new() -> Self {
        Self { samples: 0, normal: SMatrix::zeros(), errors: [SVector::zeros(); N] }
    }

    /// Sums of the samples since `earlier`.
    fn since(&self, earlier: &Self) -> Self {
        Self {
            samples: self.samples - earlier.samples,
            normal: self.normal - earlier.normal,
            errors: core::array::from_fn(|i| self.errors[i] - earlier.errors[i]),
        }
    }

    /// Coefficients of the first `columns` columns for each error; `None` with too few samples.
    fn solve(&self, columns: usize) -> Option<[SVector<f64, COLUMNS>; N]> {
        if self.samples < 2 * columns as u64 {
            return None;
        }
        let Self { mut normal, mut errors, .. } = *self;
        for i in columns..COLUMNS {
            // An omitted column becomes an equation of its own: 1 · x = 0.
            normal.row_mut(i).fill(0.0);
            normal.column_mut(i).fill(0.0);
            normal[(i, i)] = 1.0;
            errors.iter_mut().for_each(|error| error[i] = 0.0);
        }
        let factor = normal.lu();
        for error in &mut errors {
            *error = factor.solve(error)?;
        }
        let finite = errors.iter().all(|error| error.iter().all(|x| x.is_finite()));
        finite.then_some(errors)
    }
}

/// Streaming regression of `N` errors, with a copy of the sums at the last whole Schuler period and the
/// last whole sidereal day.
#[derive(Clone, Debug)]
pub(super) struct SecularSlope<const N: usize> {
    schuler_period_s: f64,
    sums: Sums<N>,
    schuler: (u32, Sums<N>),
    sidereal: (u32, Sums<N>),
    /// Number of Schuler periods with an amplitude, and the sums of the squared amplitudes.
    oscillations: (u32, [f64; N]),
}

/// Secular and Schuler parts of the errors, with the window of the slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slopes<const N: usize> {
    /// Slopes in the unit of the errors per day.
    pub(super) per_day: [f64; N],
    /// Root mean square over the Schuler periods of the amplitude of the oscillation.
    pub(super) schuler: Option<[f64; N]>,
    /// Number of whole periods in the window.
    pub(super) periods: u32,
    /// True for sidereal days, false for Schuler periods.
    pub(super) sidereal: bool,
    pub(super) window_s: f64,
}

impl<const N: usize> SecularSlope<N> {
    pub(super) fn new(latitude_rad: f64, height_m: f64) -> Self {
        Self {
            schuler_period_s: Ellipsoid::at(latitude_rad, height_m).schuler_period_s(),
            sums: Sums::new(),
            schuler: (0, Sums::new()),
            sidereal: (0, Sums::new()),
            oscillations: (0, [0.0; N]),
        }
    }

    /// Adds the errors at `t_s`; times must increase.
    pub(super) fn push(&mut self, t_s: f64, errors: &[f64; N]) {
        // The sums so far end at the last sample within the whole periods. A sample on the boundary
        // begins the next period: a window is half open.
        let whole = |period_s: f64| (t_s / period_s + 1e-9) as u32;
        let (periods, days) = (whole(self.schuler_period_s), whole(SIDEREAL_DAY_S));
        if periods > self.schuler.0 {
            self.end_period(periods);
        }
        if days > self.sidereal.0 {
            self.sidereal = (days, self.sums);
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
        for (sum, error) in self.sums.errors.iter_mut().zip(errors) {
            *sum += row * *error;
        }
    }

    /// Ends the Schuler period before this number of them, and fits the oscillation in it.
    #[cold]
    fn end_period(&mut self, periods: u32) {
        let (before, start) = &self.schuler;
        // A gap in the samples that is longer than a period leaves no period to fit.
        if periods == before + 1
            && let Some(fits) = self.sums.since(start).solve(SHORT)
        {
            self.oscillations.0 += 1;
            for (sum, fit) in self.oscillations.1.iter_mut().zip(&fits) {
                *sum += fit[2] * fit[2] + fit[3] * fit[3];
            }
        }
        self.schuler = (periods, self.sums);
    }

    /// Slopes over the longest window of whole periods; `None` before the end of the first period.
    pub(super) fn slopes(&self) -> Option<Slopes<N>> {
        let (days, _) = self.sidereal;
        let (periods, sums, columns, period_s) = if days > 0 {
            (days, &self.sidereal.1, COLUMNS, SIDEREAL_DAY_S)
        } else {
            (self.schuler.0, &self.schuler.1, SHORT, self.schuler_period_s)
        };
        let fits = sums.solve(columns)?;
        let (count, squares) = self.oscillations;
        Some(Slopes {
            per_day: fits.map(|fit| fit[1]),
            schuler: (count > 0)
                .then(|| squares.map(|square| libm::sqrt(square / f64::from(count)))),
            periods,
            sidereal: days > 0,
            window_s: f64::from(periods) * period_s,
        })
    }
}
