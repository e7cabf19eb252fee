//! A plant whose coefficients change while it runs, against one that had them from the start: noise follows from the
//! sample's number and increments from the motion, so that sums of counts differ by the carried remainders alone.

use super::common::*;
use octant_earth::units::{ARCSEC, DEG, DEG_PER_HOUR, DEG_PER_HOUR_PER_G, MICRO_G, PPM};
use octant_plant::config::*;
use octant_plant::{Plant, PlantStep};
use octant_sample::Parameters;
use octant_sample::Status;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::parameters::{PARAMETER_COUNT, ParameterGroup};

/// Samples before and after the change. It falls into a move, which ends after it.
const BEFORE: u64 = 700;
const AFTER: u64 = 1500;

/// Counts of all six channels.
fn counts(step: &PlantStep) -> [i64; 6] {
    let (theta, velocity) = (step.sample.delta_theta, step.sample.delta_velocity);
    std::array::from_fn(|i| i64::from(if i < 3 { theta[i] } else { velocity[i - 3] }))
}

/// Largest differences of the sums of counts.
fn apart(a: &[PlantStep], b: &[PlantStep]) -> [i64; 6] {
    let (mut sum, mut largest) = ([0; 6], [0; 6]);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (counts(a), counts(b));
        for i in 0..6 {
            sum[i] += a[i] - b[i];
            largest[i] = largest[i].max(i64::abs(sum[i]));
        }
    }
    largest
}

/// Runs through a move, tunes in the middle of it, and goes on.
fn tuned(start: &PlantConfig, new: &PlantConfig) -> (Vec<PlantStep>, Vec<PlantStep>) {
    let mut plant = Plant::new(start).unwrap();
    let command = command(45.0, 40.0);
    let before = run(&mut plant, &command, BEFORE);
    plant.tune(new).unwrap();
    assert_eq!(plant.config(), new);
    (before, run(&mut plant, &command, AFTER))
}

fn always(config: &PlantConfig) -> Vec<PlantStep> {
    run(&mut Plant::new(config).unwrap(), &command(45.0, 40.0), BEFORE + AFTER)
}

/// Coefficients of the size of Table 1, times a factor.
fn parameters(factor: f64) -> Parameters {
    let mut all = [0.0; PARAMETER_COUNT];
    for group in ParameterGroup::ALL {
        let size = match group {
            ParameterGroup::GyroBias => 50.0 * DEG_PER_HOUR,
            ParameterGroup::GyroScale | ParameterGroup::AccelScale => 3000.0 * PPM,
            ParameterGroup::GyroMisalignment | ParameterGroup::AccelMisalignment => 400.0 * ARCSEC,
            ParameterGroup::GDependent => 5.0 * DEG_PER_HOUR_PER_G,
            ParameterGroup::AccelBias => 1000.0 * MICRO_G,
        };
        for (k, index) in group.range().enumerate() {
            all[index] = factor * size * (1.0 - 0.3 * k as f64);
        }
    }
    Parameters::from_array(&all)
}

#[test]
fn from_the_change_on_it_is_a_plant_that_always_was_so() {
    let mut cases: Vec<(&str, PlantConfig)> = Vec::new();
    for (index, name) in octant_sample::parameters::NAMES.into_iter().enumerate() {
        let mut config = noisy();
        let mut all = config.imu.parameters.to_array();
        all[index] = parameters(1.0).to_array()[index];
        config.imu.parameters = Parameters::from_array(&all);
        cases.push((name, config));
    }
    let mut config = noisy();
    config.imu.angle_random_walk *= 30.0;
    cases.push(("angle random walk", config));
    let mut config = noisy();
    config.imu.velocity_random_walk = 0.0;
    cases.push(("velocity random walk", config));
    let mut config = noisy();
    config.imu.parameters = parameters(-1.0);
    config.imu.angle_random_walk = 0.0;
    config.imu.velocity_random_walk *= 5.0;
    cases.push(("all at once", config));
    let untouched = always(&noisy());
    for (name, new) in &cases {
        let (before, after) = tuned(&noisy(), new);
        assert_eq!(before, untouched[..BEFORE as usize], "{name}");
        let expected = always(new);
        let apart_by = apart(&after, &expected[BEFORE as usize..]);
        assert!(apart_by.iter().all(|counts| *counts <= 1), "{name}: {apart_by:?}");
        // It is another plant than the one that was left alone.
        let moved = apart(&after, &untouched[BEFORE as usize..]);
        assert!(moved.iter().any(|counts| *counts > 100), "{name}: {moved:?}");
        let aiding = |steps: &[PlantStep]| -> Vec<_> { steps.iter().map(|s| s.aiding).collect() };
        assert_eq!(aiding(&after), aiding(&untouched[BEFORE as usize..]), "{name}");
    }
}

/// N samples of a bias give N B dt, to a count; at rest, where the increments aren't computed again, too.
#[test]
fn a_bias_adds_what_it_is() {
    let mut new = noisy();
    let (bias_radps, bias_mps2) = (0.7 * DEG_PER_HOUR, -130.0 * MICRO_G);
    new.imu.parameters.gyro_bias = [0.0, bias_radps, 0.0];
    new.imu.parameters.accel_bias = [bias_mps2, 0.0, 0.0];
    let at_rest = command(0.0, 0.0);
    let (mut plant, mut twin) = (Plant::new(&noisy()).unwrap(), Plant::new(&noisy()).unwrap());
    run(&mut plant, &at_rest, 300);
    run(&mut twin, &at_rest, 300);
    plant.tune(&new).unwrap();
    let samples = 10_000;
    let (with, without) = (run(&mut plant, &at_rest, samples), run(&mut twin, &at_rest, samples));
    let mut sum = [0; 6];
    for (a, b) in with.iter().zip(&without) {
        let (a, b) = (counts(a), counts(b));
        (0..6).for_each(|i| sum[i] += a[i] - b[i]);
    }
    let time_s = samples as f64 * DT;
    let expected = [
        0.0,
        bias_radps * time_s / DELTA_THETA_LSB_RAD,
        0.0,
        bias_mps2 * time_s / DELTA_VELOCITY_LSB_MPS,
        0.0,
        0.0,
    ];
    for i in 0..6 {
        assert!((sum[i] as f64 - expected[i]).abs() <= 1.0, "{i}: {} {}", sum[i], expected[i]);
    }
}

#[test]
fn ranges_and_the_noise_of_the_reference_change_too() {
    let mut new = noisy();
    // Below the move's 10 deg/s, and below what the z axis feels of gravity.
    new.imu.extensions.gyro_range_radps = 5.0 * DEG;
    new.imu.extensions.accel_range_mps2 = 5.0;
    new.aiding.kind = AidingKind::ZeroVelocity { sigma_mps: 0.03 };
    let (before, after) = tuned(&noisy(), &new);
    assert!(before.iter().all(|step| step.sample.status.is_empty()));
    let expected = always(&new);
    let both = Status::GYRO_SATURATED | Status::ACCELEROMETER_SATURATED;
    assert_eq!(after[0].sample.status, both);
    for (step, expected) in after.iter().zip(&expected[BEFORE as usize..]) {
        assert_eq!(step.sample.status, expected.sample.status);
        assert_eq!(step.aiding, expected.aiding, "to the bit: nothing is carried over");
    }
    assert!(after.iter().any(|step| step.aiding.is_some()));
}

#[test]
fn the_same_configuration_changes_no_bit_and_a_state_goes_on() {
    let mut new = noisy();
    new.imu.parameters = parameters(1.0);
    new.imu.angle_random_walk *= 2.0;
    let mut plant = Plant::new(&noisy()).unwrap();
    let command = command(45.0, 40.0);
    run(&mut plant, &command, BEFORE);
    plant.tune(&new).unwrap();
    let bytes = |plant: &Plant| {
        let mut bytes = Vec::new();
        plant.save(&mut bytes);
        bytes
    };
    let saved = bytes(&plant);
    plant.tune(&new).unwrap();
    assert_eq!(bytes(&plant), saved);
    let mut loaded = Plant::load(&saved).unwrap();
    assert_eq!(run(&mut plant, &command, AFTER), run(&mut loaded, &command, AFTER));
    assert_eq!(bytes(&plant), bytes(&loaded));
}

#[test]
fn what_can_t_change_is_refused_and_changes_nothing() {
    let mut plant = Plant::new(&noisy()).unwrap();
    run(&mut plant, &command(45.0, 40.0), BEFORE);
    let mut before = Vec::new();
    plant.save(&mut before);
    type Change = fn(&mut PlantConfig);
    let fixed: [(&str, Change); 10] = [
        ("sample_period_ns", |c| c.sample_period_ns = 10_000_000),
        ("seed", |c| c.seed = 2),
        ("calibration_samples", |c| c.calibration_samples = 5),
        ("site", |c| c.site.height_m = 1.0),
        ("motion", |c| c.motion = Motion::Dockside(Dockside::calm(CaseAttitude::default()))),
        ("turntable", |c| c.turntable.backlash_rad = 1e-5),
        ("aiding", |c| c.aiding.kind = AidingKind::DockPosition { sigma_m: 0.1 }),
        ("aiding", |c| c.aiding.period_ns = 2_000_000_000),
        ("imu.extensions", |c| c.imu.extensions.gyro_quantization_rad = 1e-6),
        ("imu.extensions", |c| c.imu.extensions.lever_arm_m[0][0] = 0.1),
    ];
    for (field, change) in fixed {
        let mut config = noisy();
        // What could change goes down with it.
        config.imu.angle_random_walk = 0.0;
        change(&mut config);
        let error = plant.tune(&config).unwrap_err();
        assert_eq!(error.field, field);
        assert!(error.to_string().ends_with("it can't change in a plant that runs"), "{error}");
    }
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        let mut config = noisy();
        config.imu.velocity_random_walk = bad;
        assert_eq!(plant.tune(&config).unwrap_err().field, "imu.velocity_random_walk");
    }
    let mut config = noisy();
    config.imu.parameters.accel_bias[1] = f64::NAN;
    assert_eq!(plant.tune(&config).unwrap_err().field, "imu.parameters.accel_bias_y");
    let mut after = Vec::new();
    plant.save(&mut after);
    assert_eq!(after, before);
}
