//! Configurations with which the tests start.

pub(crate) mod bench;
pub(crate) mod strapdown;

use octant_earth::units::{DEG, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_plant::config::*;
use octant_plant::{Plant, PlantStep};
use octant_sample::{GimbalAngles, GimbalCommand, Parameters};

pub(crate) const PERIOD_NS: u64 = 5_000_000;
pub(crate) const DT: f64 = 0.005;
/// Earth rate, rad/s.
pub(crate) const EARTH_RATE: f64 = 7.292115e-5;
/// Latitude of the site of [`perfect`], rad.
pub(crate) const LATITUDE: f64 = 30.5 * DEG;

/// Static at 30.5° N, 200 Hz, 10 °/s and 10 °/s², perfect sensors.
pub(crate) fn perfect() -> PlantConfig {
    PlantConfig {
        sample_period_ns: PERIOD_NS,
        seed: 1,
        calibration_samples: u64::MAX,
        site: PlantSite {
            latitude_rad: LATITUDE,
            longitude_rad: 114.3 * DEG,
            height_m: 40.0,
            gravity: GravityDisturbance::default(),
        },
        motion: Motion::Static(CaseAttitude::default()),
        turntable: TurntableConfig {
            rate_radps: 10.0 * DEG,
            acceleration_radps2: 10.0 * DEG,
            encoder_sigma_rad: 0.0,
            non_orthogonality_rad: 0.0,
            backlash_rad: 0.0,
            errors: Default::default(),
        },
        imu: Imu {
            parameters: Parameters::default(),
            angle_random_walk: 0.0,
            velocity_random_walk: 0.0,
            extensions: Extensions::default(),
        },
        aiding: AidingSource {
            kind: AidingKind::ZeroVelocity { sigma_mps: 0.001 },
            period_ns: 1_000_000_000,
        },
    }
}

/// The same with the noise of table 1.
pub(crate) fn noisy() -> PlantConfig {
    let mut config = perfect();
    config.imu.angle_random_walk = 0.0007 * DEG_PER_SQRT_HOUR;
    config.imu.velocity_random_walk = 50.0 * MICRO_G;
    config
}

pub(crate) fn command(azimuth_deg: f64, roll_deg: f64) -> GimbalCommand {
    GimbalCommand { target: GimbalAngles::from_rad(azimuth_deg * DEG, roll_deg * DEG) }
}

pub(crate) fn run(plant: &mut Plant, command: &GimbalCommand, samples: u64) -> Vec<PlantStep> {
    (0..samples).map(|_| plant.step(command)).collect()
}
