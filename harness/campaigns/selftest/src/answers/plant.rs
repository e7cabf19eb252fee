//! Counts of the plant's sensors, its position and its references: seven instruments, at rest and
//! on a ship, in the north and in the south.

use super::numbers::Found;
use octant_earth::units::{ARCSEC, DEG, DEG_PER_HOUR, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_plant::config::{
    AidingKind, AidingSource, CaseAttitude, Dockside, Extensions, GaussMarkov, Imu, Motion,
    PlantConfig, PlantSite, Temperature, TurntableConfig, Vibration,
};
use octant_plant::draw::{ParameterDraws, parameters};
use octant_plant::{Plant, interpolation, motion};
use octant_sample::{GimbalAngles, GimbalCommand, Parameters, Reference};

const PERIOD_NS: u64 = 5_000_000;
const CALIBRATION: u64 = 1600;
const MARKS: [u64; 5] = [400, 1100, 1600, 2100, 2600];
const LEANING: CaseAttitude = CaseAttitude { heading_rad: 1.1, pitch_rad: 0.03, roll_rad: -0.02 };

pub(super) fn site(latitude_deg: f64, longitude_deg: f64, height_m: f64) -> PlantSite {
    PlantSite {
        latitude_rad: latitude_deg * DEG,
        longitude_rad: longitude_deg * DEG,
        height_m,
        gravity: Default::default(),
    }
}

/// Interpolates the tenth power, of which ten nodes leave a known error.
fn interpolated(all: &mut Found) {
    let nodes = interpolation::nodes();
    for x in [-0.97, -0.5, 0.1, 0.3, 0.86] {
        let weights = interpolation::weights(&nodes, std::hint::black_box(x));
        let sum = nodes.iter().zip(&weights).map(|(node, weight)| weight * node.powi(10)).sum();
        all.insert(format!("tenth power of {x}, interpolated"), sum);
    }
}

/// Configures perfect sensors on a turntable of 10 °/s and 10 °/s².
pub(super) fn perfect(seed: u64, site: PlantSite, motion: Motion) -> PlantConfig {
    PlantConfig {
        sample_period_ns: PERIOD_NS,
        seed,
        calibration_samples: CALIBRATION,
        site,
        motion,
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

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    interpolated(&mut all);
    for (name, config, moves, has_reference) in instruments() {
        tell(&mut all, name, &config, moves, has_reference)?;
    }
    Ok(all)
}

fn instruments() -> Vec<(&'static str, PlantConfig, bool, bool)> {
    let (north, south) = (site(30.5, 114.3, 40.0), site(-60.0, -20.0, 4000.0));
    let still = |seed, site| perfect(seed, site, Motion::Static(LEANING));

    let mut wandering = still(7, north);
    wandering.turntable.non_orthogonality_rad = 1e-3;
    wandering.turntable.backlash_rad = 2e-4;
    wandering.turntable.encoder_sigma_rad = 5.0 * ARCSEC;
    wandering.imu.parameters = parameters(7, &ParameterDraws::table_1());
    wandering.imu.angle_random_walk = 0.0007 * DEG_PER_SQRT_HOUR;
    wandering.imu.velocity_random_walk = 50.0 * MICRO_G;
    let process = |sigma, correlation_time_s| Some(GaussMarkov { sigma, correlation_time_s });
    wandering.imu.extensions.gyro_gauss_markov = process(0.01 * DEG_PER_HOUR, 100.0);
    wandering.imu.extensions.accel_gauss_markov = process(20.0 * MICRO_G, 60.0);
    wandering.imu.extensions.gyro_rate_random_walk = 0.05 * DEG_PER_HOUR / 60.0;

    let mut size = still(1, south);
    size.imu.extensions.lever_arm_m =
        [[0.03, -0.02, 0.05], [-0.04, 0.06, 0.01], [0.02, 0.07, -0.03]];

    let mut warm = still(1, south);
    warm.imu.extensions.temperature = Some(Temperature {
        ramp_kps: 0.5,
        plateau_k: 4.0,
        gyro_bias_per_k: [1e-8, 2e-8, -1e-8],
        accel_bias_per_k: [1e-4, 0.0, -2e-4],
        gyro_scale_per_k: [0.0, 1e-5, 2e-5],
        accel_scale_per_k: [1e-6, 0.0, 1e-5],
    });

    let mut shaken = still(1, south);
    shaken.imu.extensions.vibration = Some(Vibration {
        frequency_hz: 37.0,
        displacement_m: [2e-5, 0.0, -1e-5],
        angle_rad: [1e-4, 0.0, 2e-4],
        phase_rad: 0.7,
    });

    let mut lagging = still(1, north);
    lagging.imu.extensions.time_skew_s = 0.0137;
    lagging.imu.extensions.gyro_quantization_rad = 1024.0 / (1u64 << 36) as f64;
    lagging.imu.extensions.accel_quantization_mps = 1024.0 / (1u64 << 30) as f64;

    let mean = CaseAttitude { heading_rad: 0.7, pitch_rad: 0.02, roll_rad: -0.01 };
    let sway =
        Dockside { mean, mooring_offset_m: [120.0, -80.0, 1.5], ..motion::dockside_default(7) };
    let mut swaying = perfect(7, north, Motion::Dockside(sway));
    swaying.turntable.non_orthogonality_rad = 1e-3;
    swaying.turntable.backlash_rad = 2e-4;
    swaying.aiding.kind = AidingKind::Velocity { sigma_mps: 0.01 };
    let mut severe = perfect(3, south, Motion::Dockside(motion::dockside_iso_8728(3)));
    severe.aiding.kind = AidingKind::DockPosition { sigma_m: 0.15 };

    vec![
        ("static north", wandering, true, true),
        ("size effect south", size, true, false),
        ("temperature south", warm, false, false),
        ("vibration south", shaken, true, false),
        ("lag north", lagging, true, false),
        ("ship north", swaying, true, true),
        ("ship south", severe, true, true),
    ]
}

/// Returns the set points: (40°, 25°) with the first sample, (20°, −10°) with sample 1501.
fn target(sample: u64) -> GimbalCommand {
    let (azimuth, roll) = if sample < 1501 { (40.0, 25.0) } else { (20.0, -10.0) };
    GimbalCommand { target: GimbalAngles::from_rad(azimuth * DEG, roll * DEG) }
}

fn tell(
    all: &mut Found,
    name: &str,
    config: &PlantConfig,
    moves: bool,
    has_reference: bool,
) -> Result<(), String> {
    let mut plant = Plant::new(config).map_err(|error| format!("make {name}: {error}"))?;
    let (mut gyro, mut accelerometer) = ([0i64; 3], [0i64; 3]);
    for n in 1..=MARKS[MARKS.len() - 1] {
        let command = if moves { target(n) } else { GimbalCommand::default() };
        let step = plant.step(&command);
        for axis in 0..3 {
            gyro[axis] += i64::from(step.sample.delta_theta[axis]);
            accelerometer[axis] += i64::from(step.sample.delta_velocity[axis]);
        }
        let mut put = |what: &str, value: f64| all.insert(format!("{name}, {what}, {n}"), value);
        if let (true, 200 | 1600, Some(aiding)) = (has_reference, n, &step.aiding) {
            let values = match aiding.reference {
                Reference::Velocity(values) => values,
                Reference::Position { latitude_rad, longitude_rad, height_m } => {
                    [latitude_rad, longitude_rad, height_m]
                }
            };
            for (axis, value) in ["x", "y", "z"].into_iter().zip(values) {
                put(&format!("reference {axis}"), value);
            }
        }
        if !MARKS.contains(&n) {
            continue;
        }
        for (axis, label) in ["x", "y", "z"].into_iter().enumerate() {
            put(&format!("gyro {label}"), gyro[axis] as f64);
            put(&format!("accelerometer {label}"), accelerometer[axis] as f64);
        }
        if config.turntable.encoder_sigma_rad > 0.0 {
            put("azimuth read", f64::from(step.sample.gimbal.azimuth));
            put("roll read", f64::from(step.sample.gimbal.roll));
        }
        // Truth excludes the vibration of the sensor block.
        if (n == MARKS[1] || n == MARKS[4]) && config.imu.extensions.vibration.is_none() {
            let truth = plant.truth();
            let sign = if truth.q_nb[0] < 0.0 { -1.0 } else { 1.0 };
            let [north, east, down] = truth.velocity_mps;
            let [w, i, j, k] = truth.q_nb.map(|part| sign * part);
            for (what, value) in [
                ("latitude", truth.latitude_rad),
                ("longitude", truth.longitude_rad),
                ("height", truth.height_m),
                ("north", north),
                ("east", east),
                ("down", down),
                ("w", w),
                ("i", i),
                ("j", j),
                ("k", k),
                ("azimuth", truth.gimbal_rad[0]),
                ("roll", truth.gimbal_rad[1]),
            ] {
                put(what, value);
            }
        }
    }
    Ok(())
}
