//! Attitude, velocity and position after increments that no vehicle makes.

use super::Found;
use crate::run::method::configurations;
use crate::scenario::{Method, Scenario};
use nalgebra::{UnitQuaternion, Vector3};
use octant_calibration::Core;
use octant_calibration::config::Alignment;
use octant_sample::{DeviceTime, Sample};
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
const MARKS: [u64; 2] = [2, 60];

pub(super) fn found() -> Result<Found, String> {
    let scenario = Scenario::parse(SCENARIO, "answers.toml", Path::new("."), &[])
        .map_err(|why| why.to_string())?;
    let (_, mut config, _) =
        configurations(&scenario, Method::Primary, 1).map_err(|why| why.to_string())?;
    (config.site.latitude_rad, config.site.longitude_rad) = (0.6, -1.3);
    let q_nb = UnitQuaternion::from_scaled_axis(Vector3::new(0.3, -0.8, 0.5));
    config.alignment = Alignment::Given { q_nb, velocity_mps: Vector3::new(0.5, -0.3, 0.0) };
    config.initial_parameters = Default::default();
    let mut core = Core::new(&config).map_err(|why| why.to_string())?;
    let mut all = Found::new();
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
    Ok(all)
}
