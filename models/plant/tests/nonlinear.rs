//! Asymmetry, second order and a disturbance of gravity against closed forms.

use super::common::*;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCSEC, DEG, MICRO_G, PPM};
use octant_plant::Plant;
use octant_plant::config::*;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};

/// Half a count at each end of 1000 samples, rad/s and m/s².
const RATE_RESOLUTION: f64 = DELTA_THETA_LSB_RAD / 5.0;
const FORCE_RESOLUTION: f64 = DELTA_VELOCITY_LSB_MPS / 5.0;

fn gravity() -> f64 {
    Ellipsoid::at(LATITUDE, 40.0).gravity_mps2
}

/// Sums of the increments over samples, in b: rad and m/s.
fn sums(plant: &mut Plant, azimuth: f64, roll: f64, samples: u64) -> [[f64; 3]; 2] {
    let steps = run(plant, &command(azimuth, roll), samples);
    let sum = |counts: &dyn Fn(usize) -> i32| (0..steps.len()).map(|k| i64::from(counts(k))).sum();
    let of = |total: i64, lsb: f64| total as f64 * lsb;
    [
        std::array::from_fn(|i| of(sum(&|k| steps[k].sample.delta_theta[i]), DELTA_THETA_LSB_RAD)),
        std::array::from_fn(|i| {
            of(sum(&|k| steps[k].sample.delta_velocity[i]), DELTA_VELOCITY_LSB_MPS)
        }),
    ]
}

/// Mean rate and specific force in a dwell, after 40 s for the moves to it.
fn at_rest(config: &PlantConfig, azimuth: f64, roll: f64) -> [[f64; 3]; 2] {
    let mut plant = Plant::new(config).unwrap();
    run(&mut plant, &command(azimuth, roll), (40.0 / DT) as u64);
    sums(&mut plant, azimuth, roll, 1000).map(|sum| sum.map(|sum| sum / (1000.0 * DT)))
}

#[test]
fn asymmetry_and_second_order_add_to_readings_of_both_signs() {
    let mut config = perfect();
    let (of_gyros, of_force) =
        ([30.0 * PPM, -20.0 * PPM, 50.0 * PPM], [20.0 * PPM, 0.0, -40.0 * PPM]);
    let square = [0.0, 10.0 * MICRO_G / 96.0, -20.0 * MICRO_G / 96.0];
    config.imu.extensions.gyro_asymmetry = of_gyros;
    config.imu.extensions.accel_asymmetry = of_force;
    config.imu.extensions.accel_quadratic = square;
    for (azimuth, roll) in [(0.0, 0.0), (0.0, 180.0), (0.0, 90.0), (180.0, 90.0), (90.0, 90.0)] {
        let [rate, force] = at_rest(&config, azimuth, roll);
        let [true_rate, true_force] = at_rest(&perfect(), azimuth, roll);
        for axis in 0..3 {
            let more = of_gyros[axis] * true_rate[axis].abs();
            assert!((rate[axis] - true_rate[axis] - more).abs() <= 2.0 * RATE_RESOLUTION);
            let f = true_force[axis];
            let more = of_force[axis] * f.abs() + square[axis] * f * f;
            assert!((force[axis] - f - more).abs() <= 2.0 * FORCE_RESOLUTION, "{axis}");
        }
    }
    let [_, up] = at_rest(&config, 0.0, 0.0);
    let g = gravity();
    assert!((up[2] + g - of_force[2] * g - square[2] * g * g).abs() <= 2.0 * FORCE_RESOLUTION);
}

/// After a turn and its return a symmetric gyro shows Earth rate alone. An asymmetric one also shows
/// twice the angle times its coefficient.
#[test]
fn an_asymmetric_gyro_gains_by_a_turn_and_back() {
    let mut config = perfect();
    let asymmetry = 100.0 * PPM;
    config.imu.extensions.gyro_asymmetry = [0.0, 0.0, asymmetry];
    let there_and_back = |config: &PlantConfig| {
        let mut plant = Plant::new(config).unwrap();
        let samples = (15.0 / DT) as u64;
        let there = sums(&mut plant, 90.0, 0.0, samples)[0][2];
        there + sums(&mut plant, 0.0, 0.0, samples)[0][2]
    };
    let gained = there_and_back(&config) - there_and_back(&perfect());
    // The Earth's rate counts while the gimbal rests, for 10 s; in the moves it cancels.
    let earth = EARTH_RATE * libm::sin(LATITUDE) * 10.0;
    assert!((gained - asymmetry * (180.0 * DEG + earth)).abs() < 1e-9, "{gained:e}");
}

#[test]
fn a_disturbance_of_gravity_is_felt_in_the_navigation_frame() {
    let disturbance = GravityDisturbance {
        deflection_north_rad: 20.0 * ARCSEC,
        deflection_east_rad: -30.0 * ARCSEC,
        anomaly_mps2: 50e-5,
    };
    let g = gravity();
    let calm = Motion::Dockside(Dockside::calm(CaseAttitude::default()));
    for motion in [perfect().motion, calm] {
        let mut config = perfect();
        config.motion = motion;
        config.site.gravity = disturbance;
        let [_, level] = at_rest(&config, 0.0, 0.0);
        // Force is the negative of gravity: (ξ g, η g, −g − Δg).
        let expected = [20.0 * ARCSEC * g, -30.0 * ARCSEC * g, -g - 50e-5];
        for axis in 0..3 {
            assert!((level[axis] - expected[axis]).abs() <= 2.0 * FORCE_RESOLUTION, "{axis}");
        }
        // After a roll of 90°, body z is west and body y is down.
        let [_, rolled] = at_rest(&config, 0.0, 90.0);
        let expected = [expected[0], expected[2], -expected[1]];
        for axis in 0..3 {
            // The set point is rounded to 7.5e-9 rad, of gravity 4e-8 m/s².
            assert!((rolled[axis] - expected[axis]).abs() <= 4e-8, "{axis}");
        }
        // The body itself is where it was.
        let truth = Plant::new(&config).unwrap().truth();
        assert_eq!(truth.q_nb, Plant::new(&perfect()).unwrap().truth().q_nb);
    }
}

#[test]
fn what_is_out_of_range_is_refused() {
    let mut config = perfect();
    config.site.gravity.anomaly_mps2 = 1.0;
    assert_eq!(
        Plant::new(&config).unwrap_err().to_string(),
        "site.gravity.anomaly_mps2 is 1, expected within ±0.1 m/s²"
    );
    let mut config = perfect();
    config.imu.extensions.accel_quadratic[1] = f64::NAN;
    assert_eq!(
        Plant::new(&config).unwrap_err().to_string(),
        "imu.extensions.accel_quadratic[1] is NaN, expected within ±0.01"
    );
}
