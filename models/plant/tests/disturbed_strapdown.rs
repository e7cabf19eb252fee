//! A perfect strapdown that integrates the samples agrees with truth during any disturbance by
//! faults and after it: gyros and accelerometers feel one motion.

use super::common::strapdown::Strapdown;
use super::common::*;
use octant_earth::units::DEG;
use octant_plant::config::*;
use octant_plant::{Plant, motion};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::disturbance::*;

/// Sample period at 2 kHz, ns: short, so that the strapdown's own errors are small.
const FINE_NS: u64 = 500_000;
const FINE_S: f64 = 5e-4;

fn fine() -> PlantConfig {
    let mut config = perfect();
    config.sample_period_ns = FINE_NS;
    config.motion =
        Motion::Static(CaseAttitude { heading_rad: 0.7, pitch_rad: 0.05, roll_rad: -0.03 });
    config.turntable.non_orthogonality_rad = 1e-3;
    config.turntable.errors.mounting_rad = [3e-3, -2e-3, 1e-3];
    config
}

/// One disturbance and its life, s.
struct Life {
    disturbance: Disturbance,
    from_s: f64,
    to_s: f64,
}

fn life(disturbance: Disturbance, from_s: f64, to_s: f64) -> Life {
    Life { disturbance, from_s, to_s }
}

fn on_roll(action: GimbalAction) -> Disturbance {
    Disturbance::Gimbal { gimbal: Gimbal::Roll, action }
}

/// Runs 12 s with moves at 0 s, 3 s and 8 s; returns the largest errors of position, velocity and
/// attitude at every tenth sample, and the distance of truth from that of the undisturbed plant.
fn worst(config: &PlantConfig, lives: &[Life]) -> ([f64; 3], f64) {
    let mut plant = Plant::new(config).unwrap();
    let mut calm = Plant::new(config).unwrap();
    let mut strapdown = Strapdown::start(&plant.truth(), false, FINE_S);
    let (mut worst, mut apart) = ([0.0f64; 3], 0.0f64);
    for k in 0..24_000u64 {
        let at = |time_s: f64| k == (time_s / FINE_S).round() as u64;
        for (handle, life) in (0..).zip(lives) {
            if at(life.from_s) {
                plant.begin(handle, &life.disturbance);
            }
            if at(life.to_s) {
                plant.end(handle);
            }
        }
        let target = match k {
            0..6000 => command(12.0, 0.0),
            6000..16_000 => command(12.0, 20.0),
            _ => command(-3.0, 20.0),
        };
        let step = plant.step(&target);
        calm.step(&target);
        assert_eq!(step.sample.status.bits(), 0);
        strapdown.step(&step.sample, step.sample.sequence == 1);
        if step.sample.sequence.is_multiple_of(10) {
            let truth = plant.truth();
            let error = strapdown.error(&truth);
            for (worst, error) in worst.iter_mut().zip([error.0, error.1, error.2]) {
                *worst = worst.max(error);
            }
            let other = calm.truth();
            let same: f64 = truth.q_nb.iter().zip(&other.q_nb).map(|(a, b)| a * b).sum();
            apart = apart
                .max(2.0 * (1.0 - same.abs()).max(0.0).sqrt())
                .max((truth.velocity_mps[0] - other.velocity_mps[0]).abs());
        }
    }
    (worst, apart)
}

/// Checks position within 1 µm, velocity within 0.1 µm/s, attitude within 2e-10 rad. The counts'
/// resolution is 1.5e-11 rad and 9e-10 m/s; the rest is the error of the strapdown's parabola
/// through two samples where an acceleration or, for a gear with play, a rate jumps, and the error
/// of coning of 17 Hz at 2 kHz.
fn agrees(name: &str, config: &PlantConfig, lives: &[Life]) {
    let ([position, velocity, attitude], apart) = worst(config, lives);
    let found = format!("{name}: {position:.1e} m, {velocity:.1e} m/s, {attitude:.1e} rad");
    assert!(position < 1e-6 && velocity < 1e-7 && attitude < 2e-10, "{found}");
    assert!(apart > 1e-5, "{name}: nothing happened");
}

fn line(
    frequency_hz: f64,
    displacement_m: [f64; 3],
    angle_rad: [f64; 3],
    phase: f64,
) -> SpectralLine {
    SpectralLine {
        frequency_hz,
        displacement_m,
        angle_rad,
        phase_rad: phase,
        angle_phase_rad: 1.3 * phase + 0.4,
    }
}

#[test]
fn of_nothing() {
    let ([position, velocity, attitude], _) = worst(&fine(), &[]);
    assert!(position < 1e-6 && velocity < 1e-7 && attitude < 2e-10);
}

/// Two axes a quarter of a period apart: coning; linear and angular in step: sculling.
#[test]
fn of_vibration_with_coning_and_sculling() {
    let lines = vec![
        line(17.0, [3e-4, 0.0, 1e-4], [1e-3, 0.0, 0.0], 0.0),
        line(17.0, [0.0, 2e-4, 0.0], [0.0, 1e-3, 2e-4], 1.2),
        line(5.3, [1e-3, 0.0, -1e-3], [0.0, 0.0, 3e-3], 2.0),
    ];
    let vibration = Disturbance::Vibration { lines, edge_s: 0.5 };
    agrees("vibration", &fine(), &[life(vibration, 0.5, 6.0)]);
}

/// The configured vibration, the vibration of a fault and a shock add up to one rigid motion.
#[test]
fn of_vibration_beside_vibration() {
    let mut config = fine();
    let lines = vec![line(11.0, [2e-4, 0.0, 0.0], [0.0, 1e-3, 0.0], 0.3)];
    let vibration = || Disturbance::Vibration { lines: lines.clone(), edge_s: 0.3 };
    let twice = [life(vibration(), 1.0, 4.0), life(vibration(), 2.0, 4.1)];
    agrees("two vibrations", &config, &twice);
    // Truth excludes the configured vibration: with it, attitude is that of the body before and
    // after, and the strapdown's attitude starts with the swing of the first moment.
    config.imu.extensions.vibration = Some(Vibration {
        frequency_hz: 10.0,
        displacement_m: [0.0; 3],
        angle_rad: [0.0, 0.0, 1e-6],
        phase_rad: 0.0,
    });
    let ([_, _, attitude], _) = worst(&config, &twice);
    assert!(attitude < 1.5e-6, "{attitude}");
}

#[test]
fn of_shocks() {
    let shock = |peak_mps2, width_s| Disturbance::Shock { peak_mps2, width_s, recoil_s: 0.25 };
    let lives = [
        life(shock([20.0, 0.0, -30.0], 0.02), 0.4, 0.4005),
        // Into the recoil of the first, and while the gimbal turns.
        life(shock([0.0, 15.0, 0.0], 0.05), 0.5, 0.5005),
        life(shock([10.0, 0.0, 10.0], 0.011), 4.0, 4.0005),
    ];
    agrees("shocks", &fine(), &lives);
}

#[test]
fn of_sway_and_a_jerk_of_the_mooring() {
    let sway = || Disturbance::Case {
        lines: vec![
            line(0.4, [0.1, 0.0, 0.05], [0.03, 0.0, 0.01], 0.0),
            line(0.7, [0.0, 0.08, 0.0], [0.0, 0.04, 0.0], 2.0),
        ],
        edge_s: 1.0,
    };
    let jerk = || Disturbance::Excursion {
        displacement_m: [0.3, 0.1, 0.02],
        angle_rad: [0.01, -0.005, 0.02],
        length_s: 1.5,
    };
    let lives = [life(sway(), 0.5, 6.0), life(jerk(), 3.1, 3.1005)];
    agrees("sway and jerk, static", &fine(), &lives);
    let mut ship = fine();
    ship.motion = Motion::Dockside(motion::dockside_default(5));
    agrees("sway and jerk, dockside", &ship, &lives);
    let mut lines = vec![line(9.0, [2e-4, 0.0, 0.0], [0.0, 1e-3, 0.0], 0.3)];
    lines[0].angle_phase_rad = 0.0;
    let vibration = Disturbance::Vibration { lines, edge_s: 0.3 };
    let all = [life(sway(), 0.5, 6.0), life(jerk(), 3.1, 3.1005), life(vibration, 3.0, 5.0)];
    agrees("and a vibration, dockside", &ship, &all);
}

#[test]
fn of_what_happens_to_a_gimbal() {
    use GimbalAction::*;
    let cases = [
        ("slip", Slip { angle_rad: 0.5 * DEG, within_s: 0.05, seen: false }, 4.0, 4.0005),
        ("stall", Stall, 3.9, 6.0),
        ("runaway", Runaway { rate_radps: -15.0 * DEG }, 4.0, 5.5),
        ("overshoot", Overshoot { angle_rad: 1.0 * DEG }, 1.0, 10.0),
        ("ringing", Ringing { amplitude_rad: 2e-3, frequency_hz: 8.0, decay_s: 0.3 }, 1.0, 10.0),
        ("backlash", Backlash { play_rad: 1e-3 }, 1.0, 4.5),
        ("backlash that closes at rest", Backlash { play_rad: 1e-3 }, 4.0, 7.0),
    ];
    for (name, action, from_s, to_s) in cases {
        agrees(name, &fine(), &[life(on_roll(action), from_s, to_s)]);
    }
    let together = [
        life(on_roll(Overshoot { angle_rad: 1.0 * DEG }), 0.0, 11.0),
        life(on_roll(Backlash { play_rad: 1e-3 }), 1.0, 8.0),
        life(on_roll(cases[4].1), 2.0, 9.0),
        life(on_roll(cases[0].1), 4.2, 4.3),
    ];
    let mut ship = fine();
    ship.motion = Motion::Dockside(motion::dockside_default(5));
    agrees("all together on a ship", &ship, &together);
}

/// Size effect: the accelerometers feel `ω̇ × r + ω × (ω × r)` of the block's rate in addition; the
/// rate is taken from the gyros' samples.
#[test]
fn of_the_size_effect_under_vibration() {
    let arms = [[0.05, 0.0, 0.0], [0.0, 0.0, 0.04], [0.0, 0.03, 0.0]];
    let lines = vec![line(17.0, [0.0; 3], [1e-3, 5e-4, 0.0], 0.0)];
    let config = fine();
    let (mut with, mut without) = (Plant::new(&config).unwrap(), Plant::new(&config).unwrap());
    for plant in [&mut with, &mut without] {
        plant.begin(0, &Disturbance::Vibration { lines: lines.clone(), edge_s: 0.2 });
    }
    let level = command(0.0, 0.0);
    for _ in 0..1000 {
        assert_eq!(with.step(&level), without.step(&level));
    }
    with.begin(1, &Disturbance::LeverArm(arms));
    let pairs: Vec<_> = (0..2000).map(|_| (with.step(&level), without.step(&level))).collect();
    let felt: Vec<([f64; 3], [f64; 3])> = pairs
        .iter()
        .map(|(a, b)| {
            assert_eq!(a.sample.delta_theta, b.sample.delta_theta);
            let more = |i: usize| a.sample.delta_velocity[i] - b.sample.delta_velocity[i];
            (
                a.sample.delta_theta.map(|n| f64::from(n) * DELTA_THETA_LSB_RAD / FINE_S),
                core::array::from_fn(|i| f64::from(more(i)) * DELTA_VELOCITY_LSB_MPS / FINE_S),
            )
        })
        .collect();
    let cross = |a: [f64; 3], b: [f64; 3]| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    for three in felt.windows(3) {
        let [(before, _), (rate, force), (after, _)] = [three[0], three[1], three[2]];
        let acceleration = core::array::from_fn(|i| (after[i] - before[i]) / (2.0 * FINE_S));
        for axis in 0..3 {
            let expected =
                cross(acceleration, arms[axis])[axis] + cross(rate, cross(rate, arms[axis]))[axis];
            // The largest value is 0.57 m/s²: the difference is accurate to (Ω dt)²/6, 4.8e-4, and
            // a count more or less is 2e-6 m/s².
            let error = (force[axis] - expected).abs();
            assert!(error < 4.8e-4 * 0.57 + 4e-6, "{axis} {error}");
        }
    }
}
