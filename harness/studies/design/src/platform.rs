//! Transitions of the error states while the gimbals stand and while they turn.
//!
//! They are those of the core's own error model ([`Transition::advance`]), over intervals as long as its
//! accuracy allows.

use nalgebra::{Matrix3, Vector3};
use octant_calibration::config::{ErrorModel, TurntableRates};
use octant_calibration::covariance::{
    Covariance, DR, DV, PARAMETERS, PHI, STATE_COUNT, Transition,
};
use octant_calibration::error_model::MotionInterval;
use octant_calibration::filter::add_process_noise;
use octant_calibration::schedule::{move_between_s, turned_rad};
use octant_calibration::sequence::Stop;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::c_cb;

/// Longest sub-step of a transition at rest in a calibration, s: as in the filter's own prediction.
pub(crate) const CALIBRATING_S: f64 = 1.0;
/// Longest sub-step of a transition at rest in navigation, s. Each sub-step makes a Schuler oscillation
/// larger by (ω h)² / 4: with 1 s by 10 % in 72 h, with this by 0.2 %.
pub(crate) const NAVIGATING_S: f64 = 0.02;
/// Longest sub-step while a gimbal turns, s: a degree at 10 deg/s, up to which the model's own step is accurate.
pub(crate) const TURNING_S: f64 = 0.1;
/// Largest angle of a sub-step, rad.
const TURNED_RAD: f64 = 0.018;

/// Number of parameters.
pub(crate) const PARAMETER_COUNT: usize = STATE_COUNT - PARAMETERS;
/// Number of parameters of the gyros, which come before those of the accelerometers.
const GYRO_PARAMETERS: usize = 21;
/// Number of errors in n that the parameters make at rest: three of the rates, three of the specific force.
pub(crate) const INPUTS: usize = 6;

/// Errors in n of rates (rad/s) and specific force (m/s²) at rest, as rows over the parameters.
pub(crate) type InputRows = [[f64; PARAMETER_COUNT]; INPUTS];

/// A base at rest with two gimbals on it.
#[derive(Clone, Debug)]
pub struct Platform {
    /// The ellipsoid at the site.
    pub earth: Ellipsoid,
    /// Attitude of the case.
    pub c_nc: Matrix3<f64>,
    /// Rates of the gimbals.
    pub rates: TurntableRates,
    /// Angle by which the gimbal axes deviate from a right angle, rad.
    pub non_orthogonality_rad: f64,
    /// Form of the error model in the calibration.
    pub error_model: ErrorModel,
    /// White noise per s: of the gyros, rad²/s, and of the accelerometers, (m/s)²/s.
    pub noise: (f64, f64),
    /// Longest sub-step while a gimbal turns, s.
    pub turning_s: f64,
}

impl Platform {
    /// Returns the attitude of the body in the case.
    fn c_cb(&self, azimuth_rad: f64, roll_rad: f64) -> Matrix3<f64> {
        if self.non_orthogonality_rad == 0.0 {
            return c_cb(azimuth_rad, roll_rad);
        }
        let (s, c) = libm::sincos(self.non_orthogonality_rad);
        let leant = Matrix3::new(c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c);
        c_cb(0.0, roll_rad) * leant * c_cb(azimuth_rad, 0.0)
    }

    /// Makes the motion of an interval in which the gimbals turn by `turned` about the attitude `middle`,
    /// both azimuth and roll in rad.
    fn interval(&self, middle: [f64; 2], turned: [f64; 2], h: f64) -> MotionInterval {
        let c_cb = self.c_cb(middle[0], middle[1]);
        let c_nb = self.c_nc * c_cb;
        let force_n = self.force() * h;
        MotionInterval {
            interval_s: h,
            c_nb,
            delta_theta: c_nb.transpose() * self.earth.earth_rate() * h
                + c_cb.transpose() * Vector3::new(turned[1], 0.0, 0.0)
                + Vector3::new(0.0, 0.0, turned[0]),
            delta_velocity: c_nb.transpose() * force_n,
            delta_velocity_n: force_n,
            velocity_mps: Vector3::zeros(),
        }
    }

    /// Returns the specific force in n, m/s².
    pub(crate) fn force(&self) -> Vector3<f64> {
        Vector3::new(0.0, 0.0, -self.earth.gravity_mps2)
    }

    /// Returns the transition over `length_s` at a stop, in sub-steps of at most `sub_step_s`.
    pub(crate) fn standing(
        &self,
        at: &Stop,
        length_s: f64,
        sub_step_s: f64,
        model: ErrorModel,
    ) -> Transition {
        let steps = libm::ceil(length_s / sub_step_s - 1e-9).max(1.0);
        let h = length_s / steps;
        let interval = self.interval([at.azimuth_rad, at.roll_rad], [0.0; 2], h);
        let mut transition = Transition::identity();
        for _ in 0..steps as u32 {
            transition.advance(model, &interval, &self.earth);
        }
        transition
    }

    /// Returns the transition over a part of a move, from `t_s` after its start on.
    fn turning(
        &self,
        (from, to): (&Stop, &Stop),
        t_s: f64,
        length_s: f64,
        model: ErrorModel,
    ) -> Transition {
        let sub_step_s = self.turning_s.min(TURNED_RAD / self.rates.rate_radps);
        let steps = libm::ceil(length_s / sub_step_s - 1e-9).max(1.0);
        let h = length_s / steps;
        let start = [from.azimuth_rad, from.roll_rad];
        let whole = [to.azimuth_rad - start[0], to.roll_rad - start[1]];
        let turned = |t: f64| whole.map(|angle| turned_rad(angle, t, &self.rates));
        let mut transition = Transition::identity();
        for k in 0..steps as u32 {
            let t = t_s + f64::from(k) * h;
            let (before, middle, after) = (turned(t), turned(t + 0.5 * h), turned(t + h));
            let middle = [start[0] + middle[0], start[1] + middle[1]];
            let turned = [after[0] - before[0], after[1] - before[1]];
            transition.advance(model, &self.interval(middle, turned, h), &self.earth);
        }
        transition
    }

    /// Returns a move as transitions over parts of equal length, none longer than `part_s`, and that length.
    pub(crate) fn moving(
        &self,
        from: &Stop,
        to: &Stop,
        part_s: f64,
        model: ErrorModel,
    ) -> (Vec<Transition>, f64) {
        let total = move_between_s(from, to, &self.rates);
        let parts = libm::ceil(total / part_s - 1e-9).max(1.0);
        let h = total / parts;
        let part = |k: u32| self.turning((from, to), f64::from(k) * h, h, model);
        ((0..parts as u32).map(part).collect(), h)
    }

    /// Returns the errors in n that the parameters make at a stop.
    pub(crate) fn inputs(&self, at: &Stop) -> InputRows {
        let mut transition = Transition::identity();
        let interval = self.interval([at.azimuth_rad, at.roll_rad], [0.0; 2], 1.0);
        transition.advance(ErrorModel::Phi, &interval, &self.earth);
        let mut rows = [[0.0; PARAMETER_COUNT]; INPUTS];
        for axis in 0..3 {
            for parameter in 0..GYRO_PARAMETERS {
                rows[axis][parameter] = -transition.rows[PHI + axis][PARAMETERS + parameter];
            }
            for parameter in GYRO_PARAMETERS..PARAMETER_COUNT {
                rows[3 + axis][parameter] = transition.rows[DV + axis][PARAMETERS + parameter];
            }
        }
        rows
    }

    /// Carries a covariance over a transition of `length_s`, with the noise that comes in.
    pub(crate) fn carry(&self, covariance: &mut Covariance, over: &Transition, length_s: f64) {
        covariance.propagate(over);
        add_process_noise(covariance, self.noise, length_s, &(self.force() * length_s));
    }
}

/// Holds height and vertical velocity through a transition, as free navigation does.
pub(crate) fn hold_vertical(transition: &mut Transition) {
    transition.rows[DV + 2].fill(0.0);
    transition.rows[DR + 2].fill(0.0);
}

/// States that are known at the start of navigation: the position, and the vertical velocity.
pub(crate) const KNOWN_AT_START: [usize; 4] = [DR, DR + 1, DR + 2, DV + 2];
