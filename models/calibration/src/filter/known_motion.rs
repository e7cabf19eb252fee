//! Known motion at rest, which the transition takes in place of what noisy sensors measured.
//!
//! The columns of the transition are products of the motion and the error of a state: a scale factor turns the attitude by
//! its share of Δθ, an attitude error turns the velocity by its share of Δv. Taken from the sensors they contain the noise
//! that is in the error itself, and the filter takes the one for the other (errors in variables; Fuller, *Measurement Error
//! Models*, 1987, 1.1): the noise n of a gyro at rest is an error −n of the attitude, explained by a scale factor of one.
//! In each second that adds to the information of the scale factor, and to what it is said to be, the square of n in units
//! of its own variance: one. In the same way an error of the heading, whose column is the noise of the horizontal
//! accelerometers, is believed to be known to 1/√(2 T) rad after T seconds, 20′ in four hours. Beside what moves teach of
//! the parameters both are little, but the drift test looks at all that is learned in some minutes at rest, and there the
//! noise of a MEMS gyro is as large as Earth rate.
//!
//! With gimbals at rest the body turns with the Earth, and its specific force is gravity: neither has noise. On a ship that
//! holds for the mean attitude since the gimbals came to rest. The motion about it is left out: what a roll makes of
//! an accelerometer's errors has the period of the roll, and so has the heave, which the filter doesn't know to be a
//! sinusoid.

use crate::config::{Base, Kalman, Noise, Screening, SwayNoise};
use crate::error_model::MotionInterval;
use nalgebra::{Matrix3, Vector3};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};

/// Square of the gyros' noise over a second, in units of Earth rate's, above which the known motion is taken: 0.008 °/√h.
/// Below it n adds 0.12 σ to the drift test in four hours at most, and measured increments are better: they show motion
/// that nobody planned.
const NOISE_SHARE: f64 = 1e-3;
/// Difference from the known turn, in σ of the noise of a sub-step on any axis, above which the gyros are believed: one in
/// 10⁸ of noise alone.
const CONTRADICTED_SIGMAS: f64 = 6.0;

/// What is known of the motion.
#[derive(Clone, Debug)]
pub(super) struct KnownMotion {
    base_is_still: bool,
    /// True where horizontal specific force is gravity's part alone: the base is still, or its sway is noise of the
    /// reference.
    force_is_gravity: bool,
    gyro_variance_per_s: f64,
    /// True while the core knows of no move of the gimbals; not stored: the core tells it again.
    pub(super) gimbals_rest: bool,
    /// Sum of the attitude over the sub-steps since the gimbals came to rest, and their number.
    attitude_sum: Matrix3<f64>,
    sub_steps: u64,
}

#[cfg(feature = "state")]
octant_state::state! {
    KnownMotion {
        values: attitude_sum, sub_steps;
        parts: ;
        kept: base_is_still, force_is_gravity, gyro_variance_per_s, gimbals_rest;
        check: Self::check_count
    }
}

impl KnownMotion {
    /// `None` if the gyros are quiet.
    pub(super) fn new(kalman: &Kalman, noise: &Noise, screening: &Screening) -> Option<Self> {
        let gyro_variance_per_s = noise.angle_random_walk * noise.angle_random_walk;
        let is_noisy = gyro_variance_per_s > NOISE_SHARE * EARTH_RATE_RADPS * EARTH_RATE_RADPS;
        let base_is_still = screening.base == Base::Still;
        is_noisy.then_some(Self {
            base_is_still,
            force_is_gravity: base_is_still || kalman.sway == SwayNoise::White,
            gyro_variance_per_s,
            gimbals_rest: false,
            attitude_sum: Matrix3::zeros(),
            sub_steps: 0,
        })
    }

    #[cfg(feature = "state")]
    fn check_count(&self) -> Result<(), octant_state::StateError> {
        octant_state::check_count("sub_steps", self.sub_steps)
    }

    /// Puts the known motion in place of the measured one.
    pub(super) fn replace_measured(&mut self, interval: &mut MotionInterval, earth: &Ellipsoid) {
        let h = interval.interval_s;
        let force = Vector3::new(0.0, 0.0, -earth.gravity_mps2 * h);
        if self.force_is_gravity {
            interval.delta_velocity_n = force;
        }
        if !self.gimbals_rest {
            (self.attitude_sum, self.sub_steps) = (Matrix3::zeros(), 0);
            return;
        }
        let turn = earth.earth_rate() * h;
        if self.base_is_still {
            let turned = interval.c_nb.tr_mul(&turn);
            let limit = CONTRADICTED_SIGMAS * libm::sqrt(self.gyro_variance_per_s * h);
            if (interval.delta_theta - turned).amax() <= limit {
                interval.delta_theta = turned;
            }
            return;
        }
        self.attitude_sum += interval.c_nb;
        self.sub_steps = self.sub_steps.saturating_add(1);
        let mean = self.attitude_sum / self.sub_steps as f64;
        interval.c_nb = mean;
        interval.delta_theta = mean.tr_mul(&turn);
        interval.delta_velocity = mean.tr_mul(&force);
    }
}
