//! A perfect strapdown, written here and nowhere else, integrates the plant's counts and must
//! arrive at the plant's truth: increments, Coriolis, transport rate, curvature and gravity are
//! then consistent with the motion.
#![allow(clippy::unwrap_used)]

mod common;

use common::*;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use octant_plant::config::*;
use octant_plant::{Plant, Truth, motion};
use octant_sample::Sample;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};

const EARTH_RATE: f64 = 7.292115e-5;
const A: f64 = 6378137.0;
const E2: f64 = 6.69437999014e-3;

/// Local-level mechanisation with rotation matrices. Coning and sculling by a cubic through the
/// integral over the last two intervals (Savage 1998, sec. 2.2 and 2.3).
struct Strapdown {
    c_nb: Matrix3<f64>,
    start: (f64, f64),
    /// Change of latitude and longitude: added to the start, steps of nanometres would be lost.
    moved: (f64, f64),
    height: f64,
    velocity: Vector3<f64>,
    last_theta: Vector3<f64>,
    last_velocity: Vector3<f64>,
    last_acceleration: Vector3<f64>,
    hold_height: bool,
}

impl Strapdown {
    fn start(truth: &Truth, hold_height: bool) -> Self {
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

    fn step(&mut self, sample: &Sample, first: bool) {
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

        // Everything of n at the middle of the interval.
        let middle = self.velocity + self.last_acceleration * (0.5 * DT);
        let (rm, _, _) = Self::earth(self.latitude(), self.height);
        let latitude = self.latitude() + 0.5 * DT * middle.x / rm;
        let height = self.height - 0.5 * DT * middle.z;
        let (rm_middle, rn_middle, gravity) = Self::earth(latitude, height);
        let (s, c) = latitude.sin_cos();
        let earth_rate = Vector3::new(EARTH_RATE * c, 0.0, -EARTH_RATE * s);
        let transport = Vector3::new(
            middle.y / rn_middle,
            -middle.x / rm_middle,
            -middle.y * s / c / rn_middle,
        );
        let spin = (earth_rate + transport) * DT;
        let felt = self.c_nb * pushed;
        let change = felt - spin.cross(&felt) / 2.0
            + (Vector3::new(0.0, 0.0, gravity) - (earth_rate * 2.0 + transport).cross(&middle))
                * DT;
        let mean = self.velocity + change / 2.0 + (self.last_acceleration * DT - change) / 12.0;
        self.last_acceleration = change / DT;
        self.velocity += change;
        self.c_nb = Rotation3::new(-spin).matrix() * self.c_nb * Rotation3::new(turn).matrix();
        if self.hold_height {
            self.velocity.z = 0.0;
        } else {
            self.height -= mean.z * DT;
        }
        self.moved.0 += mean.x * DT / rm_middle;
        self.moved.1 += mean.y * DT / (rn_middle * latitude.cos());
    }

    /// Position error, m, velocity error, m/s, attitude error, rad.
    fn error(&self, truth: &Truth) -> (f64, f64, f64) {
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

/// Walks through the commands, each for its seconds; the worst errors seen at whole seconds.
fn worst(config: &Config, commands: &[(f64, f64, u64)], hold_height: bool) -> (f64, f64, f64) {
    let mut plant = Plant::new(config).unwrap();
    let mut strapdown = Strapdown::start(&plant.truth(), hold_height);
    let mut worst = (0.0f64, 0.0f64, 0.0f64);
    for (azimuth, roll, seconds) in commands {
        let target = command(*azimuth, *roll);
        for _ in 0..seconds * 200 {
            let step = plant.step(&target);
            assert_eq!(step.sample.status.bits(), 0);
            strapdown.step(&step.sample, step.sample.sequence == 1);
            if step.sample.sequence.is_multiple_of(200) {
                let error = strapdown.error(&plant.truth());
                worst = (worst.0.max(error.0), worst.1.max(error.1), worst.2.max(error.2));
            }
        }
    }
    worst
}

#[test]
fn dockside_for_ten_minutes() {
    let mut config = perfect();
    let mut ship = motion::dockside_default(7);
    ship.mean = CaseAttitude { heading_rad: 0.7, pitch_rad: 0.02, roll_rad: -0.01 };
    ship.mooring_offset_m = [120.0, -80.0, 1.5];
    config.motion = Motion::Dockside(ship);
    let (position, velocity, attitude) = worst(&config, &[(0.0, 0.0, 600)], false);
    println!("{position:.3e} m {velocity:.3e} m/s {attitude:.3e} rad");
    assert!(position < 1e-3 && velocity < 1e-5 && attitude < 1e-8);
}

#[test]
fn dockside_with_moves() {
    let mut config = perfect();
    config.motion = Motion::Dockside(motion::dockside_iso_8728(3));
    config.turntable.non_orthogonality_rad = 1e-3;
    config.turntable.backlash_rad = 2e-4;
    let moves = [(0.0, 90.0, 60), (90.0, 90.0, 60), (90.0, -45.0, 60), (180.0, 0.0, 120)];
    let (position, velocity, attitude) = worst(&config, &moves, false);
    println!("{position:.3e} m {velocity:.3e} m/s {attitude:.3e} rad");
    assert!(position < 1e-3 && velocity < 2e-5 && attitude < 1e-8);
}

#[test]
fn static_with_moves_for_an_hour() {
    let mut config = perfect();
    config.turntable.non_orthogonality_rad = -2e-3;
    config.motion =
        Motion::Static(CaseAttitude { heading_rad: 1.1, pitch_rad: 0.03, roll_rad: -0.02 });
    let moves: Vec<(f64, f64, u64)> = (0..24)
        .map(|i| (f64::from((i + 1) / 2 % 4) * 90.0, f64::from(i / 2 % 3) * 135.0 - 90.0, 150))
        .collect();
    let (position, velocity, attitude) = worst(&config, &moves, true);
    println!("{position:.3e} m {velocity:.3e} m/s {attitude:.3e} rad");
    assert!(position < 1e-3 && velocity < 1e-6 && attitude < 1e-8);
}
