//! Edges of spikes in blocks without noise.

use super::way::c_cb;
use super::*;
use crate::config::{AidingMode, BaseMotion, ErrorModel, Prior, SwayNoise};
use core::f64::consts::PI;

const SAMPLE_S: f64 = 0.005;
/// Angle random walk of Table 1, rad/√s: 0.0132″ in a block.
const WALK: f64 = 2.036e-7;
const ARCSEC: f64 = PI / 648_000.0;

fn continuity(base: Base, sample_s: f64) -> Continuity {
    let deg_per_hour = PI / 648_000.0;
    let kalman = Kalman {
        error_model: ErrorModel::Phi,
        estimated: [true; 7],
        prior: Prior {
            attitude_rad: [3e-4, 3e-4, 1.7e-3],
            velocity_mps: 0.02,
            position_m: 1.0,
            parameters: [0.005 * deg_per_hour, 3e-5, 2e-4, 5e-5 * deg_per_hour, 1e-3, 3e-5, 2e-4],
        },
        aiding: AidingMode::Velocity { sigma_mps: 1e-3 },
        aiding_period_ns: 1_000_000_000,
        sway: SwayNoise::White,
        refuse_above_mean_nis: 9.0,
        further: Default::default(),
        sigma_limits: Default::default(),
    };
    let noise = Noise { angle_random_walk: WALK, velocity_random_walk: 4.9e-4 };
    let table = TurntableRates { rate_radps: 0.1745, acceleration_radps2: 0.1745 };
    Continuity::new(&Screening::hardened(base), &kalman, &noise, &table, sample_s).unwrap()
}

fn ship() -> Base {
    Base::Moving(BaseMotion {
        angle_rad: 0.2,
        rate_radps: 0.16,
        acceleration_radps2: 0.14,
        force_mps2: 1.0,
        jerk_mps3: 0.9,
    })
}

fn block(turn: Vector3<f64>, beyond: Option<Vector3<f64>>) -> Block {
    let gimbal = GimbalAngles::default();
    Block { turn, velocity: Vector3::new(0.0, 0.0, -0.98), gimbal, rests: true, beyond }
}

/// Block in which a rotation about x, rad, is found that is added over `blocks` blocks.
fn found_after(
    base: Base,
    rotation: f64,
    blocks: usize,
    sway: impl Fn(usize) -> f64,
) -> Option<usize> {
    let mut continuity = continuity(base, SAMPLE_S);
    for k in 0..200 {
        let spike = if (100..100 + blocks).contains(&k) { rotation / blocks as f64 } else { 0.0 };
        if continuity.add(&block(Vector3::new(sway(k) + spike, 0.0, 0.0), None)).is_some() {
            return Some(k);
        }
    }
    None
}

/// Turn about the roll axis in block k of a ship that rolls by 3° in 8 s.
fn rolling(k: usize) -> f64 {
    let angle = |t: f64| 3.0 * PI / 180.0 * libm::sin(2.0 * PI / 8.0 * t);
    angle(0.1 * (k + 1) as f64) - angle(0.1 * k as f64)
}

#[test]
fn the_filter_is_blind_to_polynomials_and_of_norm_one() {
    let weights = step_weights();
    for power in 0..=DEGREE {
        let sum: f64 = weights
            .iter()
            .enumerate()
            .map(|(i, weight)| weight * libm::pow(i as f64 / 10.0 - 0.95, power as f64))
            .sum();
        assert!(sum.abs() < 1e-13, "degree {power}: {sum}");
    }
    let norm: f64 = weights.iter().map(|weight| weight * weight).sum();
    assert!((norm - 1.0).abs() < 1e-14);
}

/// The smallest rotations found without noise agree with the table above (6.5 σ) within a fifth.
#[test]
fn edges_are_found_from_the_size_that_the_table_says() {
    for (blocks, arcsec) in [(1, 0.14), (5, 0.9), (20, 3.0), (99, 15.0)] {
        for (base, sway) in [(Base::Still, 0.0), (ship(), 1.0)] {
            let sway = |k: usize| sway * rolling(k);
            let found = found_after(base, 1.2 * arcsec * ARCSEC, blocks, sway);
            assert!(found.is_some_and(|k| (100..112).contains(&k)), "{blocks}: {found:?}");
            assert_eq!(found_after(base, 0.8 * arcsec * ARCSEC, blocks, sway), None);
        }
    }
}

#[test]
fn a_rate_that_is_known_needs_no_edges() {
    let mut continuity = continuity(Base::Still, SAMPLE_S);
    // 1 °/h beyond the known rate, from the first block on.
    let beyond = Vector3::new(0.0, -0.1 * ARCSEC, 0.0);
    let found = (0..20).position(|_| continuity.add(&block(beyond, Some(beyond))).is_some());
    assert!(found.is_some_and(|block| block < 8), "{found:?}");
}

#[test]
fn a_stream_that_breaks_off_again_and_again_is_like_this() {
    let mut continuity = continuity(Base::Still, SAMPLE_S);
    let rough = |k: usize| ARCSEC * if k.is_multiple_of(23) { 1.0 } else { 0.0 };
    let alarms =
        (0..3000).filter(|k| continuity.add(&block(Vector3::repeat(rough(*k)), None)).is_some());
    let alarms = alarms.count();
    assert!((6..40).contains(&alarms), "{alarms}");
}

/// Angle at time `t` of a drive at 10 °/s and 10 °/s² that moves from `start` on by `angle`; rad
/// and s.
fn drive(start: f64, angle: f64, t: f64) -> f64 {
    let (rate, acceleration) = (10.0 * PI / 180.0, 10.0 * PI / 180.0);
    if angle == 0.0 {
        return 0.0;
    }
    let ramp = (rate / acceleration).min(libm::sqrt(angle / acceleration));
    let top = acceleration * ramp;
    let end = angle / top + ramp;
    let t = (t - start).clamp(0.0, end);
    if t < ramp {
        0.5 * acceleration * t * t
    } else if t < end - ramp {
        top * (t - 0.5 * ramp)
    } else {
        angle - 0.5 * acceleration * (end - t) * (end - t)
    }
}

/// Apparent edge of the gyros in the case beyond the allowance for turning gimbals, as a share of
/// the noise limit. The body's turn is integrated in a hundred steps a block.
fn gimbals(base: Base, starts: [f64; 2], angles: [f64; 2], sample_ms: usize) -> f64 {
    let mut continuity = continuity(base, 1e-3 * sample_ms as f64);
    let at = |k: usize| {
        let t = 1e-3 * k as f64;
        [0, 1].map(|i| drive(starts[i], angles[i].abs(), t) * angles[i].signum())
    };
    // At the largest rate of the ship about all axes, in 7, 8 and 9 s.
    let rate = if let Base::Moving(motion) = base { motion.rate_radps } else { 0.0 };
    let sway = |k: usize| {
        let phase = 2.0 * PI * 1e-3 * (k as f64 + 0.5);
        Vector3::new(libm::sin(phase / 8.0), libm::sin(phase / 7.0), libm::cos(phase / 9.0))
            * (0.57 * rate * 1e-3)
    };
    let (mut largest, mut turn) = (0.0f64, Vector3::zeros());
    for k in 0..20_000 {
        let (from, to) = (at(k), at(k + 1));
        let (azimuth, roll) = (0.5 * (from[0] + to[0]), to[1] - from[1]);
        let (sin, cos) = libm::sincos(azimuth);
        turn += Vector3::new(roll * cos, -roll * sin, to[0] - from[0]);
        turn += c_cb(azimuth, 0.5 * (from[1] + to[1])).transpose() * sway(k);
        let gimbal = GimbalAngles::from_rad(to[0], to[1]);
        if (k + 1).is_multiple_of(sample_ms) {
            continuity.follow(gimbal);
        }
        if (k + 1).is_multiple_of(100) {
            let velocity = Vector3::zeros();
            let _ = continuity.add(&Block { turn, velocity, gimbal, rests: false, beyond: None });
            turn = Vector3::zeros();
            if k > 3000 {
                let [x, y, z, ..] = continuity.filtered(&continuity.ring);
                let beyond = x.abs().max(y.abs()).max(z.abs()) - continuity.corners();
                largest = largest.max(beyond / continuity.limits[0]);
            }
        }
    }
    largest
}

#[test]
fn gimbals_that_turn_break_nothing_off() {
    let degrees = PI / 180.0;
    let turns = [
        (90.0, 90.0),
        (180.0, -90.0),
        (-45.0, 180.0),
        (17.0, 5.0),
        (3.0, -140.0),
        (0.0, 90.0),
        (90.0, 0.0),
    ];
    for base in [Base::Still, ship()] {
        let mut worst = 0.0f64;
        for (azimuth, roll) in turns {
            for phase in 0..10 {
                for later in [0.0, 0.03, 0.5, 1.0, 1.97] {
                    let start = 5.0 + 0.01 * f64::from(phase);
                    let angles = [azimuth * degrees, roll * degrees];
                    for sample_ms in [5, 20, 50] {
                        for starts in [[start, start + later], [start + later, start]] {
                            worst = worst.max(gimbals(base, starts, angles, sample_ms));
                        }
                    }
                }
            }
        }
        assert!(worst < 0.2, "{base:?}: {worst}");
    }
}
