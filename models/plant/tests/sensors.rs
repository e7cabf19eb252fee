//! The error model and every extension against closed forms.

use super::common::*;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCSEC, DEG, DEG_PER_HOUR, DEG_PER_HOUR_PER_G, MICRO_G, PPM};
use octant_plant::config::*;
use octant_plant::{Plant, PlantStep};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{Parameters, Status};

fn gravity() -> f64 {
    Ellipsoid::at(LATITUDE, 40.0).gravity_mps2
}

/// Mean rate (rad/s) and specific force (m/s²) over samples.
fn mean(steps: &[PlantStep]) -> ([f64; 3], [f64; 3]) {
    let time = steps.len() as f64 * DT;
    let sum = |counts: fn(&PlantStep) -> [i32; 3], axis: usize| -> f64 {
        steps.iter().map(|step| i64::from(counts(step)[axis])).sum::<i64>() as f64
    };
    (
        core::array::from_fn(|i| sum(|s| s.sample.delta_theta, i) * DELTA_THETA_LSB_RAD / time),
        core::array::from_fn(|i| {
            sum(|s| s.sample.delta_velocity, i) * DELTA_VELOCITY_LSB_MPS / time
        }),
    )
}

/// Means at rest at gimbal angles, in the dwell after the move.
fn at_rest(config: &PlantConfig, azimuth: f64, roll: f64, samples: u64) -> ([f64; 3], [f64; 3]) {
    let mut plant = Plant::new(config).unwrap();
    let go = command(azimuth, roll);
    while plant.truth().gimbal_rad != [go.target.azimuth_rad(), go.target.roll_rad()] {
        plant.step(&go);
    }
    plant.step(&go);
    mean(&run(&mut plant, &go, samples))
}

/// Half a count at each end of 1000 samples, rad/s and m/s².
const RATE_RESOLUTION: f64 = DELTA_THETA_LSB_RAD / 5.0;
const FORCE_RESOLUTION: f64 = DELTA_VELOCITY_LSB_MPS / 5.0;

#[test]
fn a_level_still_base_feels_earth_rate_and_gravity() {
    let (rate, force) = at_rest(&perfect(), 0.0, 0.0, 1000);
    let expected = [EARTH_RATE * libm::cos(LATITUDE), 0.0, -EARTH_RATE * libm::sin(LATITUDE)];
    for axis in 0..3 {
        assert!((rate[axis] - expected[axis]).abs() <= RATE_RESOLUTION);
    }
    assert!(force[0].abs() <= FORCE_RESOLUTION && force[1].abs() <= FORCE_RESOLUTION);
    assert!((force[2] + gravity()).abs() <= FORCE_RESOLUTION);
}

/// Down in body is (sin r sin a, sin r cos a, cos r).
#[test]
fn gravity_in_body_follows_the_gimbals() {
    for (azimuth, roll) in [(0.0, 90.0), (90.0, 45.0), (37.0, -120.0)] {
        let (_, force) = at_rest(&perfect(), azimuth, roll, 1000);
        let (sa, ca) = libm::sincos(azimuth * DEG);
        let (sr, cr) = libm::sincos(roll * DEG);
        for (axis, down) in [sr * sa, sr * ca, cr].into_iter().enumerate() {
            // The set point is rounded to 2⁻²⁷ rad.
            assert!((force[axis] + gravity() * down).abs() < 1e-7);
        }
    }
}

/// Every parameter alone, in an attitude in which all components have an effect.
#[test]
fn every_parameter_adds_what_the_model_says() {
    let (azimuth, roll) = (35.0, 50.0);
    let (rate, force) = at_rest(&perfect(), azimuth, roll, 1000);
    let sizes = [
        (0..3, 10.0 * DEG_PER_HOUR),
        (3..12, 0.1),
        (12..21, 10.0 * DEG_PER_HOUR_PER_G),
        (21..24, 1000.0 * MICRO_G),
        (24..30, 1e-3),
    ];
    for (range, size) in sizes {
        for index in range {
            let mut all = [0.0; 30];
            all[index] = size;
            let mut config = perfect();
            config.imu.parameters = Parameters::from_array(&all);
            let p = &config.imu.parameters;
            let (found_rate, found_force) = at_rest(&config, azimuth, roll, 1000);
            for i in 0..3 {
                let row = |m: [[f64; 3]; 3], v: &[f64; 3]| -> f64 {
                    (0..3).map(|j| m[i][j] * v[j]).sum()
                };
                let gyro = p.gyro_bias[i] + row(p.gyro_matrix(), &rate) + row(p.g_matrix(), &force);
                let accelerometer = p.accel_bias[i] + row(p.accel_matrix(), &force);
                let slack = 1.2;
                assert!(
                    (found_rate[i] - rate[i] - gyro).abs() <= 2.0 * slack * RATE_RESOLUTION,
                    "parameter {index}, gyro {i}"
                );
                assert!(
                    (found_force[i] - force[i] - accelerometer).abs()
                        <= 2.0 * slack * FORCE_RESOLUTION,
                    "parameter {index}, accelerometer {i}"
                );
            }
        }
    }
}

#[test]
fn table_1_parameters_do_not_saturate_and_a_range_does() {
    let mut config = noisy();
    config.imu.parameters =
        octant_plant::draw::parameters(1, &octant_plant::draw::ParameterDraws::table_1());
    config.imu.extensions.accel_range_mps2 = 40.0 * 9.80665;
    config.imu.extensions.gyro_range_radps = 300.0 * DEG;
    let mut plant = Plant::new(&config).unwrap();
    run(&mut plant, &command(90.0, 0.0), 3000);
    assert_eq!(plant.saturated_samples(), 0);

    // A range of 4 °/s clips the cruise of the move, and 9 m/s² gravity.
    let mut config = perfect();
    config.imu.extensions.gyro_range_radps = 4.0 * DEG;
    let mut plant = Plant::new(&config).unwrap();
    let steps = run(&mut plant, &command(90.0, 0.0), 3000);
    let flagged: Vec<_> =
        steps.iter().filter(|s| s.sample.status == Status::GYRO_SATURATED).collect();
    assert_eq!(plant.saturated_samples(), flagged.len() as u64);
    // 10 s less 0.4 s at each end, and the part of Earth rate.
    assert!((1839..=1842).contains(&flagged.len()), "{}", flagged.len());
    let clipped = 4.0 * DEG * DT / DELTA_THETA_LSB_RAD;
    for step in flagged {
        assert!((f64::from(step.sample.delta_theta[2]) - clipped).abs() <= 1.0);
    }
    let mut config = perfect();
    config.imu.extensions.accel_range_mps2 = 9.0;
    let (_, force) = at_rest(&config, 0.0, 0.0, 1000);
    assert!((force[2] + 9.0).abs() <= FORCE_RESOLUTION);
}

/// The format itself: a count beyond the format saturates, is flagged and counted.
#[test]
fn beyond_the_format_the_counts_saturate() {
    let mut config = perfect();
    config.sample_period_ns = 1_000_000_000;
    let mut plant = Plant::new(&config).unwrap();
    let sample = plant.step(&command(0.0, 0.0)).sample;
    assert_eq!(sample.status, Status::ACCELEROMETER_SATURATED);
    assert_eq!(sample.delta_velocity[2], i32::MIN);
    assert_eq!(plant.saturated_samples(), 1);
}

#[test]
fn quantized_increments_are_multiples_and_lose_nothing() {
    let mut config = noisy();
    let quantum = 1024.0 * DELTA_VELOCITY_LSB_MPS;
    config.imu.extensions.accel_quantization_mps = quantum;
    let mut plant = Plant::new(&config).unwrap();
    let mut fine = Plant::new(&noisy()).unwrap();
    let mut difference = 0i64;
    for _ in 0..5000 {
        let coarse = plant.step(&command(0.0, 0.0)).sample.delta_velocity[2];
        assert_eq!(coarse % 1024, 0);
        difference +=
            i64::from(coarse) - i64::from(fine.step(&command(0.0, 0.0)).sample.delta_velocity[2]);
        assert!(difference.abs() <= 513);
    }
}

#[test]
fn temperature_ramps_to_its_plateau_and_acts_on_bias_and_scale() {
    let mut config = perfect();
    let temperature = Temperature {
        ramp_kps: 0.5,
        plateau_k: 10.0,
        gyro_bias_per_k: [DEG_PER_HOUR, 2.0 * DEG_PER_HOUR, -DEG_PER_HOUR],
        accel_bias_per_k: [100.0 * MICRO_G, 0.0, 0.0],
        gyro_scale_per_k: [0.0, 0.0, 1e-3],
        accel_scale_per_k: [0.0, 0.0, 10.0 * PPM],
    };
    config.imu.extensions.temperature = Some(temperature);
    let mut plant = Plant::new(&config).unwrap();
    let level = command(0.0, 0.0);
    let (base_rate, base_force) = at_rest(&perfect(), 0.0, 0.0, 1000);
    // Five seconds each: mean changes 1.25, 3.75, 6.25, 8.75 K, then the plateau.
    for change in [1.25, 3.75, 6.25, 8.75, 10.0, 10.0] {
        let (rate, force) = mean(&run(&mut plant, &level, 1000));
        for axis in 0..3 {
            let gyro = change
                * (temperature.gyro_bias_per_k[axis]
                    + temperature.gyro_scale_per_k[axis] * base_rate[axis]);
            assert!((rate[axis] - base_rate[axis] - gyro).abs() <= 2.5 * RATE_RESOLUTION);
            let accelerometer = change
                * (temperature.accel_bias_per_k[axis]
                    + temperature.accel_scale_per_k[axis] * base_force[axis]);
            assert!(
                (force[axis] - base_force[axis] - accelerometer).abs() <= 2.5 * FORCE_RESOLUTION
            );
        }
    }
}

/// Angular vibration about an axis, sample by sample: Δθ is the difference of the angle. Linear
/// vibration: Δv is the difference of the velocity.
#[test]
fn vibration_is_felt_as_the_difference_of_its_angle_and_velocity() {
    let mut config = perfect();
    let (frequency, alpha, d) = (37.0, 1e-4, 2e-5);
    config.imu.extensions.vibration = Some(Vibration {
        frequency_hz: frequency,
        displacement_m: [0.0, 0.0, d],
        angle_rad: [0.0, 0.0, alpha],
        phase_rad: 0.3,
    });
    let mut plant = Plant::new(&config).unwrap();
    let omega = 2.0 * core::f64::consts::PI * frequency;
    let earth = -EARTH_RATE * libm::sin(LATITUDE) * DT;
    for k in 0..400 {
        let sample = plant.step(&command(0.0, 0.0)).sample;
        let (a, b) = (f64::from(k) * DT, f64::from(k + 1) * DT);
        let angle = |t: f64| alpha * libm::sin(omega * t + 0.3);
        let speed = |t: f64| d * omega * libm::cos(omega * t);
        let theta = f64::from(sample.delta_theta[2]) * DELTA_THETA_LSB_RAD;
        assert!((theta - earth - (angle(b) - angle(a))).abs() < 1.1 * DELTA_THETA_LSB_RAD);
        let velocity = f64::from(sample.delta_velocity[2]) * DELTA_VELOCITY_LSB_MPS;
        let expected = speed(b) - speed(a) - gravity() * DT;
        // Earth rate times the vibration's speed, along z: below 1e-12 m/s.
        assert!((velocity - expected).abs() < 1.1 * DELTA_VELOCITY_LSB_MPS, "{k}");
    }
}

/// Sculling: angular and linear vibration in phase rectify to a mean specific force `½ Ω² cos φ (α
/// × d)`, less the curvature of the swing `−¼ α² f` across the axis.
#[test]
fn vibration_in_step_sculls() {
    let (frequency, alpha, d) = (50.0, 1e-3, 1e-4);
    let omega = 2.0 * core::f64::consts::PI * frequency;
    for phase in [0.0, 1.0, core::f64::consts::FRAC_PI_2] {
        let mut config = perfect();
        config.imu.extensions.vibration = Some(Vibration {
            frequency_hz: frequency,
            displacement_m: [0.0, d, 0.0],
            angle_rad: [alpha, 0.0, 0.0],
            phase_rad: phase,
        });
        // 1000 samples are 250 periods.
        let (_, force) = at_rest(&config, 0.0, 0.0, 1000);
        let (_, still) = at_rest(&perfect(), 0.0, 0.0, 1000);
        let sculling = 0.5 * omega * omega * alpha * d * libm::cos(phase);
        let swing = 0.25 * alpha * alpha * gravity();
        let error = force[2] - still[2] - sculling - swing;
        // Fourth order: α² times the rest.
        assert!(error.abs() < 2.0 * FORCE_RESOLUTION + alpha * alpha * sculling.abs(), "{error}");
    }
}

/// Under a turn the vibrating block feels Coriolis `2 ω × ṙ`: the velocity of a point that turns.
#[test]
fn vibration_under_a_turn_feels_coriolis() {
    let mut config = perfect();
    let (frequency, d) = (20.0, 1e-3);
    config.imu.extensions.vibration = Some(Vibration {
        frequency_hz: frequency,
        displacement_m: [d, 0.0, 0.0],
        angle_rad: [0.0; 3],
        phase_rad: 0.0,
    });
    let (mut plant, mut plain) = (Plant::new(&config).unwrap(), Plant::new(&perfect()).unwrap());
    let go = command(90.0, 0.0);
    run(&mut plant, &go, 1000);
    run(&mut plain, &go, 1000);
    let omega = 2.0 * core::f64::consts::PI * frequency;
    let spin = 10.0 * DEG - EARTH_RATE * libm::sin(LATITUDE);
    for k in 1000..1200 {
        let (a, b) = (plant.step(&go).sample, plain.step(&go).sample);
        let (t0, t1) = (f64::from(k) * DT, f64::from(k + 1) * DT);
        // ∫ 2 ω ṙ dt along y, and −ω² r along x beside the vibration itself.
        let moved = d * (libm::sin(omega * t1) - libm::sin(omega * t0));
        let speed = d * omega * (libm::cos(omega * t1) - libm::cos(omega * t0));
        let centripetal = spin * spin * d / omega * (libm::cos(omega * t1) - libm::cos(omega * t0));
        let felt = |axis: usize| {
            f64::from(a.delta_velocity[axis] - b.delta_velocity[axis]) * DELTA_VELOCITY_LSB_MPS
        };
        // Earth rate across the axis: 2 · 6.3e-5 rad/s · 2 mm, 2.5e-7 m/s.
        assert!((felt(1) - 2.0 * spin * moved).abs() < 3e-7, "{k}");
        assert!(
            (felt(0) - speed - centripetal).abs() < 3e-9,
            "{k} {}",
            felt(0) - speed - centripetal
        );
    }
}

/// Size effect in a turn about z: −ω² p along the arm, α p across it while the rate changes.
#[test]
fn lever_arms_feel_centripetal_and_tangential_acceleration() {
    let mut config = perfect();
    let p = 0.05;
    config.imu.extensions.lever_arm_m = [[p, 0.0, 0.0], [p, 0.0, 0.0], [0.0; 3]];
    let (mut plant, mut plain) = (Plant::new(&config).unwrap(), Plant::new(&perfect()).unwrap());
    let go = command(90.0, 0.0);
    let earth = EARTH_RATE * libm::sin(LATITUDE);
    for k in 0..2100 {
        let (a, b) = (plant.step(&go).sample, plain.step(&go).sample);
        let felt = |axis: usize| {
            f64::from(a.delta_velocity[axis] - b.delta_velocity[axis]) * DELTA_VELOCITY_LSB_MPS
        };
        // Gimbal's rate at the ends of the interval; the move begins with the second sample.
        let rate = |t: f64| 10.0 * DEG * t.min(10.0 - t).clamp(0.0, 1.0) - earth;
        let (t0, t1) = (f64::from(k - 1) * DT, f64::from(k) * DT);
        let tangential = p * (rate(t1) - rate(t0));
        let (w0, w1) = (rate(t0), rate(t1));
        let centripetal = -p * (w0 * w0 + w0 * w1 + w1 * w1) / 3.0 * DT;
        // The set point's rounding shifts the end of the move by nanoseconds.
        assert!((felt(1) - tangential).abs() < 3e-9, "{k}");
        assert!((felt(0) - centripetal).abs() < 3e-9, "{k}");
        assert!(felt(2).abs() < 3e-9);
        assert_eq!(a.delta_theta, b.delta_theta);
    }
}

/// A skew of whole periods is a delay of the counts against the angles; one of half a period
/// splits the increments of a constant acceleration in the middle.
#[test]
fn time_skew_delays_the_inertial_data() {
    let mut late = perfect();
    late.imu.extensions.time_skew_s = 3.0 * DT;
    let mut half = perfect();
    half.imu.extensions.time_skew_s = 0.5 * DT;
    let go = command(90.0, 0.0);
    let all = |config: &PlantConfig| run(&mut Plant::new(config).unwrap(), &go, 2200);
    let (base, late, half) = (all(&perfect()), all(&late), all(&half));
    let angle = |steps: &[PlantStep], to: usize| -> f64 {
        let sum: i64 = steps[..to].iter().map(|s| i64::from(s.sample.delta_theta[2])).sum();
        sum as f64 * DELTA_THETA_LSB_RAD
    };
    let earth = EARTH_RATE * libm::sin(LATITUDE);
    let body = |t: f64| {
        let t = t.clamp(0.0, 10.0);
        let rise = 5.0 * DEG;
        if t < 1.0 {
            rise * t * t
        } else if t > 9.0 {
            90.0 * DEG - rise * (10.0 - t) * (10.0 - t)
        } else {
            rise + 10.0 * DEG * (t - 1.0)
        }
    };
    for k in 0..2200 {
        assert_eq!(base[k].sample.gimbal, late[k].sample.gimbal);
        assert_eq!(base[k].sample.gimbal, half[k].sample.gimbal);
        let t = (k as f64) * DT;
        let turned = |skew: f64| body(t - skew) - earth * (t + DT);
        // The set point is up to 2⁻²⁸ rad from 90°.
        assert!((angle(&late, k + 1) - turned(3.0 * DT)).abs() < 4e-9, "{k}");
        assert!((angle(&half, k + 1) - turned(0.5 * DT)).abs() < 4e-9, "{k}");
        assert!((angle(&base, k + 1) - turned(0.0)).abs() < 4e-9, "{k}");
    }
}

#[test]
fn a_clone_goes_on_as_the_original() {
    fn sendable<T: Send + Clone>(value: &T) -> T {
        value.clone()
    }
    let mut config = noisy();
    config.motion = Motion::Dockside(octant_plant::motion::dockside_default(2));
    config.imu.extensions.time_skew_s = 0.012;
    let mut plant = Plant::new(&config).unwrap();
    run(&mut plant, &command(40.0, 20.0), 700);
    let mut clone = sendable(&plant);
    assert_eq!(
        run(&mut plant, &command(-40.0, 20.0), 700),
        run(&mut clone, &command(-40.0, 20.0), 700)
    );
    assert_eq!(plant.truth(), clone.truth());
}

#[test]
fn what_can_not_be_computed_is_refused_by_name() {
    type Change = fn(&mut PlantConfig);
    let refused = |change: Change| {
        let mut config = noisy();
        change(&mut config);
        Plant::new(&config).unwrap_err()
    };
    let error = refused(|c| c.aiding.period_ns = 7_000_000);
    assert_eq!(
        error.to_string(),
        "aiding.period_ns is 7000000, expected a multiple of the sample period, 5000000 ns"
    );
    let cases: [(Change, &str); 13] = [
        (|c| c.sample_period_ns = 0, "sample_period_ns"),
        (|c| c.site.latitude_rad = 90.0 * DEG, "site.latitude_rad"),
        (|c| c.site.latitude_rad = f64::NAN, "site.latitude_rad"),
        (|c| c.turntable.rate_radps = 0.0, "turntable.rate_radps"),
        (|c| c.turntable.encoder_sigma_rad = -ARCSEC, "turntable.encoder_sigma_rad"),
        (|c| c.imu.angle_random_walk = f64::INFINITY, "imu.angle_random_walk"),
        (|c| c.imu.parameters.g_dependent[8] = f64::NAN, "imu.parameters.g_zz"),
        (|c| c.imu.extensions.time_skew_s = -0.001, "imu.extensions.time_skew_s"),
        (
            |c| c.imu.extensions.accel_bias_instability = -MICRO_G,
            "imu.extensions.accel_bias_instability",
        ),
        (
            |c| c.imu.extensions.gyro_quantization_rad = 1e-12,
            "imu.extensions.gyro_quantization_rad",
        ),
        (
            |c| {
                c.imu.extensions.gyro_gauss_markov =
                    Some(GaussMarkov { sigma: 1.0, correlation_time_s: 0.0 });
            },
            "imu.extensions.gyro_gauss_markov.correlation_time_s",
        ),
        (
            |c| {
                let mut ship = octant_plant::motion::dockside_default(1);
                ship.heave[0].period_s = 0.0;
                c.motion = Motion::Dockside(ship);
            },
            "motion.heave[0].period_s",
        ),
        (|c| c.aiding.kind = AidingKind::DockPosition { sigma_m: -1.0 }, "aiding.sigma_m"),
    ];
    for (change, field) in cases {
        assert_eq!(refused(change).field, field);
    }
}
