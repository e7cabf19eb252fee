//! A perfect strapdown, independent of the one of the core.

use super::EARTH_RATE;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use octant_plant::Truth;
use octant_sample::Sample;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};

const A: f64 = 6378137.0;
const E2: f64 = 6.69437999014e-3;

/// Local-level mechanisation with rotation matrices. Coning and sculling by a cubic through the
/// integral over the last two intervals (Savage 1998, sec. 2.2 and 2.3).
pub(crate) struct Strapdown {
    c_nb: Matrix3<f64>,
    start: (f64, f64),
    /// Change of latitude and longitude; added to the start, steps of nanometres would be lost.
    moved: (f64, f64),
    height: f64,
    velocity: Vector3<f64>,
    last_theta: Vector3<f64>,
    last_velocity: Vector3<f64>,
    last_acceleration: Vector3<f64>,
    hold_height: bool,
    dt: f64,
}

impl Strapdown {
    pub(crate) fn start(truth: &Truth, hold_height: bool, dt: f64) -> Self {
        let [w, x, y, z] = truth.q_nb;
        let q = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        Self {
            c_nb: q.to_rotation_matrix().into_inner(),
            start: (truth.latitude_rad, truth.longitude_rad),
            moved: (0.0, 0.0),
            height: truth.height_m,
            velocity: truth.velocity_mps.into(),
            last_theta: Vector3::zeros(),
            last_velocity: Vector3::zeros(),
            last_acceleration: Vector3::zeros(),
            hold_height,
            dt,
        }
    }

    fn latitude(&self) -> f64 {
        self.start.0 + self.moved.0
    }

    /// Radii with height, and gravity (Somigliana, second order in height).
    fn earth(latitude: f64, height: f64) -> (f64, f64, f64) {
        let s2 = latitude.sin().powi(2);
        let w = (1.0 - E2 * s2).sqrt();
        let surface = 9.7803253359 * (1.0 + 0.00193185265241 * s2) / w;
        let (f, m, h) = (1.0 / 298.257223563, 0.00344978650684, height / A);
        let gravity = surface * (1.0 - 2.0 * (1.0 + f + m - 2.0 * f * s2) * h + 3.0 * h * h);
        (A * (1.0 - E2) / (w * w * w) + height, A / w + height, gravity)
    }

    pub(crate) fn step(&mut self, sample: &Sample, first: bool) {
        let dt = self.dt;
        let theta = Vector3::from(sample.delta_theta.map(|n| f64::from(n) * DELTA_THETA_LSB_RAD));
        let velocity =
            Vector3::from(sample.delta_velocity.map(|n| f64::from(n) * DELTA_VELOCITY_LSB_MPS));
        let (before_theta, before_velocity) =
            if first { (theta, velocity) } else { (self.last_theta, self.last_velocity) };
        let turn = theta + before_theta.cross(&theta) / 12.0;
        // Exact to second order in the rotation over the interval, with the sculling term.
        let pushed = velocity
            + theta.cross(&velocity) / 2.0
            + theta.cross(&theta.cross(&velocity)) / 6.0
            + (before_theta.cross(&velocity) + before_velocity.cross(&theta)) / 12.0;
        (self.last_theta, self.last_velocity) = (theta, velocity);

        // All quantities in n are at the middle of the interval.
        let middle = self.velocity + self.last_acceleration * (0.5 * dt);
        let (rm, _, _) = Self::earth(self.latitude(), self.height);
        let latitude = self.latitude() + 0.5 * dt * middle.x / rm;
        let height = self.height - 0.5 * dt * middle.z;
        let (rm_middle, rn_middle, gravity) = Self::earth(latitude, height);
        let (s, c) = latitude.sin_cos();
        let earth_rate = Vector3::new(EARTH_RATE * c, 0.0, -EARTH_RATE * s);
        let transport = Vector3::new(
            middle.y / rn_middle,
            -middle.x / rm_middle,
            -middle.y * s / c / rn_middle,
        );
        let spin = (earth_rate + transport) * dt;
        let felt = self.c_nb * pushed;
        let change = felt - spin.cross(&felt) / 2.0
            + (Vector3::new(0.0, 0.0, gravity) - (earth_rate * 2.0 + transport).cross(&middle))
                * dt;
        let mean = self.velocity + change / 2.0 + (self.last_acceleration * dt - change) / 12.0;
        self.last_acceleration = change / dt;
        self.velocity += change;
        self.c_nb = Rotation3::new(-spin).matrix() * self.c_nb * Rotation3::new(turn).matrix();
        if self.hold_height {
            self.velocity.z = 0.0;
        } else {
            self.height -= mean.z * dt;
        }
        self.moved.0 += mean.x * dt / rm_middle;
        self.moved.1 += mean.y * dt / (rn_middle * latitude.cos());
    }

    /// Position error, m, velocity error, m/s, attitude error, rad.
    pub(crate) fn error(&self, truth: &Truth) -> (f64, f64, f64) {
        let (rm, rn, _) = Self::earth(self.latitude(), self.height);
        let position = Vector3::new(
            (self.moved.0 - (truth.latitude_rad - self.start.0)) * rm,
            (self.moved.1 - (truth.longitude_rad - self.start.1)) * rn * self.latitude().cos(),
            self.height - truth.height_m,
        );
        let velocity = self.velocity - Vector3::from(truth.velocity_mps);
        let [w, x, y, z] = truth.q_nb;
        let q = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z));
        let difference = self.c_nb * q.to_rotation_matrix().matrix().transpose();
        let skew = (difference - difference.transpose()) / 2.0;
        (position.norm(), velocity.norm(), skew.norm())
    }
}
