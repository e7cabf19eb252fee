//! The case on a precise external turntable whose angles are the reference.
//!
//! The attitude of the body is known from the survey of the table's base, `q_nc`, and the encoder
//! angles: `c_nb = c_nc Rx(roll) Rz(azimuth)`. So specific force and Earth rate in b are known in
//! every dwell, on all three axes, and so is the rotation of every move. Then all thirty parameters
//! are determined, including the isotropic part of G: with azimuth known, a vertical drift is
//! observable like a horizontal one. That is the advantage of this reference over a
//! self-calibration.
//!
//! The adjustment is that of [`crate::least_squares`], with the attitude of each interval known to
//! the precision of the encoders, and with all parameters estimated. It is linear except for terms
//! like M_g² times the angle of a move (0.01″ for Table 1 errors), runs in one pass and keeps no
//! intervals: their number is unlimited.
//!
//! σ rests on these assumptions: white sensor noise as given; encoder errors independent from
//! interval to interval, of the same σ in both angles; a survey of the base without error; and body
//! axes that are those of the inner gimbal at zero. Residuals above their noise widen σ. In a move
//! the drift by G is compensated with its initial value; 10 s of a G that is wrong by 5e-3 °/h/g
//! are 0.05″.

use crate::config::{self, Noise, Site};
use crate::least_squares::accelerometer::norm_row;
use crate::least_squares::chain::{self, AttitudePrior, Chain, Turn};
use crate::least_squares::interval::{Segmenter, StaticInterval};
use crate::least_squares::moves::{Compensation, Move, corrected};
use crate::least_squares::{Adjustment, AdjustmentRefusal, positive};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use octant_earth::UnitQuaternion;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::{c_cb, quaternion_from_matrix};
use octant_sample::{Parameters, Sample};

/// Shortest dwell to use, s.
const SHORTEST_S: f64 = 1.0;

/// Share of the survey of the base in the attitude's σ, against the encoders': the survey is
/// assumed exact, but the equations need a weight above zero.
const SURVEY_SHARE: f64 = 1e-3;

/// Streaming estimator: fixed size, one step a sample.
#[derive(Clone, Debug)]
pub struct ExternalTurntableEstimator {
    q_nc: UnitQuaternion<f64>,
    encoder_sigma_rad: f64,
    gravity_mps2: f64,
    initial: Parameters,
    compensation: Compensation,
    segmenter: Segmenter,
    chain: Chain,
    norms: NormMoments,
    intervals: usize,
    moves: usize,
    without_encoder: Option<usize>,
}

#[cfg(feature = "state")]
octant_state::state! {
    ExternalTurntableEstimator {
        values: norms, intervals, moves, without_encoder;
        parts: segmenter, chain;
        kept: q_nc, encoder_sigma_rad, gravity_mps2, initial, compensation;
        check: Self::check_counts
    }
}

#[cfg(feature = "state")]
impl ExternalTurntableEstimator {
    fn check_counts(&self) -> Result<(), octant_state::StateError> {
        octant_state::check_count("intervals", self.intervals as u64)?;
        octant_state::check_count("moves", self.moves as u64)
    }
}

/// Second moments of the residual of the norm of gravity and of its gradient with respect to the
/// nine accelerometer parameters: sufficient for the residual after the adjustment without keeping
/// the intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
struct NormMoments(SMatrix<f64, 10, 10>);

impl NormMoments {
    fn add(&mut self, compensation: &Compensation, interval: &StaticInterval, gravity_mps2: f64) {
        let (residual, gradient) = norm_row(compensation, interval, gravity_mps2);
        let row = SVector::<f64, 10>::from_fn(|i, _| if i < 9 { gradient[i] } else { residual });
        self.0 += row * row.transpose();
    }

    /// Root mean square of `|f| − g` with the accelerometers corrected, m/s².
    fn rms(&self, correction: &SVector<f64, 30>, intervals: usize) -> f64 {
        let left =
            SVector::<f64, 10>::from_fn(|i, _| if i < 9 { -correction[21 + i] } else { 1.0 });
        libm::sqrt(left.dot(&(self.0 * left)).max(0.0) / intervals as f64)
    }
}

impl ExternalTurntableEstimator {
    /// Makes an estimator at a site. The equations are linearised about `initial`: zero, or the
    /// result of an earlier calibration or pass. The sample period comes with every step.
    ///
    /// # Errors
    /// If a noise is not a positive number, or the initial parameters are unusable for
    /// compensation.
    pub fn new(
        settings: &config::ExternalTurntable,
        site: &Site,
        noise: &Noise,
        initial: &Parameters,
    ) -> Result<Self, AdjustmentRefusal> {
        let encoder_sigma_rad = settings.encoder_sigma_rad;
        positive("encoder_sigma_rad", encoder_sigma_rad)?;
        positive("angle_random_walk", noise.angle_random_walk)?;
        positive("velocity_random_walk", noise.velocity_random_walk)?;
        let earth = Ellipsoid::at(site.latitude_rad, site.height_m);
        let density = chain::Noise {
            force: Vector3::repeat(noise.velocity_random_walk * noise.velocity_random_walk),
            rate: Vector3::repeat(noise.angle_random_walk * noise.angle_random_walk),
        };
        let gravity = Vector3::new(0.0, 0.0, -earth.gravity_mps2);
        Ok(Self {
            q_nc: settings.q_nc,
            encoder_sigma_rad,
            gravity_mps2: earth.gravity_mps2,
            initial: *initial,
            compensation: Compensation::new(initial).ok_or(AdjustmentRefusal::InitialParameters)?,
            segmenter: Segmenter::new(SHORTEST_S),
            chain: Chain::new(initial, gravity, earth.earth_rate(), density, [true; 30]),
            norms: NormMoments(SMatrix::zeros()),
            intervals: 0,
            moves: 0,
            without_encoder: None,
        })
    }

    /// Takes one sample over `dt_s`, as measured (not compensated); `standing`: whether the table
    /// rested during it.
    pub fn step(&mut self, sample: &Sample, dt_s: f64, standing: bool) {
        if !(dt_s > 0.0 && dt_s.is_finite()) {
            return;
        }
        if let Some(ended) = self.segmenter.step(sample, dt_s, standing, &self.compensation) {
            self.keep(&ended);
        }
    }

    fn keep(&mut self, (arrival, interval): &(Move, StaticInterval)) {
        let Some((azimuth_rad, roll_rad)) = interval.gimbal_rad else {
            self.without_encoder.get_or_insert(self.intervals);
            return;
        };
        let q_nb = self.q_nc * quaternion_from_matrix(&c_cb(azimuth_rad, roll_rad));
        // The inner axis is body z; the outer one, case x, lies in the plane of body x and y.
        let (sin, cos) = libm::sincos(azimuth_rad);
        let prior = AttitudePrior {
            axes: Matrix3::new(cos, sin, 0.0, -sin, cos, 0.0, 0.0, 0.0, 1.0),
            sigma_rad: Vector3::new(1.0, SURVEY_SHARE, 1.0) * self.encoder_sigma_rad,
        };
        let turn = (self.intervals > 0)
            .then(|| Turn::new(arrival, &self.compensation, &self.initial, &self.initial));
        self.chain.interval(interval, &q_nb, turn.as_ref(), Some(&prior));
        self.norms.add(&self.compensation, interval, self.gravity_mps2);
        self.moves += usize::from(turn.is_some() && arrival.complete);
        self.intervals += 1;
    }

    /// Ends the stream and computes the adjustment.
    ///
    /// # Errors
    /// If the dwells and moves don't determine the parameters, or a dwell has no encoder angles.
    pub fn finish(&mut self) -> Result<Adjustment, AdjustmentRefusal> {
        if let Some(ended) = self.segmenter.flush() {
            self.keep(&ended);
        }
        if let Some(interval) = self.without_encoder {
            return Err(AdjustmentRefusal::NoEncoder { interval });
        }
        if self.intervals < 2 {
            return Err(AdjustmentRefusal::TooFewIntervals { found: self.intervals, needed: 2 });
        }
        let solution = self.chain.clone().solve()?;
        solution.consistent()?;
        Ok(Adjustment {
            parameters: corrected(&self.initial, &solution.correction),
            sigma: solution.sigma(),
            gravity_residual_rms_mps2: self.norms.rms(&solution.correction, self.intervals),
            residual_rms: solution.residual_rms,
            average: solution.average,
            intervals: self.intervals,
            moves: self.moves,
        })
    }
}
