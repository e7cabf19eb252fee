//! A small instrument for tests: the error model, two gimbals and counts, independent of the plant.
#![allow(unreachable_pub)]

use octant_calibration::config::Site;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::{c_cb, c_nc, quaternion_from_matrix};
use octant_earth::rotation::log;
use octant_earth::units::{ARCSEC, DEG, DEG_PER_HOUR, DEG_PER_HOUR_PER_G, MICRO_G, PPM};
use octant_earth::{Matrix3, Vector3};
use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{DeviceTime, GimbalAngles, Parameters, Sample};

pub const PERIOD_NS: u64 = 20_000_000;
const DT_S: f64 = PERIOD_NS as f64 * 1e-9;
/// Gyro angle random walk: 0.0007 °/√h.
pub const ARW: f64 = 0.0007 * octant_earth::units::DEG_PER_SQRT_HOUR;
/// Accelerometer noise density: 50 µg/√Hz.
pub const VRW: f64 = 50.0 * MICRO_G;
pub const SITE: Site =
    Site { latitude_rad: 30.5 * DEG, longitude_rad: 114.0 * DEG, height_m: 30.0 };
pub const HEADING_RAD: f64 = 0.3;

/// Six positions: (azimuth, roll) in degrees.
pub const SIX: &[(f64, f64)] = &[
    (0.0, 0.0),
    (0.0, 90.0),
    (0.0, 180.0),
    (0.0, 270.0),
    (0.0, 180.0),
    (0.0, 90.0),
    (90.0, 90.0),
    (180.0, 90.0),
    (270.0, 90.0),
    (180.0, 90.0),
    (90.0, 90.0),
    (90.0, 180.0),
    (90.0, 270.0),
    (90.0, 180.0),
    (90.0, 90.0),
    (90.0, 0.0),
    (0.0, 0.0),
];
pub const EIGHT: &[(f64, f64)] = &[
    (0.0, 0.0),
    (0.0, 45.0),
    (0.0, 90.0),
    (0.0, 180.0),
    (0.0, 270.0),
    (0.0, 180.0),
    (0.0, 90.0),
    (90.0, 90.0),
    (180.0, 90.0),
    (270.0, 90.0),
    (180.0, 90.0),
    (90.0, 90.0),
    (90.0, 180.0),
    (90.0, 270.0),
    (90.0, 180.0),
    (90.0, 90.0),
    (90.0, 45.0),
    (90.0, 0.0),
    (0.0, 0.0),
];
/// Attitudes in general position: the faces, the edges and some corners of a cube.
pub const GENERAL: &[(f64, f64)] = &[
    (0.0, 0.0),
    (0.0, 90.0),
    (0.0, 180.0),
    (0.0, 270.0),
    (45.0, 270.0),
    (45.0, 180.0),
    (45.0, 90.0),
    (45.0, 45.0),
    (135.0, 45.0),
    (135.0, 90.0),
    (135.0, 225.0),
    (90.0, 225.0),
    (90.0, 90.0),
    (180.0, 90.0),
    (180.0, 45.0),
    (270.0, 45.0),
    (270.0, 90.0),
    (270.0, 135.0),
    (210.0, 135.0),
    (210.0, 60.0),
];

/// Errors of the size of Table 1, all different.
pub fn truth() -> Parameters {
    Parameters {
        gyro_bias: [5.0, -3.0, 4.0].map(|v| v * 1e-3 * DEG_PER_HOUR),
        gyro_scale: [25.0, -18.0, 11.0].map(|v| v * PPM),
        gyro_misalignment: [30.0, -22.0, 15.0, 38.0, -27.0, 9.0].map(|v| v * ARCSEC),
        g_dependent: [5.0, -3.0, 2.0, 4.0, -6.0, 1.0, -2.0, 7.0, 3.0]
            .map(|v| v * 1e-4 * DEG_PER_HOUR_PER_G),
        accel_bias: [90.0, -110.0, 60.0].map(|v| v * MICRO_G),
        accel_scale: [-20.0, 28.0, 13.0].map(|v| v * PPM),
        accel_misalignment: [35.0, -19.0, 24.0].map(|v| v * ARCSEC),
    }
}

/// Generates noise by SplitMix64 and sums of twelve uniforms, without a dependency.
#[derive(Clone)]
pub struct Noise(u64);

impl Noise {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn gaussian(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

pub struct Instrument {
    parameters: Parameters,
    arw: f64,
    vrw: f64,
    noise: Noise,
    pub earth_rate: bool,
    /// Error of the encoders at each stop, 1σ, rad.
    pub encoder_sigma_rad: f64,
    /// Rate of the case in n, rad/s, from a sample on.
    pub turn: Option<(u64, Vector3<f64>)>,
    carry: [Accumulator; 6],
    sequence: u64,
}

fn matrix(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| rows[i][j])
}

impl Instrument {
    pub fn new(parameters: Parameters, arw: f64, vrw: f64, seed: u64) -> Self {
        Self {
            parameters,
            arw,
            vrw,
            noise: Noise::new(seed),
            earth_rate: true,
            encoder_sigma_rad: 0.0,
            turn: None,
            carry: [Accumulator::default(); 6],
            sequence: 0,
        }
    }

    /// Visits the stops: a dwell at each, moves at 10 °/s, one gimbal after the other.
    pub fn run(
        mut self,
        stops: &[(f64, f64)],
        dwell_s: f64,
        mut each: impl FnMut(&Sample, f64, bool),
    ) {
        let dwell = (dwell_s / DT_S + 0.5) as usize;
        let (mut azimuth, mut roll) = (stops[0].0 * DEG, stops[0].1 * DEG);
        for &(to_azimuth, to_roll) in stops {
            for (target, is_azimuth) in [(to_azimuth * DEG, true), (to_roll * DEG, false)] {
                let angle = target - if is_azimuth { azimuth } else { roll };
                let steps = (angle.abs() / (10.0 * DEG) / DT_S + 0.5) as usize;
                for _ in 0..steps {
                    let from = (azimuth, roll);
                    let part = angle / steps as f64;
                    if is_azimuth {
                        azimuth += part;
                    } else {
                        roll += part;
                    }
                    let sample = self.sample(from, (azimuth, roll), (0.0, 0.0));
                    each(&sample, DT_S, false);
                }
            }
            let encoder = (
                self.encoder_sigma_rad * self.noise.gaussian(),
                self.encoder_sigma_rad * self.noise.gaussian(),
            );
            for _ in 0..dwell {
                let sample = self.sample((azimuth, roll), (azimuth, roll), encoder);
                each(&sample, DT_S, true);
            }
        }
    }

    fn sample(&mut self, from: (f64, f64), to: (f64, f64), encoder: (f64, f64)) -> Sample {
        let earth = Ellipsoid::at(SITE.latitude_rad, SITE.height_m);
        let case_at = |sequence: u64| {
            let turned = self.turn.map_or(Vector3::zeros(), |(from, rate)| {
                rate * (sequence.saturating_sub(from) as f64 * DT_S)
            });
            let turned = octant_earth::rotation::exp(&turned).to_rotation_matrix();
            turned.into_inner() * c_nc(HEADING_RAD, 0.0, 0.0)
        };
        let (case, case_after) = (case_at(self.sequence), case_at(self.sequence + 1));
        let rate_n = if self.earth_rate { earth.earth_rate() } else { Vector3::zeros() };
        let (before, after) = (case * c_cb(from.0, from.1), case_after * c_cb(to.0, to.1));
        // Rotation of the body in inertial space over the sample: its own, and that of the Earth.
        let earth_turn = octant_earth::rotation::exp(&(rate_n * DT_S)).to_rotation_matrix();
        let turn = before.transpose() * earth_turn * after;
        let rate = log(&quaternion_from_matrix(&turn)) / DT_S;
        let middle = case * c_cb(0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
        let force = middle.transpose() * Vector3::new(0.0, 0.0, -earth.gravity_mps2);
        let p = &self.parameters;
        let rate_error = matrix(p.gyro_matrix()) * rate
            + Vector3::from(p.gyro_bias)
            + matrix(p.g_matrix()) * force;
        let force_error = matrix(p.accel_matrix()) * force + Vector3::from(p.accel_bias);
        let root = DT_S.sqrt();
        self.sequence += 1;
        let mut sample = Sample {
            sequence: self.sequence,
            device_time: DeviceTime::from_ns(self.sequence * PERIOD_NS),
            gimbal: GimbalAngles::from_rad(to.0 + encoder.0, to.1 + encoder.1),
            ..Sample::default()
        };
        for axis in 0..3 {
            let theta =
                (rate[axis] + rate_error[axis]) * DT_S + self.arw * root * self.noise.gaussian();
            let velocity =
                (force[axis] + force_error[axis]) * DT_S + self.vrw * root * self.noise.gaussian();
            sample.delta_theta[axis] = self.carry[axis].count(theta / DELTA_THETA_LSB_RAD).value;
            sample.delta_velocity[axis] =
                self.carry[axis + 3].count(velocity / DELTA_VELOCITY_LSB_MPS).value;
        }
        sample
    }
}
