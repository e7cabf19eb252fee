//! The core alone, one step per element: a second of 200 Hz samples with noise, repeated.
//!
//! - `navigation`: free inertial, rotating by the sixteen moves.
//! - `calibration`: eight positions, 39 states, one measurement a second.
//! - `calibration, further`: the same with all further states estimated but those that follow the temperature, 66 in all.
//! - `calibration, further and temperature`: with those too, 78 in all.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use octant_calibration::Core;
use octant_calibration::config::*;
use octant_calibration::positions::{EIGHT, SIXTEEN, from_degrees};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::*;
use octant_earth::{UnitQuaternion, Vector3};
use octant_sample::{Aiding, DeviceTime, Parameters, Reference, Sample, Status};

const PERIOD_NS: u64 = 5_000_000;
const SECOND: usize = 200;
const LATITUDE_RAD: f64 = 30.5 * DEG;

/// All groups of further states, estimated.
fn all_further() -> Further {
    Further {
        groups: [FurtherUse::Estimated { sigma: 1e-5 }; 8],
        gyro_correlation_time_s: 300.0,
        accel_correlation_time_s: 300.0,
        gyro_rate_random_walk: 1e-12,
        temperature: None,
        angles: None,
        rest: None,
    }
}

/// The same with those that follow the temperature.
fn and_temperature() -> Further {
    let groups = [FurtherUse::Estimated { sigma: 1e-6 }; 4];
    let temperature = TemperatureErrors { groups, reference_c: Some(20.0) };
    Further { temperature: Some(temperature), ..all_further() }
}

fn config(calibration: bool, further: Further) -> CoreConfig {
    CoreConfig {
        sample_period_ns: PERIOD_NS,
        site: Site { latitude_rad: LATITUDE_RAD, longitude_rad: 0.0, height_m: 0.0 },
        alignment: Alignment::Given {
            q_nb: UnitQuaternion::identity(),
            velocity_mps: Vector3::zeros(),
        },
        calibration: calibration.then(|| Calibration {
            sequence: from_degrees(EIGHT, 1).unwrap(),
            duration_s: 4.0 * 3600.0,
            estimator: Estimator::Kalman(Kalman {
                error_model: ErrorModel::Phi,
                estimated: [true; 7],
                prior: Prior {
                    attitude_rad: [60.0 * ARCSEC, 60.0 * ARCSEC, 0.1 * DEG],
                    velocity_mps: 0.02,
                    position_m: 1.0,
                    parameters: [
                        0.005 * DEG_PER_HOUR,
                        30.0 * PPM,
                        40.0 * ARCSEC,
                        5e-4 * DEG_PER_HOUR_PER_G,
                        100.0 * MICRO_G,
                        30.0 * PPM,
                        40.0 * ARCSEC,
                    ],
                },
                aiding: AidingMode::Velocity { sigma_mps: 1e-3 },
                aiding_period_ns: 1_000_000_000,
                sway: SwayNoise::White,
                refuse_above_mean_nis: 9.0,
                sigma_limits: Default::default(),
                further,
            }),
        }),
        navigation: Some(NavigationPlan {
            duration_s: None,
            rotation: from_degrees(SIXTEEN, 1).unwrap(),
            dwell_s: 300.0,
        }),
        turntable: TurntableRates { rate_radps: 10.0 * DEG, acceleration_radps2: 10.0 * DEG },
        noise: Noise {
            angle_random_walk: 0.0007 * DEG_PER_SQRT_HOUR,
            velocity_random_walk: 50.0 * MICRO_G,
        },
        initial_parameters: Parameters::default(),
        screening: Screening::hardened(Base::Still),
    }
}

/// Makes a second of a level static base with scattered noise, as (sample, aiding).
fn second() -> Vec<(Sample, Option<Aiding>)> {
    let earth = Ellipsoid::at(LATITUDE_RAD, 0.0);
    let (rate, g) = (earth.earth_rate(), earth.gravity_mps2);
    let mut state = 1u64;
    let mut noise = |amplitude: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        ((state >> 33) as f64 / (1u64 << 30) as f64 - 1.0) * amplitude
    };
    (1..=SECOND)
        .map(|k| {
            let device_time = DeviceTime::from_ns(k as u64 * PERIOD_NS);
            let delta_theta = [rate.x, rate.y, rate.z]
                .map(|w| (w * 0.005 * 2f64.powi(36) + noise(1000.0)) as i32);
            let delta_velocity =
                [0.0, 0.0, -g].map(|f| (f * 0.005 * 2f64.powi(30) + noise(40_000.0)) as i32);
            let aiding = (k == SECOND)
                .then_some(Aiding { device_time, reference: Reference::Velocity([0.0; 3]) });
            let sample = Sample {
                sequence: k as u64,
                device_time,
                delta_theta,
                delta_velocity,
                status: Status::GIMBAL_INVALID,
                ..Sample::default()
            };
            (sample, aiding)
        })
        .collect()
}

fn bench(criterion: &mut Criterion) {
    let second = second();
    let mut group = criterion.benchmark_group("core");
    group.throughput(Throughput::Elements(60 * SECOND as u64));
    for (name, calibration, further) in [
        ("navigation", false, Further::default()),
        ("calibration", true, Further::default()),
        ("calibration, further", true, all_further()),
        ("calibration, further and temperature", true, and_temperature()),
    ] {
        let core = Core::new(&config(calibration, further)).unwrap();
        group.bench_function(name, |bencher| {
            bencher.iter_batched_ref(
                || core.clone(),
                |core| {
                    for minute in 0..60u64 {
                        for (sample, aiding) in &second {
                            let mut sample = *sample;
                            sample.sequence += minute * SECOND as u64;
                            sample.device_time.ns += minute * 1_000_000_000;
                            core.feel(20.0 + 0.1 * minute as f64);
                            std::hint::black_box(core.step(&sample, aiding.as_ref()));
                        }
                    }
                },
                BatchSize::SmallInput,
            );
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
