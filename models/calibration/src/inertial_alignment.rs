//! Alignment in the inertial frame: attitude from the way in which gravity turns, on a base that may turn.
//!
//! An average of the gyros takes any turn of the base for Earth rate: 0.2° in half an hour is 0.4 °/h, and 1.8° of
//! heading at 30° latitude. Here the gyros only keep the body's frame at the start, b0, which is at rest in inertial
//! space, and the specific force summed there shows gravity turning with the Earth (Y. Wu, X. Pan, *Velocity/position
//! integration formula, part I*, IEEE Trans. Aerospace and Electronic Systems, 2013). Whatever the base turns, both see.
//!
//! With n0, the frame n at the start, at rest in inertial space too:
//!
//! `α(t) = ∫ C_b0b f_b dt = v + C_b0n0 β(t)`, `β(t) = ∫ exp(ω_ie τ) (−g_n) dτ`
//!
//! Once a second `α − C_b0n0 β` is fitted by `v + a0 t + a1 t²/2`: `v` is the velocity that a swinging base has at the
//! start, and `a0` and `a1` correct the specific force there, `f0`, and its rate of change, `f1 = ω_ie × f0`. Down is opposite to `f0`; east is the direction of `f1`, and its length
//! has to be `g Ω cos L`: a gyro error along north shows there. One along east is an error of the heading that no
//! alignment in one attitude can see; its size is that of [`AlignmentSigma`].

use nalgebra::{Matrix3, UnitQuaternion, Vector3};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_earth::frames::quaternion_from_matrix;
use octant_earth::rotation;
use octant_sample::parameters::ParameterGroup;

use crate::config::{Base, CoreConfig, Estimator};

/// Shortest alignment, s: ten points for a fit of three.
pub const SHORTEST_S: f64 = 10.0;

/// Largest deviation of the specific force from gravity, as a part of it: that of rough sensors.
pub(crate) const FORCE_SHARE: f64 = 0.01;
/// Largest deviation of the horizontal rate from the Earth's, in standard deviations.
pub(crate) const RATE_SIGMAS: f64 = 5.0;
/// Largest standard deviation of a heading that the core navigates with, rad: 1°.
pub(crate) const HEADING_SIGMA_MAX_RAD: f64 = 0.017_453_292_519_943_295;

/// Variance of the fitted rate of change, for unit noise and unit time: the fit is the integral with the weight
/// `360 t² − 360 t + 60` over `α`, which is the noise integrated twice (gyros) or once (accelerometers).
const FIT_OF_GYRO_NOISE: f64 = 10.0 / 7.0;
const FIT_OF_ACCELEROMETER_NOISE: f64 = 120.0 / 7.0;
/// Variance of the fitted force at the start, likewise, with the weight `−180 t² + 192 t − 36`; at the end it is the
/// same.
const FORCE_OF_ACCELEROMETER_NOISE: f64 = 192.0 / 35.0;
/// Variance of the tilt at the end by gyro noise: an angle at the time `s` turns it by `18 s² − 32 s³ + 15 s⁴`.
const TILT_OF_GYRO_NOISE: f64 = 43.0 / 35.0;
/// Weight of the first fit at both ends, with which a swing enters: root mean square over its phases there.
const FIT_OF_SWING: f64 = 60.0;

/// What an alignment can be trusted with, 1σ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignmentSigma {
    /// Rate about each horizontal axis, rad/s.
    pub rate_radps: f64,
    /// Attitude error φ north, east, down, rad.
    pub attitude_rad: [f64; 3],
}

impl AlignmentSigma {
    /// Computes the standard deviations of an alignment over `duration_s`: by the noise of the sensors, the swing of
    /// the base, and the sensors' errors as far as they are unknown, which is the filter's prior.
    #[must_use]
    pub fn of(config: &CoreConfig, duration_s: f64) -> Self {
        let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
        let gravity = earth.gravity_mps2;
        let prior =
            |group| match config.calibration.as_ref().map(|calibration| &calibration.estimator) {
                Some(Estimator::Kalman(kalman)) if kalman.estimated[group as usize] => {
                    kalman.prior.of(group)
                }
                _ => 0.0,
            };
        let square = |value: f64| value * value;
        let arw = square(config.noise.angle_random_walk);
        let vrw = square(config.noise.velocity_random_walk / gravity);
        let swing = match config.screening.base {
            Base::Moving(motion) if motion.jerk_mps3 > 0.0 => {
                let amplitude_m = motion.force_mps2 * square(motion.force_mps2 / motion.jerk_mps3);
                FIT_OF_SWING * amplitude_m / (gravity * duration_s * square(duration_s))
            }
            _ => 0.0,
        };
        let sensors = square(prior(ParameterGroup::GyroBias))
            + square(prior(ParameterGroup::GDependent) * gravity)
            + square(prior(ParameterGroup::GyroMisalignment) * EARTH_RATE_RADPS);
        let rate = FIT_OF_GYRO_NOISE * arw / duration_s
            + FIT_OF_ACCELEROMETER_NOISE * vrw / (duration_s * square(duration_s))
            + square(swing)
            + sensors;
        let tilt = square(prior(ParameterGroup::AccelBias) / gravity)
            + square(prior(ParameterGroup::AccelMisalignment))
            + FORCE_OF_ACCELEROMETER_NOISE * vrw / duration_s
            + (TILT_OF_GYRO_NOISE * arw + sensors * duration_s) * duration_s;
        let tangent = libm::tan(config.site.latitude_rad);
        let heading = rate / square(earth.earth_rate().x) + tilt * square(tangent);
        let (tilt_rad, heading_rad) = (libm::sqrt(tilt), libm::sqrt(heading));
        Self { rate_radps: libm::sqrt(rate), attitude_rad: [tilt_rad, tilt_rad, heading_rad] }
    }
}

/// Reason why an alignment found no attitude that can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub enum AlignmentRefusal {
    /// It was too short, or a number was not finite.
    #[error("the alignment has no attitude: expected {SHORTEST_S} s of finite increments at least")]
    Nothing,
    /// The specific force isn't that of gravity.
    #[error(
        "the specific force during the alignment is {found:.4} m/s², and gravity at the site is {expected:.4} m/s²: \
         expected the same within 1 %"
    )]
    Force {
        /// Specific force at the start, m/s².
        found: f64,
        /// Gravity at the site, m/s².
        expected: f64,
    },
    /// Gravity turned at another rate than the Earth.
    #[error(
        "gravity turned by {:.3} deg/h during the alignment, expected {:.3} ± {:.3} deg/h at this latitude: \
         the gyros are worse than stated, or the base moved",
        dph(*found), dph(*expected), dph(RATE_SIGMAS * sigma)
    )]
    Rate {
        /// Horizontal rate found, rad/s.
        found: f64,
        /// Horizontal rate of the Earth, rad/s.
        expected: f64,
        /// Its standard deviation, rad/s.
        sigma: f64,
    },
    /// North can't be found well enough.
    #[error(
        "an alignment of {duration_s} s finds north with a standard deviation of {:.1} deg only, at most 1 deg is \
         accepted: align for longer, or hand the attitude over",
        sigma_rad.to_degrees()
    )]
    Heading {
        /// Time of the alignment, s.
        duration_s: f64,
        /// Standard deviation of the heading, rad.
        sigma_rad: f64,
    },
}

/// Converts rad/s to deg/h.
pub(crate) fn dph(rate_radps: f64) -> f64 {
    rate_radps.to_degrees() * 3600.0
}

/// Sums over the points of an alignment, one a second, in the powers of time 1, τ and τ²/2.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
struct Sums {
    /// Of the products of two powers.
    powers: Matrix3<f64>,
    /// Of α and β times a power each: one column a power.
    alpha: Matrix3<f64>,
    beta: Matrix3<f64>,
}

/// An alignment under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertialAlignment {
    /// Earth rate, rad/s, and specific force at rest, m/s², both in n.
    earth_rate: Vector3<f64>,
    force: Vector3<f64>,
    duration_s: f64,
    sigma: AlignmentSigma,
    /// Attitude of the body in its frame at the start, `q_b0b`, and the specific force summed there, m/s.
    q_b0b: UnitQuaternion<f64>,
    alpha: Vector3<f64>,
    elapsed_s: f64,
    next_point_s: f64,
    sums: Sums,
}

#[cfg(feature = "state")]
octant_state::state! {
    InertialAlignment {
        values: q_b0b, alpha, elapsed_s, next_point_s, sums;
        parts: ;
        kept: earth_rate, force, duration_s, sigma
    }
}

impl InertialAlignment {
    /// Makes an alignment over `duration_s`.
    #[must_use]
    pub fn new(config: &CoreConfig, duration_s: f64) -> Self {
        let earth = Ellipsoid::at(config.site.latitude_rad, config.site.height_m);
        Self {
            earth_rate: earth.earth_rate(),
            force: Vector3::new(0.0, 0.0, -earth.gravity_mps2),
            duration_s,
            sigma: AlignmentSigma::of(config, duration_s),
            q_b0b: UnitQuaternion::identity(),
            alpha: Vector3::zeros(),
            elapsed_s: 0.0,
            next_point_s: 1.0,
            sums: Sums::default(),
        }
    }

    /// Takes the compensated increments (rad, m/s, in b) of one sample over `dt_s`.
    pub fn step(&mut self, delta_theta: &Vector3<f64>, delta_velocity: &Vector3<f64>, dt_s: f64) {
        // While the velocity accrues, the body turns: by half of its turn on the average.
        self.alpha += self.q_b0b * (delta_velocity + delta_theta.cross(delta_velocity) * 0.5);
        self.q_b0b *= rotation::exp(delta_theta);
        self.elapsed_s += dt_s;
        if self.elapsed_s >= self.next_point_s {
            self.next_point_s += 1.0;
            self.q_b0b.renormalize_fast();
            self.add_point();
        }
    }

    fn add_point(&mut self) {
        // As a part of the whole: sums of powers of seconds would lose digits.
        let time = self.elapsed_s / self.duration_s;
        let powers = Vector3::new(1.0, time, 0.5 * time * time);
        self.sums.powers += powers * powers.transpose();
        self.sums.alpha += self.alpha * powers.transpose();
        self.sums.beta += self.beta() * powers.transpose();
    }

    /// Specific force at rest summed in n0, m/s.
    fn beta(&self) -> Vector3<f64> {
        let rate = self.earth_rate.norm();
        let axis = self.earth_rate / rate;
        let (t, angle) = (self.elapsed_s, rate * self.elapsed_s);
        let (once, twice) = (axis.cross(&self.force), axis.cross(&axis.cross(&self.force)));
        let half_sine = libm::sin(0.5 * angle);
        self.force * t
            + once * (2.0 * half_sine * half_sine / rate)
            + twice * ((angle - libm::sin(angle)) / rate)
    }

    /// Computes the attitude `q_nb` at the last sample.
    ///
    /// # Errors
    /// If what was measured doesn't fit a place at this latitude, or can't tell where north is.
    pub fn finish(&self) -> Result<UnitQuaternion<f64>, AlignmentRefusal> {
        let [_, _, heading_rad] = self.sigma.attitude_rad;
        if !(heading_rad <= HEADING_SIGMA_MAX_RAD) {
            let duration_s = libm::round(self.elapsed_s);
            return Err(AlignmentRefusal::Heading { duration_s, sigma_rad: heading_rad });
        }
        if !(self.elapsed_s >= SHORTEST_S - 0.5) {
            return Err(AlignmentRefusal::Nothing);
        }
        let turning = self.earth_rate.cross(&self.force);
        let inverse = self.sums.powers.try_inverse().ok_or(AlignmentRefusal::Nothing)?;
        let mut c_b0n0 = Matrix3::zeros();
        let (mut f0, mut f1) = (Vector3::zeros(), Vector3::zeros());
        // The first fit is of α itself, whose third power of time the later ones know.
        for _ in 0..ITERATIONS {
            let fit = (self.sums.alpha - c_b0n0 * self.sums.beta) * inverse;
            f0 = c_b0n0 * self.force + fit.column(1) / self.duration_s;
            f1 = c_b0n0 * turning + fit.column(2) / (self.duration_s * self.duration_s);
            c_b0n0 = attitude_from(&f0, &f1).ok_or(AlignmentRefusal::Nothing)?;
        }
        let (found, expected) = (f0.norm(), self.force.norm());
        if !((found / expected - 1.0).abs() <= FORCE_SHARE) {
            return Err(AlignmentRefusal::Force { found, expected });
        }
        let (found, expected) = (f0.cross(&f1).norm() / (found * found), self.earth_rate.x);
        let sigma = self.sigma.rate_radps;
        if !((found - expected).abs() <= RATE_SIGMAS * sigma) {
            return Err(AlignmentRefusal::Rate { found, expected, sigma });
        }
        let q_n0b0 = quaternion_from_matrix(&c_b0n0.transpose());
        let q_nn0 = rotation::exp(&(self.earth_rate * -self.elapsed_s));
        Ok(q_nn0 * q_n0b0 * self.q_b0b)
    }
}

/// Fits until the attitude moves no more: each is closer by the square of the angle that the Earth has turned.
const ITERATIONS: usize = 8;

/// `C_b0n0` from the specific force at the start and its rate of change, both in b0.
fn attitude_from(f0: &Vector3<f64>, f1: &Vector3<f64>) -> Option<Matrix3<f64>> {
    let down = -f0.try_normalize(1e-3)?;
    let east = (f1 - down * down.dot(f1)).try_normalize(1e-9)?;
    let c_b0n0 = Matrix3::from_columns(&[east.cross(&down), east, down]);
    c_b0n0.iter().all(|value| value.is_finite()).then_some(c_b0n0)
}
