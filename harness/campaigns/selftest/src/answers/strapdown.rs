//! Attitude, velocity and position after increments beyond any vehicle's, and the attitude of a
//! coarse alignment.

use super::numbers::Found;
use nalgebra::{UnitQuaternion, Vector3};
use octant_calibration::Core;
use octant_calibration::config::{Alignment, CoreConfig};
use octant_sample::{DeviceTime, Sample};
use octant_scenario::{Method, Scenario};
use octant_source::configure::configurations;
use std::hint::black_box;
use std::path::Path;

const SCENARIO: &str = "schema = 1
[site]
height = \"250 m\"
[imu]
rate = \"100 Hz\"
[procedure.alignment]
method = \"given\"
[procedure.navigation]
duration = \"1 h\"
rotation = \"none\"
[screening]
jumps = \"off\"
bridging = \"off\"
";
/// Navigation of that scenario.
const NAVIGATION: &str = "[procedure.navigation]\nduration = \"1 h\"\nrotation = \"none\"\n";
const MARKS: [u64; 2] = [2, 60];

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    steps(&mut all)?;
    alignment(&mut all)?;
    fall(&mut all)?;
    Ok(all)
}

/// Computes the velocity of an instrument in free fall at great height, in a calibration, where the
/// vertical velocity is free.
fn fall(all: &mut Found) -> Result<(), String> {
    let calibration = "[procedure.calibration]\nduration = \"1 h\"\n";
    let mut config = config(&SCENARIO.replace(NAVIGATION, calibration))?;
    config.site.height_m = black_box(100_000.0);
    config.alignment =
        Alignment::Given { q_nb: UnitQuaternion::identity(), velocity_mps: Vector3::zeros() };
    let mut core = Core::new(&config).map_err(|why| why.to_string())?;
    let mut velocity_mps = [f64::NAN; 3];
    for n in 1..=10u64 {
        let device_time = DeviceTime::from_ns(n * config.sample_period_ns);
        let sample = Sample { sequence: n, device_time, ..Sample::default() };
        velocity_mps = core.step(&sample, None).navigation.velocity_mps;
    }
    all.insert("velocity of a fall, down".to_owned(), velocity_mps[2]);
    all.insert("velocity of a fall, east".to_owned(), velocity_mps[1]);
    Ok(())
}

/// Configures a core without parameters.
fn config(scenario: &str) -> Result<CoreConfig, String> {
    let scenario = Scenario::parse(scenario, "answers.toml", Path::new("."), &[])
        .map_err(|why| why.to_string())?;
    let (_, mut config, _) =
        configurations(&scenario, Method::Primary, 1).map_err(|why| why.to_string())?;
    (config.site.latitude_rad, config.site.longitude_rad) = (0.6, -1.3);
    config.initial_parameters = Default::default();
    Ok(config)
}

/// Computes the attitude that results from a hundred equal samples.
fn alignment(all: &mut Found) -> Result<(), String> {
    let mut config = config(SCENARIO)?;
    config.alignment = Alignment::Coarse { duration_s: 1.0 };
    let mut core = Core::new(&config).map_err(|why| why.to_string())?;
    let mut q_nb = [f64::NAN; 4];
    for n in 1..=100u64 {
        let sample = Sample {
            sequence: n,
            device_time: DeviceTime::from_ns(n * config.sample_period_ns),
            delta_theta: black_box([31_000, -17_500, 29_000]),
            delta_velocity: black_box([33_000_000, -61_000_000, -79_000_000]),
            ..Sample::default()
        };
        q_nb = core.step(&sample, None).navigation.q_nb;
    }
    for (name, value) in ["w", "x", "y", "z"].into_iter().zip(q_nb) {
        all.insert(format!("aligned {name}"), value);
    }
    Ok(())
}

fn steps(all: &mut Found) -> Result<(), String> {
    let mut config = config(SCENARIO)?;
    let q_nb = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, -0.8, 0.5));
    config.alignment = Alignment::Given { q_nb, velocity_mps: Vector3::new(0.5, -0.3, 0.0) };
    let mut core = Core::new(&config).map_err(|why| why.to_string())?;
    for n in 1..=60u64 {
        let sample = Sample {
            sequence: n,
            device_time: DeviceTime::from_ns(n * config.sample_period_ns),
            delta_theta: std::array::from_fn(|axis| {
                (1.2e9 * libm::sin(1.1 * n as f64 + axis as f64)).round_ties_even() as i32
            }),
            delta_velocity: std::array::from_fn(|axis| {
                (5e8 * libm::cos(0.7 * n as f64 + 2.0 * axis as f64)).round_ties_even() as i32
            }),
            ..Sample::default()
        };
        let navigation = core.step(&sample, None).navigation;
        if MARKS.contains(&n) {
            for (name, value) in ["w", "x", "y", "z"].into_iter().zip(navigation.q_nb) {
                all.insert(format!("attitude {name}, {n}"), value);
            }
            for (name, value) in ["north", "east"].into_iter().zip(navigation.velocity_mps) {
                all.insert(format!("velocity {name}, {n}"), value);
            }
            all.insert(format!("latitude, {n}"), navigation.latitude_rad);
            all.insert(format!("longitude, {n}"), navigation.longitude_rad);
        }
    }
    Ok(())
}
