//! Multi-position least squares: the estimator beside the Kalman filter.
//!
//! The instrument rests in a number of attitudes. The estimator keeps the mean specific force and
//! the mean rate of each, and of each move between them the rotation by the gyros and its
//! sensitivity to their parameters. Two references, by [`GyroReference`]:
//!
//! - **Earth rate**, for gyros that resolve it: gravity and Earth rate are known vectors in n, the
//!   attitude of each interval is not (`chain`). In every interval the norm of gravity, the norm of
//!   Earth rate and their product `f·ω = gΩ sin L` are measured, and each move ties two attitudes.
//!   Determines b_g, S_g, M_g, b_a, S_a and M_a; six positions are enough, because the moves tie
//!   the accelerometers' axes to each other, which the norm of gravity alone cannot.
//! - **Rotated gravity**, for MEMS: accelerometers from the norm of gravity, gyro bias from the
//!   first interval, S_g and M_g from gravity turned between attitudes.
//!
//! Neither reference estimates G: it keeps its initial value, with which the gyros are compensated,
//! and its σ is NaN. If that value is wrong, biases absorb a part of the error, which σ doesn't
//! include.
//!
//! Against Earth rate σ is smaller than the Kalman filter's: the instrument is assumed to be at
//! rest, whereas the filter lets attitude wander with the gyros' random walk within a dwell. On a
//! ship the assumption is wrong, and the residuals refuse the result. Against rotated gravity a
//! turn about the vertical leaves no trace in the accelerometers, and detection takes it for a
//! standstill; this does no harm, because gravity in b doesn't change.
//!
//! The moves are linearised about the initial parameters, in a single pass over the samples: the
//! neglected second order is M_g² times the angle of a move. Parts in 10⁴ leave 0.01″; if M_g is
//! large, a second pass over the data should start from the first result.

pub(crate) mod accelerometer;
pub(crate) mod chain;
mod detector;
pub(crate) mod interval;
pub(crate) mod moves;
mod normal;
pub mod raw;
mod refusal;
mod rotated_gravity;

use crate::alignment::attitude_of;
use crate::config::{self, GyroReference, Site, StaticIntervals};
use crate::standstill::AverageUncertainty;
use chain::Chain;
use detector::Detector;
use interval::Segmenter;
use moves::{Compensation, Move, corrected};
use nalgebra::{Matrix6, SVector, Vector3};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_sample::{Parameters, Sample};

pub use interval::StaticInterval;
pub(crate) use refusal::positive;
pub use refusal::{AdjustmentRefusal, INTERVALS_MAX, RESIDUAL_RMS_MAX, WINDOW_SAMPLES_MAX};

/// Shortest standstill to use if the procedure commands it, s.
const SHORTEST_COMMANDED_S: f64 = 1.0;

/// Gauss-Newton steps on the chain of attitudes. It starts within the initial errors of a
/// navigation-grade instrument and gains several digits a step.
const ITERATIONS: usize = 8;

/// Result of an adjustment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adjustment {
    /// Estimated parameters; those that the method doesn't estimate keep their initial values.
    pub parameters: Parameters,
    /// Standard deviations, SI, in the order of the parameters; NaN: not estimated.
    pub sigma: [f64; 30],
    /// Root mean square of `|f| − g` over the intervals, m/s².
    pub gravity_residual_rms_mps2: f64,
    /// Root mean square over the moves, of the unit vector of gravity (rotated gravity), or of all
    /// residuals in units of their noise: expected 1 with the right model and noise (Earth rate and
    /// external turntable). A value above 1 has widened σ.
    pub residual_rms: f64,
    /// Uncertainty of compensated means over the last interval.
    pub average: AverageUncertainty,
    /// Static intervals used.
    pub intervals: usize,
    /// Complete moves used.
    pub moves: usize,
}

/// Streaming estimator: fixed size (some 100 kB, most of it the store of intervals and moves), one
/// step a sample.
#[derive(Clone, Debug)]
pub struct LeastSquaresEstimator {
    gyro: GyroReference,
    gravity_mps2: f64,
    earth: Ellipsoid,
    initial: Parameters,
    compensation: Compensation,
    segmenter: Segmenter,
    detector: Option<Detector>,
    intervals: [StaticInterval; INTERVALS_MAX],
    moves: [Move; INTERVALS_MAX],
    len: usize,
    overflow: bool,
}

#[cfg(feature = "state")]
impl octant_state::State for LeastSquaresEstimator {
    /// Saves only the filled part of the store.
    fn save(&self, to: &mut octant_state::Writer) {
        let Self {
            gyro: _,
            gravity_mps2: _,
            earth: _,
            initial: _,
            compensation,
            segmenter,
            detector,
            intervals,
            moves,
            len,
            overflow,
        } = self;
        to.value("compensation", compensation);
        to.part("segmenter", segmenter);
        to.part("detector", detector);
        to.value("overflow", overflow);
        to.value("len", len);
        for (interval, arrival) in intervals[..*len].iter().zip(moves) {
            to.value("interval", interval);
            to.value("arrival", arrival);
        }
    }

    fn load(
        &mut self,
        from: &mut octant_state::StateReader<'_>,
    ) -> Result<(), octant_state::StateError> {
        self.compensation = from.value("compensation")?;
        from.part("segmenter", &mut self.segmenter)?;
        from.part("detector", &mut self.detector)?;
        self.overflow = from.value("overflow")?;
        self.len = from.value("len")?;
        octant_state::check_below("len", self.len as u64, INTERVALS_MAX as u64)?;
        for (interval, arrival) in self.intervals[..self.len].iter_mut().zip(&mut self.moves) {
            *interval = from.value("interval")?;
            *arrival = from.value("arrival")?;
        }
        Ok(())
    }
}

impl LeastSquaresEstimator {
    /// Makes an estimator for samples of a nominal period at a site. The moves are linearised about
    /// `initial`: zero, or the result of an earlier calibration or pass.
    ///
    /// # Errors
    /// If a setting is out of range.
    pub fn new(
        settings: &config::LeastSquares,
        site: &Site,
        sample_period_ns: u64,
        initial: &Parameters,
    ) -> Result<Self, AdjustmentRefusal> {
        let earth = Ellipsoid::at(site.latitude_rad, site.height_m);
        let gravity_mps2 = settings.gravity_mps2.unwrap_or(earth.gravity_mps2);
        positive("gravity_mps2", gravity_mps2)?;
        let (detector, shortest_s) = match settings.intervals {
            StaticIntervals::Commanded => (None, SHORTEST_COMMANDED_S),
            StaticIntervals::Detected { initial_s, window_s, threshold, shortest_s } => {
                positive("shortest_s", shortest_s)?;
                let detector = Detector::new(initial_s, window_s, threshold, sample_period_ns)?;
                (Some(detector), shortest_s)
            }
        };
        Ok(Self {
            gyro: settings.gyro,
            gravity_mps2,
            earth,
            initial: *initial,
            compensation: Compensation::new(initial).ok_or(AdjustmentRefusal::InitialParameters)?,
            segmenter: Segmenter::new(shortest_s),
            detector,
            intervals: [StaticInterval::default(); INTERVALS_MAX],
            moves: [Move::default(); INTERVALS_MAX],
            len: 0,
            overflow: false,
        })
    }

    /// Takes one sample over `dt_s`, as measured: the result are whole parameters, not corrections
    /// to compensated samples. `standing` tells whether the gimbals rested during it; it is used if
    /// intervals are commanded (`None`: they did not rest), and ignored if they are detected.
    pub fn step(&mut self, sample: &Sample, dt_s: f64, standing: Option<bool>) {
        if !(dt_s > 0.0 && dt_s.is_finite()) {
            return;
        }
        match &mut self.detector {
            None => self.segment(sample, dt_s, standing.unwrap_or(false)),
            Some(detector) => {
                if let Some((sample, dt_s, standing)) = detector.step(sample, dt_s) {
                    self.segment(&sample, dt_s, standing);
                }
            }
        }
    }

    fn segment(&mut self, sample: &Sample, dt_s: f64, standing: bool) {
        if let Some(ended) = self.segmenter.step(sample, dt_s, standing, &self.compensation) {
            self.keep(ended);
            if self.len == 1 && self.gyro == GyroReference::RotatedGravity {
                // The sample that ended the interval was integrated with the initial bias.
                self.segmenter.restart(sample, dt_s, &self.compensation);
            }
        }
    }

    fn keep(&mut self, (arrival, interval): (Move, StaticInterval)) {
        if self.len == INTERVALS_MAX {
            self.overflow = true;
            return;
        }
        if self.len == 0 && self.gyro == GyroReference::RotatedGravity {
            // The bias is known from here on, and every later move is integrated with it.
            let force = self.compensation.force(&interval.force_mps2);
            self.compensation.gyro_bias = interval.rate_radps - self.compensation.g * force;
        }
        self.intervals[self.len] = interval;
        self.moves[self.len] = arrival;
        self.len += 1;
    }

    /// Ends the stream and computes the adjustment.
    ///
    /// # Errors
    /// If the intervals don't determine the parameters, or are too many, or the adjustment didn't
    /// converge.
    pub fn finish(&mut self) -> Result<Adjustment, AdjustmentRefusal> {
        while let Some((sample, dt_s, standing)) = self.detector.as_mut().and_then(Detector::drain)
        {
            self.segment(&sample, dt_s, standing);
        }
        if let Some(ended) = self.segmenter.flush() {
            self.keep(ended);
        }
        if self.overflow {
            return Err(AdjustmentRefusal::TooManyIntervals);
        }
        match self.gyro {
            GyroReference::EarthRate => self.finish_earth_rate(),
            GyroReference::RotatedGravity => self.finish_rotated_gravity(),
        }
    }

    /// The static intervals found so far.
    #[must_use]
    pub fn intervals(&self) -> &[StaticInterval] {
        &self.intervals[..self.len]
    }

    /// Moves between neighbouring intervals: `k` leads from interval k to k + 1. The samples before
    /// the first interval are not a move.
    fn between(&self) -> &[Move] {
        &self.moves[1.min(self.len)..self.len]
    }

    fn finish_rotated_gravity(&self) -> Result<Adjustment, AdjustmentRefusal> {
        let (mut parameters, accel_sigma, gravity_residual_rms_mps2) =
            accelerometer::estimate(self.intervals(), &self.initial, self.gravity_mps2)?;
        let accel = Compensation::new(&parameters).ok_or(AdjustmentRefusal::Diverged)?;
        let (correction, gyro_sigma, residual_rms) = rotated_gravity::estimate(
            self.intervals(),
            self.between(),
            &self.compensation,
            &accel,
        )?;
        let mut all = SVector::<f64, 30>::zeros();
        all.fixed_rows_mut::<9>(3).copy_from(&correction);
        parameters = corrected(&parameters, &all);
        let first = &self.intervals[0];
        let bias = first.rate_radps - self.compensation.g * accel.force(&first.force_mps2);
        parameters.gyro_bias = bias.into();
        let mut sigma = [f64::NAN; 30];
        for axis in 0..3 {
            sigma[axis] = libm::sqrt(first.rate_noise[axis] / first.duration_s);
        }
        sigma[3..12].copy_from_slice(&gyro_sigma);
        sigma[21..30].copy_from_slice(&accel_sigma);
        Ok(Adjustment {
            parameters,
            sigma,
            gravity_residual_rms_mps2,
            residual_rms,
            average: self.average_of(&sigma),
            intervals: self.len,
            moves: self.between().iter().filter(|turn| turn.complete).count(),
        })
    }

    /// Uncertainty of the means of the last interval by σ, as if all errors were independent.
    fn average_of(&self, sigma: &[f64; 30]) -> AverageUncertainty {
        let last = self.intervals().last().copied().unwrap_or_default();
        let mut parameters = Matrix6::zeros();
        for axis in 0..3 {
            let of_force = chain::parameters_of_force(&last.force_mps2, axis);
            for (row, sigma) in of_force.iter().zip(sigma).skip(21) {
                parameters[(axis, axis)] += row * row * sigma * sigma;
            }
            parameters[(3 + axis, 3 + axis)] = sigma[axis] * sigma[axis];
        }
        let StaticInterval { force_noise, rate_noise, .. } = last;
        AverageUncertainty { parameters, force_noise, rate_noise, joint: None, residuals: (0.0, 0) }
    }

    fn finish_earth_rate(&self) -> Result<Adjustment, AdjustmentRefusal> {
        if self.len < 2 {
            return Err(AdjustmentRefusal::TooFewIntervals { found: self.len, needed: 2 });
        }
        let mut estimated = [true; 30];
        estimated[12..21].fill(false);
        // Noise pooled over the intervals: one instrument, many samples.
        let count = self.len as f64;
        let pooled = |of: fn(&StaticInterval) -> Vector3<f64>| {
            self.intervals().iter().fold(Vector3::zeros(), |sum, at| sum + of(at)) / count
        };
        let noise = chain::Noise {
            force: pooled(|interval| interval.force_noise),
            rate: pooled(|interval| interval.rate_noise),
        };
        let gravity = Vector3::new(0.0, 0.0, -self.gravity_mps2);
        let earth_rate = self.earth.earth_rate();
        let mut parameters = self.initial;
        let mut adjusted = None;
        for _ in 0..ITERATIONS {
            let at = Compensation::new(&parameters).ok_or(AdjustmentRefusal::Diverged)?;
            let mut chain = Chain::new(&parameters, gravity, earth_rate, noise, estimated);
            for (index, interval) in self.intervals().iter().enumerate() {
                let force = at.force(&interval.force_mps2);
                let rate = at.rate(&interval.rate_radps, &force);
                let visible = rate.norm() / EARTH_RATE_RADPS;
                let q_nb = attitude_of(&force, &rate)
                    .filter(|_| visible > 0.5 && visible < 2.0)
                    .ok_or(AdjustmentRefusal::NoEarthRate { interval: index })?;
                let turn = (index > 0).then(|| {
                    chain::Turn::new(
                        &self.moves[index],
                        &self.compensation,
                        &self.initial,
                        &parameters,
                    )
                });
                chain.interval(interval, &q_nb, turn.as_ref(), None);
            }
            let solution = chain.solve()?;
            parameters = corrected(&parameters, &solution.correction);
            adjusted = Some(solution);
        }
        let solution = adjusted.ok_or(AdjustmentRefusal::Diverged)?;
        solution.consistent()?;
        if !solution.settled() {
            return Err(AdjustmentRefusal::Diverged);
        }
        let at = Compensation::new(&parameters).ok_or(AdjustmentRefusal::Diverged)?;
        let squares = self.intervals().iter().fold(0.0, |sum, interval| {
            let residual = at.force(&interval.force_mps2).norm() - self.gravity_mps2;
            sum + residual * residual
        });
        Ok(Adjustment {
            parameters,
            sigma: solution.sigma(),
            gravity_residual_rms_mps2: libm::sqrt(squares / count),
            residual_rms: solution.residual_rms,
            average: solution.average,
            intervals: self.len,
            moves: self.between().iter().filter(|turn| turn.complete).count(),
        })
    }
}
