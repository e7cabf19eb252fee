//! Navigations at rest on a turning instrument, at the level of their errors: 4 h at the noise of Table 1, integrated with a
//! step and a scheme of their own, and answers that are made of them or of something else.

use super::units::{ARW, Chance, Made, Scheme, VRW, Way};
use nalgebra::{Matrix3, Vector3};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_earth::frames::{c_cb, c_nc, quaternion_from_matrix};
use octant_earth::rotation::exp;
use octant_earth::units::{ARCSEC, DEG, DEG_PER_HOUR, MICRO_G};
use octant_followed::{Compared, FollowedScore, Follower, KnownNoise, Told};
use octant_random::draws::Draws;
use octant_random::stream::Triad;
use octant_sample::{Navigation, NoiseIntegral, Truth};

const LATITUDE_RAD: f64 = 30.5 * DEG;
const TURN_RADPS: f64 = 10.0 * DEG;
const DWELL_S: f64 = 300.0;
/// Moves of the navigation: roll (x) or azimuth (z), forth or back by half a turn.
const MOVES: &[u8; 32] = b"X+Z+X-Z-Z+X+Z-X-X-Z-X+Z+Z-X-Z+X+";

/// Draws a vector of normal numbers.
fn normals(by: &mut Chance, sigma: f64) -> Vector3<f64> {
    Vector3::new(by.0.normal(), by.0.normal(), by.0.normal()) * sigma
}

/// Attitude of the body after a time of the navigation, as its gimbal angles: azimuth and roll, rad.
fn gimbals(t_s: f64) -> [f64; 2] {
    let half = std::f64::consts::PI;
    let period_s = DWELL_S + half / TURN_RADPS;
    let (done, since_s) = ((t_s / period_s) as usize, t_s % period_s);
    let mut angles = [0.0; 2];
    let mut turn = |k: usize, part: f64| {
        let (axis, sign) = (MOVES[2 * (k % 16)], MOVES[2 * (k % 16) + 1]);
        let by = if sign == b'+' { part } else { -part };
        angles[usize::from(axis == b'X')] += half * by;
    };
    (0..done).for_each(|k| turn(k, 1.0));
    turn(done, ((since_s - DWELL_S) * TURN_RADPS / half).max(0.0));
    angles
}

/// Seconds, azimuth and roll of each, made once: the motion is that of every trial.
pub(crate) struct Course {
    attitudes: Vec<Matrix3<f64>>,
    earth: Ellipsoid,
}

impl Course {
    /// Makes a navigation of some hours, with four attitudes a second.
    pub(crate) fn new(hours: f64) -> Self {
        let count = (hours * 3600.0 * 4.0) as usize + 1;
        let attitude = |k: usize| {
            let [azimuth, roll] = gimbals(k as f64 * 0.25);
            c_nc(0.3, 0.01, -0.02) * c_cb(azimuth, roll)
        };
        let earth = Ellipsoid::at(LATITUDE_RAD, 0.0);
        Self { attitudes: (0..count).map(attitude).collect(), earth }
    }

    fn seconds(&self) -> usize {
        self.attitudes.len() / 4
    }
}

/// Errors of a unit: φ, velocity and position north and east.
#[derive(Clone, Copy, Debug)]
struct State {
    phi: Vector3<f64>,
    velocity: [f64; 2],
    position: [f64; 2],
}

/// Rates of the errors; `rate` and `force` are the errors of the sensors in n.
fn rates(
    s: &State,
    earth: &Ellipsoid,
    rate: &Vector3<f64>,
    force: &Vector3<f64>,
    damped_s: f64,
) -> State {
    let (sin, cos) = (earth.sin_latitude, earth.cos_latitude);
    let [north, east] = s.velocity;
    let latitude = s.position[0] / earth.meridian_radius_m;
    let along = Vector3::new(
        east / earth.transverse_radius_m - EARTH_RATE_RADPS * sin * latitude,
        -north / earth.meridian_radius_m,
        -east * sin / cos / earth.transverse_radius_m - EARTH_RATE_RADPS * cos * latitude,
    );
    let level = Vector3::new(s.phi.x, s.phi.y, 0.0) / damped_s;
    let g = earth.gravity_mps2;
    let twice = 2.0 * EARTH_RATE_RADPS * sin;
    State {
        phi: along - earth.earth_rate().cross(&s.phi) - rate - level,
        velocity: [
            g * s.phi.y - twice * east + force.x - north / damped_s,
            -g * s.phi.x + twice * north + force.y - east / damped_s,
        ],
        position: s.velocity,
    }
}

impl State {
    fn plus(&self, rates: &Self, dt_s: f64) -> Self {
        let add = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0] * dt_s, a[1] + b[1] * dt_s];
        Self {
            phi: self.phi + rates.phi * dt_s,
            velocity: add(self.velocity, rates.velocity),
            position: add(self.position, rates.position),
        }
    }
}

/// A line of a trial, once a second: what the scoring gets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    pub(crate) answer: Navigation,
    pub(crate) truth: Truth,
    pub(crate) noise: NoiseIntegral,
}

/// Runs a trial and gives every second to `take`.
pub(crate) fn trial(course: &Course, way: &Way, seed: u64, mut take: impl FnMut(u64, &Line)) {
    let (gyro, accelerometer) = (Triad::new(seed, "gyro"), Triad::new(seed, "accelerometer"));
    let own = [Triad::new(seed, "own.gyro"), Triad::new(seed, "own.accelerometer")];
    let (rough, white) =
        (Triad::new(seed, "rough"), [Triad::new(seed, "phi"), Triad::new(seed, "v")]);
    let mut by = Chance(Draws::of(seed, "power.unit", 0));
    let size = way.parameters;
    let bias = normals(&mut by, size * 0.005 * DEG_PER_HOUR);
    let accel_bias = normals(&mut by, size * 100.0 * MICRO_G);
    let matrix = |by: &mut Chance, sigma: f64| {
        Matrix3::from_columns(&[normals(by, sigma), normals(by, sigma), normals(by, sigma)])
    };
    let (m_gyro, m_accel) = (matrix(&mut by, size * 1e-4), matrix(&mut by, size * 1e-4));
    let g_dependent = matrix(&mut by, size * 5e-4 * DEG_PER_HOUR / 9.80665);
    let start = normals(&mut by, 1.0);
    let mut state = State {
        phi: Vector3::new(
            way.start_rad[0] * start.x,
            way.start_rad[0] * start.y,
            way.start_rad[1] * start.z,
        ),
        velocity: [by.between(-0.01, 0.01), by.between(-0.01, 0.01)],
        position: [0.0; 2],
    };
    let (mut wander, earth) = ([Vector3::zeros(); 2], &course.earth);
    let sines: [Vector3<f64>; 3] =
        [normals(&mut by, 5.0 * ARCSEC), normals(&mut by, 5.0 * ARCSEC), normals(&mut by, 3.0)];
    let mut encoder = normals(&mut by, 18.0 * ARCSEC);
    let mut dwell = gimbals(0.0);
    let mut noise = NoiseIntegral::default();
    let (mut smoothed, mut past, mut held) = (state, Vec::new(), None);
    let each = (way.step_s / 0.25) as usize;
    for second in 1..course.seconds() {
        for part in (0..4).step_by(each) {
            let at = 4 * (second - 1) + part;
            let (from, to) = (&course.attitudes[at], &course.attitudes[at + each]);
            let dt_s = way.step_s;
            let mid = 0.5 * (from + to);
            let turned =
                octant_earth::rotation::log(&quaternion_from_matrix(&(from.transpose() * to)));
            let (turn, root) =
                (mid.transpose() * earth.earth_rate() + turned / dt_s, libm::sqrt(dt_s));
            let force = mid.transpose() * Vector3::new(0.0, 0.0, -earth.gravity_mps2);
            // The noise is that of the quarters of a second, whatever the step.
            let sum = |triad: &Triad| {
                (at..at + each).map(|k| Vector3::from(triad.at(k as u64))).sum::<Vector3<f64>>()
                    * 0.5
            };
            let (n_gyro, n_accel) = (sum(&gyro) * ARW, sum(&accelerometer) * VRW);
            for axis in 0..3 {
                noise.delta_theta_rad[axis] += n_gyro[axis];
                noise.delta_velocity_mps[axis] += n_accel[axis];
            }
            let [own_gyro, own_accel] = [&own[0], &own[1]].map(sum);
            let keep = libm::exp(-dt_s / 1000.0);
            for (wander, (triad, sigma)) in
                wander.iter_mut().zip([(&own[0], way.wander[0]), (&own[1], way.wander[1])])
            {
                let step = Vector3::from(triad.at((1 << 40) + at as u64)) * sigma;
                *wander = *wander * keep + step * libm::sqrt(1.0 - keep * keep);
            }
            let roughly = Vector3::from(rough.at(at as u64)) * (way.coning * ARW * root);
            let counts = |at: usize| if way.skips { 2.0 * (at % 2) as f64 } else { 1.0 };
            let own_of = |triad: &Triad| {
                (at..at + each)
                    .map(|k| Vector3::from(triad.at(k as u64)) * counts(k))
                    .sum::<Vector3<f64>>()
                    * 0.5
            };
            let (n_gyro, n_accel) = (own_of(&gyro) * ARW, own_of(&accelerometer) * VRW);
            let theta = n_gyro * way.noise[0] + own_gyro * (way.noise[1] * ARW) + roughly;
            let pushed = n_accel * way.noise[0] + own_accel * (way.noise[1] * VRW);
            let rate = bias + m_gyro * turn + g_dependent * force + wander[0] + theta / dt_s;
            let felt = accel_bias + m_accel * force + wander[1] + pushed / dt_s;
            let (rate, felt) = (mid * rate, mid * felt);
            let of = |state: &State| rates(state, earth, &rate, &felt, way.damped_s);
            state = match way.scheme {
                Scheme::Euler => state.plus(&of(&state), dt_s),
                Scheme::Midpoint => state.plus(&of(&state.plus(&of(&state), 0.5 * dt_s)), dt_s),
                Scheme::Heun => {
                    let first = state.plus(&of(&state), dt_s);
                    let second = first.plus(&of(&first), dt_s);
                    State {
                        phi: 0.5 * (state.phi + second.phi),
                        velocity: [0, 1].map(|i| 0.5 * (state.velocity[i] + second.velocity[i])),
                        position: [0, 1].map(|i| 0.5 * (state.position[i] + second.position[i])),
                    }
                }
            };
            if way.state_single {
                state.velocity = state.velocity.map(|value| f64::from(value as f32));
            }
            if way.smooth_s > 0.0 {
                let part = dt_s / (0.5 * way.smooth_s + dt_s);
                smoothed.phi += (state.phi - smoothed.phi) * part;
                for axis in 0..2 {
                    smoothed.velocity[axis] +=
                        (state.velocity[axis] - smoothed.velocity[axis]) * part;
                    smoothed.position[axis] +=
                        (state.position[axis] - smoothed.position[axis]) * part;
                }
            } else {
                smoothed = state;
            }
            past.push(smoothed);
        }
        let now = second as f64;
        let angles = gimbals(now);
        if angles != dwell {
            (dwell, encoder) = (angles, normals(&mut by, 18.0 * ARCSEC));
        }
        let late = ((way.late_s + now % way.every_s) / way.step_s) as usize;
        let computed = past[past.len().saturating_sub(1 + late)];
        let [phi_jitter, v_jitter] =
            [&white[0], &white[1]].map(|triad| Vector3::from(triad.at(second as u64)));
        let (day, schuler) = (EARTH_RATE_RADPS * now, libm::sqrt(9.8 / 6.37e6) * now);
        let made = |sin: &Vector3<f64>, of: f64| {
            sin * libm::sin(schuler + 1.0) * of + sines[1] * libm::sin(day) * of
        };
        let phi = match way.attitude {
            Made::Integrated => computed.phi,
            Made::Known => Vector3::zeros(),
            Made::Sines => made(&sines[0], 1.0),
            Made::Encoders => encoder,
        };
        let velocity = match way.velocity {
            Made::Integrated | Made::Encoders => computed.velocity,
            Made::Known => [0.0; 2],
            Made::Sines => [made(&sines[0], 7.9e3).y, made(&sines[0], -7.9e3).x],
        };
        let round = |value: f64, digit: f64| {
            if digit > 0.0 { libm::round(value / digit) * digit } else { value }
        };
        let phi = (phi + phi_jitter * way.jitter[0]).map(|value| round(value, way.digits[0]));
        let velocity = [0, 1]
            .map(|axis| round(velocity[axis] + v_jitter[axis] * way.jitter[1], way.digits[1]));
        let truth_q = quaternion_from_matrix(&course.attitudes[4 * second]);
        let q = exp(&-phi) * truth_q;
        let single = |value: f64| if way.single { f64::from(value as f32) } else { value };
        let answer = Navigation {
            latitude_rad: LATITUDE_RAD + computed.position[0] / earth.meridian_radius_m,
            longitude_rad: computed.position[1] / (earth.transverse_radius_m * earth.cos_latitude),
            height_m: 0.0,
            velocity_mps: [single(velocity[0]), single(velocity[1]), 0.0],
            q_nb: [q.w, q.i, q.j, q.k].map(single),
        };
        // A new answer comes with each multiple of the time between two.
        if second % way.every_s as usize == 0 || held.is_none() {
            held = Some(answer);
        }
        let answer = held.unwrap_or(answer);
        let q = truth_q;
        let truth = Truth {
            latitude_rad: LATITUDE_RAD,
            q_nb: [q.w, q.i, q.j, q.k],
            gimbal_rad: angles,
            ..Truth::default()
        };
        take(second as u64, &Line { answer, truth, noise });
    }
}

/// Scores a trial with the function that scores runs.
pub(crate) fn scored(course: &Course, way: &Way, seed: u64) -> FollowedScore {
    let told = Told { attitude: true, velocity: true, position: true };
    let mut follower = Follower::new(told, KnownNoise::Simulated);
    trial(course, way, seed, |second, line| {
        let Line { answer, truth, noise } = line;
        let (now_ns, noise) = (second * 1_000_000_000, Some(*noise));
        follower.compare(&Compared { now_ns, answer, truth, noise });
    });
    follower.score()
}
