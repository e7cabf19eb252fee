//! Samples per second of the plant, 200 Hz, one core.
//!
//! - dwell: static, table 1 noise, error model on, no move
//! - move: the same, with a gimbal that always turns at 10 °/s
//! - dockside: the default sway, gimbals at rest
//! - sea: 30 sinusoids in each of the six degrees of freedom
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use octant_earth::units::{DEG, DEG_PER_SQRT_HOUR, MICRO_G};
use octant_plant::config::*;
use octant_plant::{Plant, draw, motion, sea};
use octant_sample::{GimbalAngles, GimbalCommand};
use std::hint::black_box;

const SAMPLES: u64 = 20_000;

fn config(motion: Motion) -> PlantConfig {
    PlantConfig {
        sample_period_ns: 5_000_000,
        seed: 1,
        calibration_samples: u64::MAX,
        site: PlantSite {
            latitude_rad: 30.5 * DEG,
            longitude_rad: 2.0,
            height_m: 40.0,
            gravity: GravityDisturbance::default(),
        },
        motion,
        turntable: TurntableConfig {
            rate_radps: 10.0 * DEG,
            acceleration_radps2: 10.0 * DEG,
            encoder_sigma_rad: 18.0 * DEG / 3600.0,
            non_orthogonality_rad: 1e-4,
            backlash_rad: 0.0,
            errors: Default::default(),
        },
        imu: Imu {
            parameters: draw::parameters(1, &draw::ParameterDraws::table_1()),
            angle_random_walk: 0.0007 * DEG_PER_SQRT_HOUR,
            velocity_random_walk: 50.0 * MICRO_G,
            extensions: Extensions::default(),
        },
        aiding: AidingSource {
            kind: AidingKind::ZeroVelocity { sigma_mps: 0.001 },
            period_ns: 1_000_000_000,
        },
    }
}

fn steps(plant: &mut Plant, command: &GimbalCommand) {
    for _ in 0..SAMPLES {
        black_box(plant.step(black_box(command)));
    }
}

fn bench(c: &mut Criterion) {
    let mut group = c.benchmark_group("plant");
    group.throughput(Throughput::Elements(SAMPLES));
    let level = GimbalCommand::default();
    let still = Motion::Static(CaseAttitude::default());

    let mut plant = Plant::new(&config(still.clone())).unwrap();
    group.bench_function("dwell", |b| b.iter(|| steps(&mut plant, &level)));

    // 20 000 samples at 10 °/s are 1000°, beyond ±16 rad: the gimbal turns to and fro.
    let mut plant = Plant::new(&config(still)).unwrap();
    let ends =
        [450.0, -450.0].map(|deg| GimbalCommand { target: GimbalAngles::from_rad(0.0, deg * DEG) });
    group.bench_function("move", |b| {
        b.iter(|| {
            for i in 0..SAMPLES {
                let command = ends[usize::from(i >= SAMPLES / 2)];
                black_box(plant.step(black_box(&command)));
            }
        });
    });

    let ship = Motion::Dockside(motion::dockside_default(1));
    let mut plant = Plant::new(&config(ship)).unwrap();
    group.bench_function("dockside", |b| b.iter(|| steps(&mut plant, &level)));

    let spectrum = sea::Spectrum::jonswap(0.1, 8.0, 3.3);
    let mut ship = motion::dockside_default(1);
    ship.roll = spectrum.components(1, "roll", 30);
    ship.pitch = spectrum.components(1, "pitch", 30);
    ship.yaw = spectrum.components(1, "yaw", 30);
    ship.surge = spectrum.components(1, "surge", 30);
    ship.sway = spectrum.components(1, "sway", 30);
    ship.heave = spectrum.components(1, "heave", 30);
    let mut plant = Plant::new(&config(Motion::Dockside(ship))).unwrap();
    group.bench_function("sea", |b| b.iter(|| steps(&mut plant, &level)));
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
