//! The core with the plant: forms of the error model, timing, disabled states, determinism, tables,
//! and the core's reports on damaged input.

use nalgebra::{Quaternion, UnitQuaternion};
use octant_calibration::Core;
use octant_calibration::config::*;
use octant_calibration::positions::{EIGHT, SIX};
use octant_calibration::state_machine::CalibrationRefusal;
use octant_calibration::table::CalibrationTable;
use octant_earth::frames::phi_of;
use octant_earth::units::*;
use octant_plant::config as plant;
use octant_sample::parameters::ParameterGroup;
use octant_sample::{Health, Mode, Parameters, Reference, Status};
use octant_test_loop::instrument::{InstrumentCase, LATITUDE_RAD, PERIOD_NS, dockside};
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};

const SECOND: u64 = 1_000_000_000 / PERIOD_NS;

fn kalman(config: &mut CoreConfig) -> &mut Kalman {
    match &mut config.calibration.as_mut().unwrap().estimator {
        Estimator::Kalman(kalman) => kalman,
        _ => unreachable!(),
    }
}

/// Makes a short calibration: half an hour of eight positions.
fn short(seed: u64) -> InstrumentCase {
    InstrumentCase { calibration_h: 0.5, ..InstrumentCase::table_1(seed, EIGHT) }
}

/// Runs to the last sample before the end, when the filter still exists.
fn run_short_of_the_end(mut run: ClosedLoop, hours: f64) -> ClosedLoop {
    run.run_to((hours * 3600.0) as u64 * SECOND - 1);
    run
}

/// Returns the largest difference of the parameters of two runs, and of their σ, relative to σ.
fn difference(a: &Core, b: &Core) -> (f64, f64) {
    let (sa, sb) = (a.sigma(), b.sigma());
    let (pa, pb) = (a.parameters().to_array(), b.parameters().to_array());
    (0..30).fold((0.0f64, 0.0f64), |(p, s), i| {
        (p.max((pa[i] - pb[i]).abs() / sa[i]), s.max((sa[i] / sb[i] - 1.0).abs()))
    })
}

#[test]
fn phi_and_psi_angle_forms_agree() {
    let case = InstrumentCase { calibration_h: 1.0, ..InstrumentCase::table_1(2, EIGHT) };
    let still = (case.plant(), case.core());
    for (name, (plant, phi)) in [("static", still), ("dockside", dockside(&case))] {
        let mut psi = phi.clone();
        kalman(&mut psi).error_model = ErrorModel::Psi;
        let runs = on_two_threads(&[phi, psi], |core| {
            run_short_of_the_end(ClosedLoop::new(&plant, core), 1.0)
        });
        let (parameters, sigma) = difference(&runs[0].core, &runs[1].core);
        println!("{name}: parameters differ by {parameters:.2e} σ, σ by {sigma:.2e}");
        // The physics are the same to first order: the difference is 2e-5 σ, and comes from δθ × v
        // and δr².
        assert!(parameters < 1e-3, "{name}: {parameters}");
        assert!(sigma < 1e-6, "{name}: {sigma}");
    }
}

#[test]
fn the_first_motion_is_felt_two_samples_after_the_command() {
    let mut case = short(1);
    // 1/2 h without the moves, over 21 weights.
    let mut plant = case.plant();
    plant.imu.angle_random_walk = 0.0;
    case.angle_random_walk = 7e-4;
    let mut run = ClosedLoop::new(&plant, &case.core());
    let home = run.step().gimbal_command;
    let commanded = loop {
        let output = run.step();
        if output.gimbal_command != home {
            break output.sequence;
        }
    };
    let mut last = run.plant.clone().step(&run.command).sample.delta_theta;
    let felt = loop {
        let output = run.step_altered(|sample, aiding| {
            let jump = (sample.delta_theta[0] - last[0]).abs();
            // Half of 10 °/s² over 5 ms squared is 2.2e-6 rad, 150 thousand counts.
            last = sample.delta_theta;
            (jump < 50_000).then_some((sample, aiding))
        });
        if output.is_none() {
            break run.output.sequence + 1;
        }
    };
    assert_eq!(felt, commanded + 2);
}

#[test]
fn four_hours_of_eight_positions_keep_their_published_times() {
    let mut run = ClosedLoop::of(&InstrumentCase::table_1(1, EIGHT));
    let (mut from, mut until) = (None, None);
    while until.is_none() {
        let output = run.step();
        if output.stop == 6 && !output.moving && from.is_none() {
            from = Some(output.device_time.seconds());
        }
        if output.stop == 7 && !output.moving {
            until = Some(output.device_time.seconds());
        }
    }
    // From the dwell at (0, 90) that begins at 4797 s to the azimuth move from 5475 to 5485 s.
    assert!((from.unwrap() - 4797.0).abs() < 1.0, "{from:?}");
    assert!((until.unwrap() - 5485.0).abs() < 1.0, "{until:?}");
}

#[test]
fn a_state_switched_off_stays_zero() {
    for group in ParameterGroup::ALL {
        let case = InstrumentCase { calibration_h: 0.25, ..InstrumentCase::table_1(3, SIX) };
        let mut config = case.core();
        kalman(&mut config).estimated[group as usize] = false;
        let run = run_short_of_the_end(ClosedLoop::new(&case.plant(), &config), 0.25);
        let (parameters, sigma) = (run.core.parameters().to_array(), run.core.sigma());
        for i in 0..30 {
            let off = group.range().contains(&i);
            assert_eq!(parameters[i] == 0.0, off, "{} {i}", group.name());
            assert_eq!(sigma[i] == 0.0, off, "{} {i}", group.name());
        }
    }
}

#[test]
fn a_clone_goes_on_bit_for_bit() {
    let mut run = ClosedLoop::of(&short(5));
    run.run_to(700 * SECOND + 37);
    let mut clone = run.clone();
    for _ in 0..100 * SECOND {
        let (a, b) = (run.step(), clone.step());
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }
    assert_eq!(run.core.parameters(), clone.core.parameters());
    let mut again = ClosedLoop::of(&short(5));
    again.run_to(run.output.sequence);
    assert_eq!(format!("{:?}", again.output), format!("{:?}", run.output));
    assert_eq!(again.core.parameters(), run.core.parameters());
    assert_eq!(again.core.sigma(), run.core.sigma());
}

#[test]
fn a_table_that_is_loaded_navigates_as_well_as_the_run_that_made_it() {
    let mut case = short(7);
    case.calibration_h = 1.0;
    case.navigation_h = 2.0;
    let mut whole = ClosedLoop::of(&case);
    assert_eq!(whole.calibrate(), Mode::Navigating);
    let bytes = whole.core.table().unwrap().to_bytes();
    let table = CalibrationTable::from_bytes(&bytes).unwrap();

    let mut config = case.core();
    config.calibration = None;
    config.initial_parameters = table.parameters;
    let at = whole.output.navigation;
    let [w, i, j, k] = at.q_nb;
    config.alignment = Alignment::Given {
        q_nb: UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
        velocity_mps: at.velocity_mps.into(),
    };
    let mut loaded = ClosedLoop { core: Core::new(&config).unwrap(), ..whole.clone() };
    while whole.step().mode == Mode::Navigating {
        loaded.step();
    }
    let (a, b) = (whole.output.navigation, loaded.output.navigation);
    // The same samples and the same parameters: only the interval before the first one differs,
    // which coning and sculling use.
    assert!((a.latitude_rad - b.latitude_rad).abs() < 1e-3 * ARCMIN, "{a:?} {b:?}");
    assert!((a.longitude_rad - b.longitude_rad).abs() < 1e-3 * ARCMIN, "{a:?} {b:?}");
}

#[test]
fn clean_runs_raise_no_health_flag() {
    let seeds: Vec<u64> = (1..=20).collect();
    let runs = on_two_threads(&seeds, |seed| {
        let case = InstrumentCase { calibration_h: 0.34, ..InstrumentCase::table_1(*seed, EIGHT) };
        let (plant, core) =
            if seed % 2 == 0 { (case.plant(), case.core()) } else { dockside(&case) };
        let mut run = ClosedLoop::new(&plant, &core);
        run.calibrate();
        (run.health, run.output.mode, run.core.refusal().copied())
    });
    for (seed, (health, mode, refusal)) in seeds.iter().zip(runs) {
        assert_eq!(health, [0; 32], "seed {seed}");
        assert_eq!((mode, refusal), (Mode::Done, None), "seed {seed}");
    }
}

#[test]
fn static_tuning_under_sway_is_refused() {
    let case = InstrumentCase { calibration_h: 0.5, ..InstrumentCase::table_1(1, EIGHT) };
    let (mut plant, mut core) = dockside(&case);
    plant.aiding.kind = plant::AidingKind::ZeroVelocity { sigma_mps: 1e-3 };
    kalman(&mut core).aiding = AidingMode::Velocity { sigma_mps: 1e-3 };
    for gate in [None, core.screening.gate] {
        let mut config = core.clone();
        config.screening.gate = gate;
        let mut run = ClosedLoop::new(&plant, &config);
        assert_eq!(run.calibrate(), Mode::Refused);
        println!("gate {}: {}", gate.is_some(), run.core.refusal().unwrap());
        assert!(run.core.table().is_none());
    }
}

#[test]
fn coarse_alignment_is_as_good_as_its_sensors() {
    let seeds: Vec<u64> = (1..=30).collect();
    let all = on_two_threads(&seeds, |seed| {
        let mut config = short(*seed).core();
        config.alignment = Alignment::Coarse { duration_s: 60.0 };
        let plant = short(*seed).plant();
        let mut run = ClosedLoop::new(&plant, &config);
        while run.step().mode == Mode::Aligning {}
        let q =
            |q: [f64; 4]| UnitQuaternion::new_unchecked(Quaternion::new(q[0], q[1], q[2], q[3]));
        let phi = phi_of(&q(run.output.navigation.q_nb), &q(run.plant.truth().q_nb));
        (phi, plant.imu.parameters)
    });
    let g = octant_earth::ellipsoid::Ellipsoid::at(LATITUDE_RAD, 0.0).gravity_mps2;
    let horizontal = octant_earth::ellipsoid::EARTH_RATE_RADPS * LATITUDE_RAD.cos();
    let vertical = -octant_earth::ellipsoid::EARTH_RATE_RADPS * LATITUDE_RAD.sin();
    let mut azimuth_square = 0.0;
    for (phi, p) in all {
        let (ga, gg, gm) = (p.accel_matrix(), p.g_matrix(), p.gyro_matrix());
        // Level, facing north: f = (0, 0, −g), ω = (Ω cos L, 0, −Ω sin L).
        let f: [f64; 3] = core::array::from_fn(|i| p.accel_bias[i] - ga[i][2] * g);
        let north_tilt = f[1] / g;
        let east_tilt = -f[0] / g;
        // 50 µg/√Hz over 60 s: 6.5 µg; the tolerance is five of them.
        let tolerance = 5.0 * 50e-6 / 60f64.sqrt();
        assert!((phi.x - north_tilt).abs() < tolerance, "{} {north_tilt}", phi.x);
        assert!((phi.y - east_tilt).abs() < tolerance, "{} {east_tilt}", phi.y);
        let rate = p.gyro_bias[1] - gg[1][2] * g + gm[1][0] * horizontal + gm[1][2] * vertical;
        let down = rate / horizontal - north_tilt * LATITUDE_RAD.tan();
        let noise = 7e-4 * DEG_PER_SQRT_HOUR / 60f64.sqrt() / horizontal;
        azimuth_square += ((phi.z - down) / noise).powi(2) / 30.0;
        assert!((phi.z - down).abs() < 5.0 * noise, "{} {down} {noise}", phi.z);
    }
    // χ² of 30 over 30: 99.9 % within 0.4 and 2.
    assert!((0.4..2.0).contains(&azimuth_square), "{azimuth_square}");
}

/// Alterations on the way to the core, with the health bit that must show each.
#[test]
fn damaged_input_is_flagged_and_the_calibration_stays_sane_or_is_refused() {
    let from = 400 * SECOND;
    type Alter = fn(u64, &mut octant_sample::Sample, &mut Option<octant_sample::Aiding>) -> bool;
    // `k` is the number of samples since the damage began, from 0. `false`: the sample is lost.
    let damages: [(&str, Alter, Health); 13] = [
        ("gap of 0.1 s", |k, _, _| k >= 20, Health::GAP),
        ("gap of 1 s", |k, _, _| k >= 200, Health::GAP),
        ("gap of 10 s", |k, _, _| k >= 2000, Health::GAP),
        (
            "stamp that stands",
            |k, sample, _| {
                if k == 0 {
                    sample.device_time.ns -= PERIOD_NS;
                }
                true
            },
            Health::OUT_OF_ORDER,
        ),
        (
            "stamp that goes back",
            |k, sample, _| {
                if k < 3 {
                    sample.device_time.ns -= 50 * PERIOD_NS;
                }
                true
            },
            Health::OUT_OF_ORDER,
        ),
        (
            "aiding that is not a number",
            |k, _, aiding| {
                if let Some(aiding) = aiding
                    && k < 20 * 200
                {
                    aiding.reference = Reference::Velocity([0.0, f64::NAN, 0.0]);
                }
                true
            },
            Health::NUMERIC,
        ),
        (
            "infinite aiding",
            |k, _, aiding| {
                if let Some(aiding) = aiding
                    && k < 20 * 200
                {
                    aiding.reference = Reference::Velocity([f64::INFINITY; 3]);
                }
                true
            },
            Health::NUMERIC,
        ),
        (
            "aiding lost for 10 min",
            |k, _, aiding| {
                if k < 600 * 200 {
                    *aiding = None;
                }
                true
            },
            Health::AIDING_LOST,
        ),
        (
            "aiding of another kind",
            |k, _, aiding| {
                if let Some(aiding) = aiding
                    && k < 60 * 200
                {
                    aiding.reference = Reference::Position {
                        latitude_rad: LATITUDE_RAD,
                        longitude_rad: 2.0,
                        height_m: 0.0,
                    };
                }
                true
            },
            Health::NUMERIC,
        ),
        (
            "aiding that is off by 1e150",
            |k, _, aiding| {
                if let Some(aiding) = aiding
                    && k < 20 * 200
                {
                    aiding.reference = Reference::Velocity([1e150, 0.0, 0.0]);
                }
                true
            },
            Health::INNOVATION_REJECTED,
        ),
        (
            "saturated flag",
            |k, sample, _| {
                if k < 20 {
                    sample.status |= Status::GYRO_SATURATED;
                }
                true
            },
            Health::INERTIAL_INVALID,
        ),
        (
            "encoder off by 1 degree",
            |k, sample, _| {
                if k < 60 * 200 {
                    sample.gimbal.roll += (DEG / octant_sample::counts::GIMBAL_LSB_RAD) as i32;
                }
                true
            },
            Health::GIMBAL_DISAGREES,
        ),
        (
            "counts at their limit",
            |k, sample, _| {
                if k < 20 {
                    sample.delta_theta = [i32::MIN; 3];
                    sample.delta_velocity = [i32::MAX; 3];
                }
                true
            },
            Health::JUMP,
        ),
    ];
    let outcomes = on_two_threads(&damages, |(name, alter, flag)| {
        let case = short(4);
        let mut run = ClosedLoop::of(&case);
        let mut last = 0;
        while matches!(run.output.mode, Mode::Aligning | Mode::Calibrating) {
            run.step_altered(|mut sample, mut aiding| {
                last = sample.sequence;
                let kept = sample.sequence < from
                    || alter(sample.sequence - from, &mut sample, &mut aiding);
                kept.then_some((sample, aiding))
            });
            assert!(last < 1_000_000, "{name}: never ends");
        }
        let truth = case.plant().imu.parameters.to_array();
        let estimate = run.core.parameters().to_array();
        let sigma = run.core.sigma();
        let worst = (0..30).map(|i| (estimate[i] - truth[i]).abs() / sigma[i]).fold(0.0, f64::max);
        (run.output.mode, run.core.refusal().copied(), worst, run.epochs(*flag), run.health)
    });
    let mut failures = Vec::new();
    for ((name, _, flag), (mode, refusal, worst, epochs, health)) in damages.iter().zip(outcomes) {
        println!(
            "{name:30} {mode:?} {worst:6.2} σ, {flag:?} in {epochs} epochs {refusal:?} {:?}",
            &health[..15]
        );
        if epochs == 0 {
            failures.push(format!("{name}: no {flag:?}"));
        }
        // With thirty parameters, the worst one of a good run is 2 to 3.5 σ off.
        if mode != Mode::Refused && worst > 6.0 {
            failures.push(format!("{name}: {worst} σ off and not refused"));
        }
        if mode == Mode::Refused && refusal.is_none() {
            failures.push(format!("{name}: refused without a reason"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn without_a_reference_a_calibration_is_refused() {
    let mut run = ClosedLoop::of(&short(1));
    while run.output.mode != Mode::Refused {
        run.step_altered(|sample, _| Some((sample, None)));
        assert!(run.output.sequence < 1801 * SECOND);
    }
    assert!(matches!(run.core.refusal(), Some(CalibrationRefusal::AidingLost { .. })));
    assert_eq!(run.core.parameters(), &Parameters::default());
}
