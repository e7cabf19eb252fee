//! The filter that models a ship's sway as coloured noise, over the dynamic condition of ISO 8728:
//! harmonic roll and pitch of 5° with periods from 6 to 15 s, horizontal acceleration of 0.22 m/s².

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use octant_calibration::config::*;
use octant_calibration::positions::EIGHT;
use octant_earth::units::*;
use octant_plant::config as plant;
use octant_plant::config::Sinusoid;
use octant_plant::draw::phases;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{Health, Mode};
use octant_test_loop::instrument::{InstrumentCase, base_of};
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};
use octant_test_loop::squares::{AttitudeSquares, assert_consistent};

/// 20 Hz: what a sway of seconds needs.
const PERIOD_NS: u64 = 50_000_000;
const PERIODS_S: [f64; 5] = [6.0, 8.0, 10.0, 12.0, 15.0];
const SEEDS: u64 = 50;

fn ship(seed: u64, period_s: f64) -> plant::Dockside {
    let omega = 2.0 * std::f64::consts::PI / period_s;
    let of = |name: &str, amplitude: f64| {
        let phase_rad = phases(seed, name, 1)[0];
        vec![Sinusoid { amplitude, period_s, phase_rad }]
    };
    let shift_m = 0.22 / (omega * omega);
    plant::Dockside {
        roll: of("roll", 5.0 * DEG),
        pitch: of("pitch", 5.0 * DEG),
        yaw: of("yaw", 1.0 * DEG),
        surge: of("surge", shift_m),
        sway: of("sway", shift_m),
        heave: of("heave", 0.5 * shift_m),
        ..plant::Dockside::calm(plant::CaseAttitude {
            heading_rad: 40.0 * DEG,
            pitch_rad: 0.0,
            roll_rad: 0.0,
        })
    }
}

fn configured(seed: u64, period_s: f64, sway: SwayNoise) -> (plant::PlantConfig, CoreConfig) {
    let case = InstrumentCase::table_1(seed, EIGHT);
    let (mut plant, mut core) = (case.plant(), case.core());
    let ship = ship(seed, period_s);
    core.screening.base = base_of(&ship);
    plant.motion = plant::Motion::Dockside(ship);
    plant.aiding.kind = plant::AidingKind::DockPosition { sigma_m: 0.01 };
    (plant.sample_period_ns, core.sample_period_ns) = (PERIOD_NS, PERIOD_NS);
    plant.calibration_samples /= 10;
    let truth = octant_plant::Plant::new(&plant).unwrap().truth();
    if let Alignment::Given { q_nb, velocity_mps } = &mut core.alignment {
        let [w, i, j, k] = truth.q_nb;
        *q_nb *= UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
        *velocity_mps += Vector3::from(truth.velocity_mps);
    }
    let Estimator::Kalman(kalman) = &mut core.calibration.as_mut().unwrap().estimator else {
        unreachable!();
    };
    kalman.sway = sway;
    let sigma_m = if sway == SwayNoise::White { 0.15 } else { 0.01 };
    kalman.aiding = AidingMode::Position { sigma_m };
    (plant, core)
}

/// Mean NIS, and the squared normalized errors of attitude and parameters.
fn calibrated(seed: u64, period_s: f64) -> (f64, AttitudeSquares, [f64; PARAMETER_COUNT]) {
    let (plant, core) = configured(seed, period_s, SwayNoise::Coloured);
    let mut run = ClosedLoop::new(&plant, &core);
    assert_eq!(run.calibrate(), Mode::Done, "seed {seed}, {period_s} s");
    let (truth, estimate) = (plant.imu.parameters.to_array(), run.core.parameters().to_array());
    let sigma = run.core.sigma();
    let squares = std::array::from_fn(|i| ((estimate[i] - truth[i]) / sigma[i]).powi(2));
    (run.core.table().unwrap().quality.nis_mean, AttitudeSquares::of(&run), squares)
}

/// A χ² of 30 over 50 seeds has a mean of 1 with σ = √(2/1500) = 0.037 where the errors of the
/// parameters are independent; they are drawn uniformly in part, which makes that less.
#[test]
#[ignore = "minutes: run by tests/run"]
fn innovations_and_errors_are_as_large_as_they_should_be_over_iso_8728() {
    let seeds: Vec<u64> = (1..=SEEDS).collect();
    let runs = on_two_threads(&seeds, |seed| {
        calibrated(*seed, PERIODS_S[*seed as usize % PERIODS_S.len()])
    });
    for (seed, (nis, ..)) in seeds.iter().zip(&runs) {
        let period_s = PERIODS_S[*seed as usize % PERIODS_S.len()];
        assert!((nis - 3.0).abs() < 0.1, "seed {seed}, {period_s} s: NIS {nis}");
    }
    let sum: f64 = runs.iter().flat_map(|(_, _, squares)| squares).sum();
    let mean = sum / (SEEDS as f64 * PARAMETER_COUNT as f64);
    let ends = runs
        .iter()
        .fold((f64::MAX, 0.0f64), |ends, (nis, ..)| (ends.0.min(*nis), ends.1.max(*nis)));
    println!("{SEEDS} seeds: NIS from {:.3} to {:.3}, normalized errors {mean:.3}", ends.0, ends.1);
    assert!((0.9..1.1).contains(&mean), "{mean}");
    assert_consistent("ISO 8728", runs.iter().map(|(_, attitude, _)| *attitude));
}

/// White noise of 0.15 m is no sway of 0.9 m, rms.
#[test]
fn as_white_noise_the_slowest_of_them_is_refused() {
    let (plant, core) = configured(1, 15.0, SwayNoise::White);
    let mut run = ClosedLoop::new(&plant, &core);
    assert_eq!(run.calibrate(), Mode::Refused);
}

/// After a minute without a reference, and a jump of the gyros that opens the gate, the filter
/// finds the sway again.
#[test]
fn the_sway_is_found_again_after_a_gap_and_a_recovery() {
    let (plant, core) = configured(2, 10.0, SwayNoise::Coloured);
    let mut run = ClosedLoop::new(&plant, &core);
    let (mut late, mut count, mut seconds) = (0.0, 0, 0.0);
    while matches!(run.output.mode, Mode::Aligning | Mode::Calibrating) {
        run.step_altered(|mut sample, aiding| {
            seconds = sample.sequence as f64 * PERIOD_NS as f64 * 1e-9;
            if (6000.0..6001.0).contains(&seconds) {
                sample.delta_theta[0] += 60_000_000;
            }
            let missing = (5000.0..5060.0).contains(&seconds);
            Some((sample, if missing { None } else { aiding }))
        });
        if seconds > 7000.0 && run.output.nis.is_finite() {
            late += run.output.nis;
            count += 1;
        }
    }
    assert_eq!(run.output.mode, Mode::Done);
    assert!(run.epochs(Health::AIDING_LOST) > 0);
    assert!(run.epochs(Health::RECOVERING) > 0);
    let mean = late / f64::from(count);
    // 3 with σ = √(6/7400) = 0.03.
    assert!((mean - 3.0).abs() < 0.12, "{mean}");
}

#[test]
fn a_coloured_sway_needs_a_position_often_enough() {
    let (_, mut core) = configured(1, 8.0, SwayNoise::Coloured);
    let refused = |core: &CoreConfig| octant_calibration::Core::new(core).unwrap_err();
    let change = |core: &mut CoreConfig, by: &dyn Fn(&mut Kalman)| {
        let Estimator::Kalman(kalman) = &mut core.calibration.as_mut().unwrap().estimator else {
            unreachable!();
        };
        by(kalman);
    };
    change(&mut core, &|kalman| kalman.aiding_period_ns = 4_000_000_000);
    assert_eq!(
        refused(&core).to_string(),
        "aiding period is 4000000000 ns, 2 s at most with a coloured sway is expected"
    );
    change(&mut core, &|kalman| kalman.aiding = AidingMode::Velocity { sigma_mps: 1e-3 });
    assert_eq!(
        refused(&core).to_string(),
        "the sway is coloured and the reference a velocity, a position is expected"
    );
}
