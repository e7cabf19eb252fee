//! Floor of the drift by the random walk: the drift of a free inertial solution with exact parameters
//! and an exact initial attitude, on a static base with the height held.
//!
//! Phi-angle error model with seven states, φ (north, east, down), δv (north, east), δL, δλ:
//!
//! ```text
//! φ̇ = −ω_ie × φ + δω_ie + δω_en − ε      δω_ie = Ω (−sin L, 0, −cos L) δL
//! δv̇ = f × φ − 2ω_ie × δv + ∇            f = (0, 0, −g)
//! δL̇ = δv_N / (R_M + h)                   δλ̇ = δv_E / ((R_N + h) cos L)
//! ```
//!
//! Turning the body doesn't change white noise, so the rotation in navigation is not modelled.

use nalgebra::{SMatrix, SVector};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_earth::units::{ARCMIN, NAUTICAL_MILE_M};
use rand_philox::Philox;
use serde::{Deserialize, Serialize};

/// Number of states.
const STATES: usize = 7;
type Matrix = SMatrix<f64, STATES, STATES>;
type State = SVector<f64, STATES>;

/// Step of the propagation, s: 1/84 of a Schuler period.
const STEP_S: f64 = 60.0;

/// Error of a sensor, constant in n: gyro (rad/s) north, east, down, accelerometer (m/s²) north,
/// east.
pub type SensorError = [f64; 5];

/// Free inertial error model of one site with the noise of its sensors.
#[derive(Clone, Debug)]
pub struct Floor {
    dynamics: Matrix,
    /// Φ over one step.
    transition: Matrix,
    /// Covariance added by one step.
    noise: Matrix,
    angle_random_walk: f64,
    velocity_random_walk: f64,
    /// Sine and cosine of the heading of the case.
    heading_sin_cos: (f64, f64),
    /// North and east distance of one radian of latitude and longitude, m.
    metres_per_rad: [f64; 2],
}

/// σ of latitude and longitude error at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FloorPoint {
    /// Hours since the start of the navigation.
    pub hours: f64,
    /// 1σ of the latitude error, arcmin.
    pub latitude_arcmin: f64,
    /// 1σ of the longitude error, arcmin.
    pub longitude_arcmin: f64,
    /// 1σ of attitude and velocity; null in files from before they were kept.
    #[serde(default)]
    pub solution: Option<SolutionValues>,
}

/// A value of each error of attitude and velocity: its 1σ, or its largest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolutionValues {
    /// Heading error, arcmin.
    pub heading_arcmin: f64,
    /// Pitch error, arcmin.
    pub pitch_arcmin: f64,
    /// Roll error, arcmin.
    pub roll_arcmin: f64,
    /// Error of the velocity to the north, m/s.
    pub velocity_north_mps: f64,
    /// Error of the velocity to the east, m/s.
    pub velocity_east_mps: f64,
}

impl SolutionValues {
    /// Values in the order heading, pitch, roll (rad), north, east (m/s).
    fn of_si([heading, pitch, roll, north, east]: [f64; 5]) -> Self {
        Self {
            heading_arcmin: heading / ARCMIN,
            pitch_arcmin: pitch / ARCMIN,
            roll_arcmin: roll / ARCMIN,
            velocity_north_mps: north,
            velocity_east_mps: east,
        }
    }

    /// Value of an error by the name that [`crate::summary::NavigationScore::errors`] gives it.
    #[must_use]
    pub fn of(&self, name: &str) -> Option<f64> {
        match name {
            "heading" => Some(self.heading_arcmin),
            "pitch" => Some(self.pitch_arcmin),
            "roll" => Some(self.roll_arcmin),
            "north" => Some(self.velocity_north_mps),
            "east" => Some(self.velocity_east_mps),
            _ => None,
        }
    }
}

/// Floor over one navigation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FloorSummary {
    /// 1σ of the latitude error at the end, arcmin.
    pub latitude_final_arcmin: f64,
    /// 1σ of the longitude error at the end, arcmin.
    pub longitude_final_arcmin: f64,
    /// Expected time-RMS of the latitude error, √(1/T ∫ σ² dt), arcmin.
    pub latitude_rms_arcmin: f64,
    /// Expected time-RMS of the longitude error, arcmin.
    pub longitude_rms_arcmin: f64,
    /// Expected time-RMS of the radial error, nmi.
    pub radial_rms_nmi: f64,
    /// Attitude of a level case, and velocity; null in files from before they were scored.
    #[serde(default)]
    pub solution: Option<SolutionFloor>,
    /// σ over time, about 150 points.
    pub sigma: Vec<FloorPoint>,
}

/// Floor of attitude and velocity over one navigation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolutionFloor {
    /// Heading error, arcmin.
    pub heading_arcmin: FloorValue,
    /// Pitch error, arcmin.
    pub pitch_arcmin: FloorValue,
    /// Roll error, arcmin.
    pub roll_arcmin: FloorValue,
    /// Error of the velocity to the north, m/s.
    pub velocity_north_mps: FloorValue,
    /// Error of the velocity to the east, m/s.
    pub velocity_east_mps: FloorValue,
}

impl SolutionFloor {
    /// Value of an error by the name that [`crate::summary::NavigationScore::errors`] gives it.
    #[must_use]
    pub fn of(&self, name: &str) -> Option<FloorValue> {
        match name {
            "heading" => Some(self.heading_arcmin),
            "pitch" => Some(self.pitch_arcmin),
            "roll" => Some(self.roll_arcmin),
            "north" => Some(self.velocity_north_mps),
            "east" => Some(self.velocity_east_mps),
            _ => None,
        }
    }
}

/// Floor of one error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FloorValue {
    /// Expected time-RMS, √(1/T ∫ σ² dt).
    pub rms: f64,
    /// 1σ at the end.
    pub r#final: f64,
}

/// Root mean square over many runs of the largest error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MaximumFloor {
    /// Length of the navigation, h.
    pub hours: f64,
    /// Value for the latitude error, arcmin.
    pub latitude_arcmin: f64,
    /// Value for the longitude error, arcmin.
    pub longitude_arcmin: f64,
    /// Values for attitude and velocity.
    pub solution: SolutionValues,
}

impl Floor {
    /// Makes the model at a latitude (rad) and height (m), with angle random walk (rad/√s) and
    /// accelerometer noise density ((m/s²)/√Hz).
    #[must_use]
    pub fn new(
        latitude_rad: f64,
        height_m: f64,
        angle_random_walk: f64,
        velocity_random_walk: f64,
    ) -> Self {
        let earth = Ellipsoid::at(latitude_rad, height_m);
        let (s, c) = (earth.sin_latitude, earth.cos_latitude);
        let (rm, rn, g) = (earth.meridian_radius_m, earth.transverse_radius_m, earth.gravity_mps2);
        let omega = EARTH_RATE_RADPS;
        let mut f = Matrix::zeros();
        // −ω_ie × φ with ω_ie = Ω (cos L, 0, −sin L).
        f[(0, 1)] = -omega * s;
        f[(1, 0)] = omega * s;
        f[(1, 2)] = omega * c;
        f[(2, 1)] = -omega * c;
        // Terms of δω_en and δω_ie.
        f[(0, 4)] = 1.0 / rn;
        f[(1, 3)] = -1.0 / rm;
        f[(2, 4)] = -s / c / rn;
        f[(0, 5)] = -omega * s;
        f[(2, 5)] = -omega * c;
        // Terms of f × φ and Coriolis.
        f[(3, 1)] = g;
        f[(4, 0)] = -g;
        f[(3, 4)] = -2.0 * omega * s;
        f[(4, 3)] = 2.0 * omega * s;
        f[(5, 3)] = 1.0 / rm;
        f[(6, 4)] = 1.0 / (rn * c);
        let (transition, noise) =
            discretize(&f, &noise_density(angle_random_walk, velocity_random_walk));
        Self {
            dynamics: f,
            transition,
            noise,
            angle_random_walk,
            velocity_random_walk,
            heading_sin_cos: (0.0, 1.0),
            metres_per_rad: [rm, rn * c],
        }
    }

    /// Sets the heading of the case, rad, which tells pitch from roll; 0 without it.
    #[must_use]
    pub fn at_heading(self, heading_rad: f64) -> Self {
        Self { heading_sin_cos: libm::sincos(heading_rad), ..self }
    }

    /// Variances of heading, pitch, roll, velocity north and east of a level case, SI.
    fn variances(&self, p: &Matrix) -> [f64; 5] {
        let (s, c) = self.heading_sin_cos;
        // Roll is about the bow (c, s), pitch about starboard (−s, c).
        let about = |[north, east]: [f64; 2]| {
            north * north * p[(0, 0)] + 2.0 * north * east * p[(0, 1)] + east * east * p[(1, 1)]
        };
        [p[(2, 2)], about([-s, c]), about([c, s]), p[(3, 3)], p[(4, 4)]]
            .map(|variance| variance.max(0.0))
    }

    /// 1σ of attitude and velocity of a level case.
    fn sigmas(&self, p: &Matrix) -> SolutionValues {
        SolutionValues::of_si(self.variances(p).map(libm::sqrt))
    }

    /// Floor of attitude and velocity: from the mean covariance over the navigation, and the last one.
    fn solution(&self, mean: &Matrix, last: &Matrix) -> SolutionFloor {
        let (mean, last) = (self.sigmas(mean), self.sigmas(last));
        SolutionFloor {
            heading_arcmin: FloorValue { rms: mean.heading_arcmin, r#final: last.heading_arcmin },
            pitch_arcmin: FloorValue { rms: mean.pitch_arcmin, r#final: last.pitch_arcmin },
            roll_arcmin: FloorValue { rms: mean.roll_arcmin, r#final: last.roll_arcmin },
            velocity_north_mps: FloorValue {
                rms: mean.velocity_north_mps,
                r#final: last.velocity_north_mps,
            },
            velocity_east_mps: FloorValue {
                rms: mean.velocity_east_mps,
                r#final: last.velocity_east_mps,
            },
        }
    }

    /// Floor of a navigation of `duration_s`.
    #[must_use]
    pub fn summary(&self, duration_s: f64) -> FloorSummary {
        let steps = (duration_s / STEP_S).max(1.0) as u32;
        let every = (steps / 150).max(1);
        let mut p = Matrix::zeros();
        let mut sigma = vec![FloorPoint {
            hours: 0.0,
            latitude_arcmin: 0.0,
            longitude_arcmin: 0.0,
            solution: Some(SolutionValues::default()),
        }];
        let (mut latitude, mut longitude, mut sum) = (0.0, 0.0, Matrix::zeros());
        for k in 1..=steps {
            p = self.transition * p * self.transition.transpose() + self.noise;
            latitude += p[(5, 5)];
            longitude += p[(6, 6)];
            sum += p;
            if k % every == 0 || k == steps {
                sigma.push(FloorPoint {
                    hours: f64::from(k) * STEP_S / 3600.0,
                    latitude_arcmin: libm::sqrt(p[(5, 5)]) / ARCMIN,
                    longitude_arcmin: libm::sqrt(p[(6, 6)]) / ARCMIN,
                    solution: Some(self.sigmas(&p)),
                });
            }
        }
        let (latitude, longitude) = (latitude / f64::from(steps), longitude / f64::from(steps));
        let [north, east] = self.metres_per_rad;
        FloorSummary {
            latitude_final_arcmin: libm::sqrt(p[(5, 5)]) / ARCMIN,
            longitude_final_arcmin: libm::sqrt(p[(6, 6)]) / ARCMIN,
            latitude_rms_arcmin: libm::sqrt(latitude) / ARCMIN,
            longitude_rms_arcmin: libm::sqrt(longitude) / ARCMIN,
            radial_rms_nmi: libm::sqrt(latitude * north * north + longitude * east * east)
                / NAUTICAL_MILE_M,
            solution: Some(self.solution(&(sum / f64::from(steps)), &p)),
            sigma,
        }
    }

    /// Root mean square over `members` simulated runs of the largest error up to each of `hours`.
    /// A maximum has no closed form; the same seed gives the same numbers. Errors are looked at once a
    /// minute: the largest one of a Brownian motion, as heading is, is missed by 1 % in a day (0.58 σ of
    /// one step).
    #[must_use]
    pub fn maxima(&self, hours: &[f64], members: u32, seed: u64) -> Vec<MaximumFloor> {
        let mut hours = hours.to_vec();
        hours.sort_by(f64::total_cmp);
        let mut squares = vec![[0.0f64; STATES]; hours.len()];
        let gyro = self.angle_random_walk * libm::sqrt(STEP_S);
        let accelerometer = self.velocity_random_walk * libm::sqrt(STEP_S);
        for member in 0..members {
            let mut random = Philox::from_u64_seed_stream(seed, u64::from(member));
            let mut x = State::zeros();
            let mut max = [0.0f64; STATES];
            let mut step = 0u32;
            for (hour, square) in hours.iter().zip(&mut squares) {
                let end = (hour * 3600.0 / STEP_S) as u32;
                while step < end {
                    x = self.transition * x;
                    let [a, b] = gaussian_pair(&mut random);
                    let [c, d] = gaussian_pair(&mut random);
                    let [e, _] = gaussian_pair(&mut random);
                    x[0] += gyro * a;
                    x[1] += gyro * b;
                    x[2] += gyro * c;
                    x[3] += accelerometer * d;
                    x[4] += accelerometer * e;
                    for (max, error) in max.iter_mut().zip(self.errors(&x)) {
                        *max = max.max(error.abs());
                    }
                    step += 1;
                }
                for (square, max) in square.iter_mut().zip(max) {
                    *square += max * max;
                }
            }
        }
        let rms = |sum: f64| libm::sqrt(sum / f64::from(members.max(1)));
        hours
            .iter()
            .zip(&squares)
            .map(|(&hours, square)| {
                let [latitude, longitude, solution @ ..] = square.map(rms);
                MaximumFloor {
                    hours,
                    latitude_arcmin: latitude / ARCMIN,
                    longitude_arcmin: longitude / ARCMIN,
                    solution: SolutionValues::of_si(solution),
                }
            })
            .collect()
    }

    /// Errors of a state: latitude, longitude, heading, pitch, roll of a level case (rad), velocity
    /// north and east (m/s). Signs are those of φ.
    fn errors(&self, x: &State) -> [f64; STATES] {
        let (s, c) = self.heading_sin_cos;
        [x[5], x[6], x[2], c * x[1] - s * x[0], c * x[0] + s * x[1], x[3], x[4]]
    }

    /// Latitude and longitude error (rad) after `t_s`, from errors that are constant in n, without
    /// noise.
    #[must_use]
    pub fn propagate(&self, initial: [f64; STATES], error: &SensorError, t_s: f64) -> [f64; 2] {
        let [.., latitude_rad, longitude_rad] = self.propagate_states(initial, error, t_s);
        [latitude_rad, longitude_rad]
    }

    /// All states after `t_s`, from errors that are constant in n, without noise: φ north, east, down
    /// (rad), velocity north and east (m/s), latitude and longitude (rad).
    #[must_use]
    pub fn propagate_states(
        &self,
        initial: [f64; STATES],
        error: &SensorError,
        t_s: f64,
    ) -> [f64; STATES] {
        let u = input(error);
        let steps = (t_s / STEP_S).ceil().max(1.0);
        let (transition, integral) = transition(&self.dynamics, t_s / steps);
        let drive = integral * u;
        let mut x = State::from(initial);
        for _ in 0..steps as u32 {
            x = transition * x + drive;
        }
        x.into()
    }
}

/// Input of the states by a sensor error: the gyro error enters with a minus sign.
fn input(error: &SensorError) -> State {
    State::from([-error[0], -error[1], -error[2], error[3], error[4], 0.0, 0.0])
}

fn noise_density(angle_random_walk: f64, velocity_random_walk: f64) -> Matrix {
    let (g, a) =
        (angle_random_walk * angle_random_walk, velocity_random_walk * velocity_random_walk);
    Matrix::from_diagonal(&State::from([g, g, g, a, a, 0.0, 0.0]))
}

/// Φ = exp(F·t) and ∫₀ᵗ exp(F·s) ds by their power series; t is at most a minute, for which 20 terms
/// are exact to the last bit.
fn transition(f: &Matrix, t_s: f64) -> (Matrix, Matrix) {
    let mut term = Matrix::identity();
    let mut phi = Matrix::identity();
    let mut integral = Matrix::identity() * t_s;
    for k in 1..=20u32 {
        term = term * f * (t_s / f64::from(k));
        phi += term;
        integral += term * (t_s / f64::from(k + 1));
    }
    (phi, integral)
}

/// Φ over a step, and the covariance that white noise adds in it, by doubling from 1/1024 of a step.
fn discretize(f: &Matrix, density: &Matrix) -> (Matrix, Matrix) {
    let mut t_s = STEP_S / 1024.0;
    let (mut phi, _) = transition(f, t_s);
    let mut q = (phi * density * phi.transpose() + density) * (0.5 * t_s);
    while t_s < STEP_S {
        q += phi * q * phi.transpose();
        phi *= phi;
        t_s *= 2.0;
    }
    (phi, q)
}

/// Two independent standard normal numbers (Box and Muller, 1958), computed with libm.
fn gaussian_pair(random: &mut Philox) -> [f64; 2] {
    let u = rand_philox::u32_to_unit_f64(random.next_u32());
    let v = rand_philox::u32_to_unit_f64(random.next_u32());
    let radius = libm::sqrt(-2.0 * libm::log(u));
    let (s, c) = libm::sincos(2.0 * core::f64::consts::PI * v);
    [radius * c, radius * s]
}
