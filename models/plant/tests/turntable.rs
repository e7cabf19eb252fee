//! The turntable: durations, limits, timing of commands, encoder and play.

use super::common::*;
use octant_earth::units::{ARCSEC, DEG};
use octant_plant::Plant;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, GIMBAL_LSB_RAD};
use proptest::prelude::*;

/// Number of samples in which the gyros feel a move; the first is the one after that whose call
/// latched it.
fn move_samples(azimuth: f64, roll: f64) -> u64 {
    let mut plant = Plant::new(&perfect()).unwrap();
    plant.step(&command(azimuth, roll));
    let still = Plant::new(&perfect()).unwrap().truth().gimbal_rad;
    assert_eq!(plant.truth().gimbal_rad, still);
    let target = command(azimuth, roll).target;
    let mut samples = 0;
    while plant.truth().gimbal_rad != [target.azimuth_rad(), target.roll_rad()] {
        plant.step(&command(azimuth, roll));
        samples += 1;
        assert!(samples < 100_000);
    }
    samples
}

#[test]
fn moves_take_the_time_of_their_trapezoid() {
    // The set point is a whole number of counts: its rounding can cost the last sample.
    assert!((2000..=2001).contains(&move_samples(0.0, 90.0)));
    assert!((2000..=2001).contains(&move_samples(-90.0, 0.0)));
    assert!((1100..=1101).contains(&move_samples(0.0, 45.0)));
    // 3.6° never reaches 10 °/s: 2 √(3.6 / 10) s.
    assert!((240..=241).contains(&move_samples(3.6, 0.0)));
    assert!((2000..=2001).contains(&move_samples(90.0, 45.0)), "both at once");
}

/// Command from sample k: first felt in sample k + 2.
#[test]
fn a_command_is_first_felt_two_samples_later() {
    let mut plant = Plant::new(&perfect()).unwrap();
    let level = command(0.0, 0.0);
    let first = plant.step(&level).sample;
    assert_eq!((first.sequence, first.device_time.ns), (1, PERIOD_NS));
    let quiet = run(&mut plant, &level, 9)[8].sample;
    // Computed from sample 10, so that it is passed with the call that delivers sample 11.
    let go = command(0.0, 90.0);
    let eleventh = plant.step(&go).sample;
    assert_eq!(eleventh.sequence, 11);
    assert!((eleventh.delta_theta[0] - quiet.delta_theta[0]).abs() <= 1);
    assert_eq!(eleventh.gimbal.roll, 0);
    let twelfth = plant.step(&go).sample;
    let expected = 0.5 * 10.0 * DEG * DT * DT;
    let felt = f64::from(twelfth.delta_theta[0] - quiet.delta_theta[0]) * DELTA_THETA_LSB_RAD;
    assert!((felt - expected).abs() < 2.0 * DELTA_THETA_LSB_RAD, "{felt} {expected}");
    assert!((twelfth.gimbal.roll_rad() - expected).abs() <= 0.51 * GIMBAL_LSB_RAD);
}

#[test]
fn a_full_turn_closes() {
    let mut config = perfect();
    config.motion = octant_plant::config::Motion::Static(octant_plant::config::CaseAttitude {
        heading_rad: 0.4,
        pitch_rad: 0.1,
        roll_rad: 0.2,
    });
    let mut plant = Plant::new(&config).unwrap();
    let before = run(&mut plant, &command(0.0, 0.0), 200);
    let turn = command(360.0, 0.0);
    let steps = run(&mut plant, &turn, 37 * 200 + 10);
    let after = run(&mut plant, &turn, 200);
    let sum = |steps: &[octant_plant::PlantStep], axis: usize| -> i64 {
        steps.iter().map(|step| i64::from(step.sample.delta_theta[axis])).sum()
    };
    for axis in 0..3 {
        assert!((sum(&before, axis) - sum(&after, axis)).abs() <= 2);
    }
    // About the axis of the turn: one turn and the Earth rate along it, a constant.
    let earth = sum(&before, 2) as f64 / 200.0 * steps.len() as f64;
    let turned = (sum(&steps, 2) as f64 - earth) * DELTA_THETA_LSB_RAD;
    let target = turn.target.azimuth_rad();
    assert!((turned - target).abs() < 50.0 * DELTA_THETA_LSB_RAD, "{}", turned - target);
    let [q, p] = [plant.truth().q_nb, Plant::new(&config).unwrap().truth().q_nb];
    let same: f64 = q.iter().zip(&p).map(|(a, b)| a * b).sum();
    assert!((same.abs() - 1.0).abs() < 1e-14);
}

#[test]
fn the_encoder_repeats_its_error_and_the_body_does_not_feel_it() {
    let mut config = perfect();
    config.turntable.encoder_sigma_rad = 18.0 * ARCSEC;
    let mut plant = Plant::new(&config).unwrap();
    let mut plain = Plant::new(&perfect()).unwrap();
    let mut errors = Vec::new();
    for (azimuth, roll) in [(0.0, 90.0), (90.0, 0.0), (0.0, 90.0)] {
        let go = command(azimuth, roll);
        let (last, without) = (run(&mut plant, &go, 4000), run(&mut plain, &go, 4000));
        for (a, b) in last.iter().zip(&without) {
            assert_eq!(a.sample.delta_theta, b.sample.delta_theta);
            assert_eq!(a.sample.delta_velocity, b.sample.delta_velocity);
        }
        let error = last[3999].sample.gimbal.roll - without[3999].sample.gimbal.roll;
        assert_eq!(without[3999].sample.gimbal, go.target);
        errors.push(f64::from(error) * GIMBAL_LSB_RAD);
    }
    assert_eq!(errors[0], errors[2]);
    assert!(errors[0] != errors[1] && errors.iter().all(|e| e.abs() < 72.0 * ARCSEC && *e != 0.0));
}

#[test]
fn the_body_lags_by_half_of_the_play_on_the_side_that_it_came_from() {
    let mut config = perfect();
    let play = 40.0 * ARCSEC;
    config.turntable.backlash_rad = play;
    let mut plant = Plant::new(&config).unwrap();
    let mut last = 0.0;
    for (roll, lag) in [(90.0, -0.5), (180.0, -0.5), (90.0, 0.5), (45.0, 0.5), (90.0, -0.5)] {
        let go = command(0.0, roll);
        let steps = run(&mut plant, &go, 4000);
        let body = plant.truth().gimbal_rad[1];
        let target = go.target.roll_rad();
        assert!((body - (target + lag * play)).abs() < 1e-12, "{roll}");
        assert_eq!(steps[3999].sample.gimbal, go.target, "the encoder is on the drive");
        // The gyros integrate the motion of the body, apart from Earth rate about the gimbal's
        // axis.
        let sum: i64 = steps.iter().map(|s| i64::from(s.sample.delta_theta[0])).sum();
        let earth = 7.292115e-5 * libm::cos(30.5 * DEG) * 20.0;
        let turned = sum as f64 * DELTA_THETA_LSB_RAD - earth;
        assert!((turned - (body - last)).abs() < 3.0 * DELTA_THETA_LSB_RAD);
        last = body;
    }
}

#[test]
fn non_orthogonality_tilts_the_inner_axis_towards_the_outer() {
    let mut config = perfect();
    config.turntable.non_orthogonality_rad = 1e-3;
    let mut plant = Plant::new(&config).unwrap();
    // At (0, 0) the inner axis leans by 1 mrad, and the x accelerometer measures g sin η.
    let steps = run(&mut plant, &command(0.0, 0.0), 1000);
    let sum = |axis: usize| -> f64 {
        steps.iter().map(|step| f64::from(step.sample.delta_velocity[axis])).sum()
    };
    let ratio = sum(0) / sum(2);
    // Half a count in 5e10 counts.
    assert!((ratio + libm::tan(1e-3)).abs() < 2e-11, "{ratio}");
}

/// Down in the body by hand, for a mounting about x alone at (azimuth, roll) = (90°, 90°): down of the case
/// is y of the outer gimbal's ring, x of the inner gimbal's, and a turn about x leaves that where it is. At
/// (0°, 90°) it is y of the inner gimbal's, and a body that is turned by μ about x sees it at (0, cos μ, −sin μ).
#[test]
fn a_mounting_turns_the_body_on_the_inner_gimbal() {
    let mut config = perfect();
    let mu = 2e-3;
    config.turntable.errors.mounting_rad = [mu, 0.0, 0.0];
    for (azimuth, expected) in
        [(90.0, [1.0, 0.0, 0.0]), (0.0, [0.0, libm::cos(mu), -libm::sin(mu)])]
    {
        let mut plant = Plant::new(&config).unwrap();
        let go = command(azimuth, 90.0);
        run(&mut plant, &go, 4000);
        let steps = run(&mut plant, &go, 1000);
        let sums: Vec<f64> = (0..3)
            .map(|axis| steps.iter().map(|step| f64::from(step.sample.delta_velocity[axis])).sum())
            .collect();
        let whole = sums.iter().map(|sum| sum * sum).sum::<f64>().sqrt();
        for axis in 0..3 {
            // The force is up. Half a count in 5e10, and the gimbals' angles are counts of 7.5e-9 rad.
            let found = -sums[axis] / whole;
            assert!((found - expected[axis]).abs() < 5e-9, "{azimuth} {axis}: {found}");
        }
    }
}

/// The truth of the attitude is the product of the rotations, `Rx(roll) · Ry(η) · Rz(azimuth) · exp([μ×])`, and the
/// samples integrate to it: what the case, level and heading north, sees of the body after the moves.
#[test]
fn the_truth_of_a_mounted_body_is_the_product_of_its_rotations() {
    let mut config = perfect();
    config.turntable.non_orthogonality_rad = 1e-3;
    config.turntable.errors.mounting_rad = [2e-3, -1e-3, 3e-3];
    let mut plant = Plant::new(&config).unwrap();
    let go = command(90.0, 270.0);
    run(&mut plant, &go, 8000);
    let [w, x, y, z] = plant.truth().q_nb;
    let found = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(w, x, y, z))
        .to_rotation_matrix()
        .into_inner();
    let (azimuth, roll) = (go.target.azimuth_rad(), go.target.roll_rad());
    let mu = nalgebra::Vector3::new(2e-3, -1e-3, 3e-3);
    // Rodrigues.
    let k = octant_earth::rotation::skew(&(mu / mu.norm()));
    let mounted = nalgebra::Matrix3::identity()
        + k * libm::sin(mu.norm())
        + k * k * (1.0 - libm::cos(mu.norm()));
    let expected = octant_earth::rotation::rx(roll)
        * octant_earth::rotation::ry(1e-3)
        * octant_earth::rotation::rz(azimuth)
        * mounted;
    assert!((found - expected).amax() < 1e-14);
}

/// Zero error and eccentricity are measured − true, in the angles alone; the noise has its size, is white, and
/// depends on the number of the sample alone.
#[test]
fn encoders_read_what_their_coefficients_say() {
    let mut config = perfect();
    let errors = &mut config.turntable.errors;
    errors.encoder_zero_rad = [30.0 * ARCSEC, -20.0 * ARCSEC];
    errors.eccentricity_rad = [[5.0 * ARCSEC, 7.0 * ARCSEC], [-4.0 * ARCSEC, 9.0 * ARCSEC]];
    for (azimuth, roll, expected) in [
        (0.0, 0.0, [35.0, -24.0]),
        (90.0, 180.0, [37.0, -16.0]),
        (180.0, 90.0, [25.0, -11.0]),
        (30.0, 0.0, [30.0 + 5.0 * 0.75f64.sqrt() + 3.5, -24.0]),
    ] {
        let mut plant = Plant::new(&config).unwrap();
        let go = command(azimuth, roll);
        let at = run(&mut plant, &go, 5000)[4999].sample.gimbal;
        let off = [at.azimuth - go.target.azimuth, at.roll - go.target.roll];
        for axis in 0..2 {
            let found = f64::from(off[axis]) * GIMBAL_LSB_RAD;
            assert!((found - expected[axis] * ARCSEC).abs() < GIMBAL_LSB_RAD, "{azimuth} {roll}");
        }
    }
    let quiet = run(&mut Plant::new(&config).unwrap(), &command(0.0, 0.0), 4000);
    config.turntable.errors.encoder_noise_rad = 2.0 * ARCSEC;
    let noisy = run(&mut Plant::new(&config).unwrap(), &command(0.0, 0.0), 4000);
    let (mut squares, mut products, mut last) = (0.0, 0.0, 0.0);
    for (a, b) in noisy.iter().zip(&quiet) {
        assert_eq!(a.sample.delta_theta, b.sample.delta_theta);
        assert_eq!(a.sample.delta_velocity, b.sample.delta_velocity);
        for (a, b) in [
            (a.sample.gimbal.azimuth, b.sample.gimbal.azimuth),
            (a.sample.gimbal.roll, b.sample.gimbal.roll),
        ] {
            let noise = f64::from(a - b) * GIMBAL_LSB_RAD / (2.0 * ARCSEC);
            squares += noise * noise / 8000.0;
            products += noise * last / 8000.0;
            last = noise;
        }
    }
    // Five standard errors of 8000 numbers.
    assert!((squares - 1.0).abs() < 5.0 * (2.0f64 / 8000.0).sqrt(), "{squares}");
    assert!(products.abs() < 5.0 / 8000f64.sqrt(), "{products}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Any finite sequence of set points: limits hold at every sample, no overshoot once the last
    /// one is approached from rest or from behind, and it is reached.
    #[test]
    fn any_commands_keep_the_limits_and_arrive(
        commands in prop::collection::vec((-800.0..800.0f64, -800.0..800.0f64, 1u64..1500), 1..6),
    ) {
        let mut plant = Plant::new(&perfect()).unwrap();
        let (rate, acceleration) = (10.0 * DEG, 10.0 * DEG);
        let mut angles = vec![plant.truth().gimbal_rad];
        let mut last = 0;
        for (azimuth, roll, samples) in &commands {
            let go = command(*azimuth, *roll);
            last = angles.len();
            for _ in 0..*samples {
                plant.step(&go);
                angles.push(plant.truth().gimbal_rad);
            }
        }
        let (azimuth, roll, _) = commands[commands.len() - 1];
        let go = command(azimuth, roll);
        // 1600° at 10 °/s, with braking and acceleration.
        for _ in 0..33_000 {
            plant.step(&go);
            angles.push(plant.truth().gimbal_rad);
        }
        let target = [go.target.azimuth_rad(), go.target.roll_rad()];
        prop_assert_eq!(plant.truth().gimbal_rad, target);
        for axis in 0..2 {
            let angle = |k: usize| angles[k][axis];
            let speed = |k: usize| (angle(k) - angle(k - 1)) / DT;
            for k in 1..angles.len() {
                prop_assert!(speed(k).abs() <= rate + 1e-9);
                if k > 1 {
                    prop_assert!((speed(k) - speed(k - 1)).abs() / DT <= acceleration + 1e-7);
                }
            }
            // Once the gimbal moves towards the last target with room to stop, it never passes it.
            let side = |k: usize| target[axis] - angle(k);
            let room = |k: usize| {
                let v = speed(k);
                v == 0.0 || (v * side(k) > 0.0 && side(k).abs() >= v * v / (2.0 * acceleration))
            };
            let from = (last + 2..angles.len()).find(|k| room(*k)).unwrap();
            let sign = side(from).signum();
            for k in from..angles.len() {
                prop_assert!(side(k) * sign >= -1e-12, "overshoot {}", side(k));
            }
        }
    }
}
