//! Whole procedures of the core with the plant: perfect sensors, a moored ship, coarse alignment
//! and the two other estimators.

use nalgebra::{Quaternion, UnitQuaternion};
use octant_calibration::config::*;
use octant_calibration::positions::{Degrees, EIGHT, SIX};
use octant_earth::units::*;
use octant_plant::config as plant;
use octant_plant::motion::dockside_default;
use octant_sample::parameters::ParameterGroup;
use octant_sample::{Mode, Parameters};
use octant_test_loop::instrument::{InstrumentCase, dockside};
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};
use octant_test_loop::squares::{AttitudeSquares, assert_consistent};

/// Sets the given attitude and velocity to the truth at time 0, with the error that the case draws.
fn hand_over(plant: &plant::PlantConfig, core: &mut CoreConfig) {
    let truth = octant_plant::Plant::new(plant).unwrap().truth();
    if let Alignment::Given { q_nb, velocity_mps } = &mut core.alignment {
        let [w, i, j, k] = truth.q_nb;
        *q_nb *= UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
        *velocity_mps += nalgebra::Vector3::from(truth.velocity_mps);
    }
}

/// Returns the position error, north and east, arcmin.
fn position_error_arcmin(run: &ClosedLoop) -> [f64; 2] {
    let (n, truth) = (run.output.navigation, run.plant.truth());
    [
        (n.latitude_rad - truth.latitude_rad) / ARCMIN,
        (n.longitude_rad - truth.longitude_rad) / ARCMIN,
    ]
}

/// Returns squared error over variance, and squared error, of each group, averaged over its axes.
fn squares(run: &ClosedLoop, truth: &Parameters) -> [(f64, f64); 7] {
    let (truth, estimate) = (truth.to_array(), run.core.parameters().to_array());
    let sigma = run.core.sigma();
    ParameterGroup::ALL.map(|group| {
        let n = group.range().len() as f64;
        group.range().fold((0.0, 0.0), |(nees, square), i| {
            let error = estimate[i] - truth[i];
            (nees + (error / sigma[i]).powi(2) / n, square + error * error / n)
        })
    })
}

fn perfect(dockside: bool) -> ClosedLoop {
    let case = InstrumentCase {
        navigation_h: 24.0,
        angle_random_walk: 0.0,
        ..InstrumentCase::table_1(1, EIGHT)
    };
    let (mut plant, mut core) = (case.plant(), case.core());
    plant.imu.parameters = Parameters::default();
    plant.imu.velocity_random_walk = 0.0;
    if dockside {
        let ship = dockside_default(1);
        core.screening.base = octant_test_loop::instrument::base_of(&ship);
        plant.motion = plant::Motion::Dockside(ship);
    }
    core.calibration = None;
    core.alignment = Alignment::Given {
        q_nb: UnitQuaternion::identity(),
        velocity_mps: nalgebra::Vector3::zeros(),
    };
    hand_over(&plant, &mut core);
    ClosedLoop::new(&plant, &core)
}

#[test]
#[ignore = "minutes: run by tests/run"]
fn perfect_sensors_navigate_without_error() {
    let worst = on_two_threads(&[false, true], |dockside| {
        let mut run = perfect(*dockside);
        let mut turned = false;
        let mut worst = [0.0f64; 2];
        while run.step().mode == Mode::Navigating {
            let error = position_error_arcmin(&run);
            assert!(error.iter().all(|error| error.is_finite()));
            turned |= run.output.moving && run.output.stop > 2;
            for axis in 0..2 {
                worst[axis] = worst[axis].max(error[axis].abs());
            }
        }
        assert!(turned);
        assert_eq!(run.output.sequence, 24 * 3600 * 200);
        worst
    });
    println!("24 h, arcmin: static {:?}, dockside {:?}", worst[0], worst[1]);
    assert!(worst[0].iter().all(|error| *error < 1e-3), "{worst:?}");
    // The error is 1.5e-4 and doesn't grow: the vertical channel is held while the ship heaves, and
    // 0.2 m are 1.1e-4 arcmin.
    assert!(worst[1].iter().all(|error| *error < 1e-3), "{worst:?}");
}

#[test]
#[ignore = "minutes: run by tests/run"]
fn a_moored_ship_is_calibrated_with_the_position_of_the_dock() {
    let seeds: Vec<u64> = (1..=12).collect();
    let all = on_two_threads(&seeds, |seed| {
        let case = InstrumentCase::table_1(*seed, EIGHT);
        let (plant, core) = dockside(&case);
        let truth = plant.imu.parameters;
        let mut run = ClosedLoop::new(&plant, &core);
        let mode = run.calibrate();
        let nis = run.core.table().map(|table| table.quality.nis_mean);
        (mode, nis, squares(&run, &truth), AttitudeSquares::of(&run))
    });
    let n = all.len() as f64;
    let nis = all.iter().map(|(_, nis, ..)| nis.unwrap()).sum::<f64>() / n;
    println!("dockside, {n} seeds: NIS {nis:.2}");
    assert!((2.0..3.0).contains(&nis), "{nis}");
    // Limits of the static ensemble, with 20 % for the sway.
    let limits = [8e-4, 2.0, 0.7, f64::INFINITY, 1.0, 2.0, 0.7].map(|limit| 1.2 * limit);
    for group in ParameterGroup::ALL {
        let mean = |pick: fn(&(f64, f64)) -> f64| {
            all.iter().map(|(_, _, squares, _)| pick(&squares[group as usize])).sum::<f64>() / n
        };
        let rms = mean(|s| s.1).sqrt() / group.si_per_unit();
        println!("{:20} NEES {:.2} rms {rms:.2e} {}", group.name(), mean(|s| s.0), group.unit());
        assert!(rms <= limits[group as usize], "{}: {rms}", group.name());
    }
    assert!(all.iter().all(|(mode, ..)| *mode == Mode::Done));
    assert_consistent("dockside", all.iter().map(|(.., attitude)| *attitude));
}

#[test]
#[ignore = "minutes: run by tests/run"]
fn a_calibration_from_coarse_alignment_is_consistent() {
    let seeds: Vec<u64> = (1..=8).collect();
    let all = on_two_threads(&seeds, |seed| {
        let case = InstrumentCase::table_1(*seed, EIGHT);
        let mut core = case.core();
        core.alignment = Alignment::Coarse { duration_s: 60.0 };
        let mut run = ClosedLoop::new(&case.plant(), &core);
        let mode = run.calibrate();
        let quality = run.core.table().map(|table| table.quality);
        let squares = squares(&run, &case.plant().imu.parameters);
        (mode, quality, squares, AttitudeSquares::of(&run))
    });
    let n = all.len() as f64;
    let nis = all.iter().map(|(_, quality, ..)| quality.unwrap().nis_mean).sum::<f64>() / n;
    println!("coarse alignment: NIS {nis:.3}");
    // The first measurements don't fit: bias and tilt come from the same samples.
    assert!((nis - 3.0).abs() < 0.1, "{nis}");
    for group in ParameterGroup::ALL {
        let nees = all.iter().map(|(_, _, s, _)| s[group as usize].0).sum::<f64>() / n;
        println!("{:20} NEES {nees:.2}", group.name());
        // 24 degrees of freedom: 99.9 % within 0.34 and 2.13.
        assert!((0.3..2.2).contains(&nees), "{}: {nees}", group.name());
    }
    assert!(
        all.iter()
            .all(|(mode, quality, ..)| *mode == Mode::Done && quality.unwrap().recoveries == 0)
    );
    assert_consistent("coarse alignment", all.iter().map(|(.., attitude)| *attitude));
}

#[test]
#[ignore = "minutes: run by tests/run"]
fn the_other_estimators_end_in_navigation() {
    let methods: Vec<(&str, &'static [Degrees], Estimator)> = [("six", SIX), ("eight", EIGHT)]
        .into_iter()
        .flat_map(|(name, positions)| {
            [
                Estimator::LeastSquares(LeastSquares {
                    gravity_mps2: None,
                    gyro: GyroReference::EarthRate,
                    intervals: StaticIntervals::Commanded,
                }),
                Estimator::ExternalTurntable(ExternalTurntable {
                    q_nc: UnitQuaternion::identity(),
                    encoder_sigma_rad: 1.0 * ARCSEC,
                }),
            ]
            .map(|estimator| (name, positions, estimator))
        })
        .collect();
    let all = on_two_threads(&methods, |(_, positions, estimator)| {
        let mut case = InstrumentCase::table_1(1, positions);
        case.navigation_h = 12.0;
        let (mut plant, mut core) = (case.plant(), case.core());
        if matches!(estimator, Estimator::ExternalTurntable(_)) {
            plant.turntable.encoder_sigma_rad = 1.0 * ARCSEC;
        }
        core.calibration.as_mut().unwrap().estimator = *estimator;
        let mut run = ClosedLoop::new(&plant, &core);
        let mode = run.calibrate();
        let refusal = run.core.refusal().copied();
        let squares = squares(&run, &plant.imu.parameters);
        let mut worst = [0.0f64; 2];
        while run.output.mode == Mode::Navigating {
            run.step();
            let error = position_error_arcmin(&run);
            for axis in 0..2 {
                worst[axis] = worst[axis].max(error[axis].abs());
            }
        }
        (mode, refusal, squares, worst)
    });
    for ((name, _, estimator), (mode, refusal, squares, worst)) in methods.iter().zip(&all) {
        let method = match estimator {
            Estimator::LeastSquares(_) => "least squares",
            _ => "external turntable",
        };
        println!("{name} {method}: {mode:?} {refusal:?}, 12 h {worst:.3?} arcmin");
        for group in ParameterGroup::ALL {
            let (nees, square) = squares[group as usize];
            println!(
                "  {:20} NEES {nees:8.2} rms {:.2e} {}",
                group.name(),
                square.sqrt() / group.si_per_unit(),
                group.unit()
            );
        }
    }
    for (mode, refusal, _, worst) in &all {
        assert_eq!((*mode, *refusal), (Mode::Navigating, None));
        // Without calibration, 0.005 °/h alone gives 3 arcmin.
        assert!(worst.iter().all(|error| *error < 6.0), "{worst:?}");
    }
}
