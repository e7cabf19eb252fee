//! Arbitrary input: the core doesn't panic, and gives finite numbers or refuses.

use octant_calibration::Core;
use octant_calibration::config::*;
use octant_calibration::positions::{EIGHT, SIX};
use octant_earth::UnitQuaternion;
use octant_earth::units::*;
use octant_sample::{
    Aiding, DeviceTime, GimbalAngles, Health, Mode, Output, Reference, Sample, Status,
};
use octant_test_loop::draws;
use octant_test_loop::instrument::{InstrumentCase, PERIOD_NS};
use proptest::prelude::*;

fn counts() -> impl Strategy<Value = [i32; 3]> {
    let count = prop_oneof![
        Just(0),
        Just(i32::MIN),
        Just(i32::MAX),
        -1_000_000..1_000_000i32,
        any::<i32>()
    ];
    proptest::array::uniform3(count)
}

/// Stamp or number: mostly the next one, else a step of any size, or anything.
#[derive(Clone, Copy, Debug)]
enum Stamp {
    Next,
    Ahead(u64),
    Anything(u64),
}

fn stamp() -> impl Strategy<Value = Stamp> {
    prop_oneof![
        6 => Just(Stamp::Next),
        1 => (0..10_000u64).prop_map(Stamp::Ahead),
        1 => (0..20_000_000u64).prop_map(Stamp::Ahead),
        1 => any::<u64>().prop_map(Stamp::Anything),
        1 => Just(Stamp::Anything(u64::MAX)),
    ]
}

fn reference() -> impl Strategy<Value = Option<Reference>> {
    let number = || {
        prop_oneof![
            Just(0.0),
            -10.0..10.0f64,
            any::<f64>(),
            any::<u64>().prop_map(f64::from_bits),
            Just(f64::NAN),
            Just(f64::INFINITY),
            Just(1e150),
            Just(f64::MAX),
        ]
    };
    prop_oneof![
        2 => Just(None),
        2 => proptest::array::uniform3(number()).prop_map(|v| Some(Reference::Velocity(v))),
        1 => proptest::array::uniform3(number()).prop_map(|v| Some(Reference::Position {
            latitude_rad: v[0],
            longitude_rad: v[1],
            height_m: v[2],
        })),
    ]
}

type Input = (Stamp, Stamp, [i32; 3], [i32; 3], [i32; 3], u16, Option<Reference>);

fn inputs() -> impl Strategy<Value = Vec<Input>> {
    let input = (stamp(), stamp(), counts(), counts(), counts(), any::<u16>(), reference());
    proptest::collection::vec(input, 1..400)
}

#[derive(Clone, Copy, Debug)]
enum Method {
    Kalman,
    Position,
    ColouredSway,
    Psi,
    LeastSquares,
    Turntable,
}

fn config(method: Method, gate: u8, coarse: bool) -> CoreConfig {
    let mut case = InstrumentCase::table_1(1, if coarse { SIX } else { EIGHT });
    case.calibration_h = 0.25;
    case.navigation_h = 0.5;
    let mut config = case.core();
    let calibration = config.calibration.as_mut().unwrap();
    let Estimator::Kalman(kalman) = &mut calibration.estimator else { unreachable!() };
    // At a high rate, so that there are more measurements.
    kalman.aiding_period_ns = 4 * PERIOD_NS;
    match method {
        Method::Kalman => {}
        Method::Position => kalman.aiding = AidingMode::Position { sigma_m: 0.15 },
        Method::ColouredSway => {
            kalman.aiding = AidingMode::Position { sigma_m: 0.01 };
            kalman.sway = SwayNoise::Coloured;
        }
        Method::Psi => kalman.error_model = ErrorModel::Psi,
        Method::LeastSquares => {
            calibration.estimator = Estimator::LeastSquares(LeastSquares {
                gravity_mps2: None,
                gyro: GyroReference::EarthRate,
                intervals: StaticIntervals::Commanded,
            });
        }
        Method::Turntable => {
            calibration.estimator = Estimator::ExternalTurntable(ExternalTurntable {
                q_nc: UnitQuaternion::identity(),
                encoder_sigma_rad: ARCSEC,
            });
        }
    }
    if coarse {
        config.alignment = Alignment::Coarse { duration_s: 0.5 };
    }
    config.screening.gate = match gate {
        0 => None,
        1 => Some(Gate { nis: 25.0, rejections: 2, recovery: Recovery::Widening }),
        _ => Some(Gate {
            nis: 25.0,
            rejections: 2,
            recovery: Recovery::Reset {
                attitude_rad: 600.0 * ARCSEC,
                velocity_mps: 1.0,
                position_m: 10.0,
            },
        }),
    };
    config
}

fn is_finite(output: &Output, core: &Core) -> bool {
    let n = &output.navigation;
    [n.latitude_rad, n.longitude_rad, n.height_m]
        .iter()
        .chain(&n.velocity_mps)
        .chain(&n.q_nb)
        .chain(&core.parameters().to_array())
        .chain(core.sigma())
        .all(|value| value.is_finite())
}

fn run(mut core: Core, inputs: &[Input]) -> Result<(), TestCaseError> {
    let mut at = (0u64, 0u64);
    for (number, time, theta, velocity, gimbal, status, reference) in inputs {
        let step = |now: u64, stamp: &Stamp, unit: u64| match stamp {
            Stamp::Next => now.wrapping_add(unit),
            Stamp::Ahead(n) => now.wrapping_add(n.wrapping_mul(unit)),
            Stamp::Anything(n) => *n,
        };
        let next = (step(at.0, number, 1), step(at.1, time, PERIOD_NS));
        let sample = Sample {
            sequence: next.0,
            device_time: DeviceTime::from_ns(next.1),
            delta_theta: *theta,
            delta_velocity: *velocity,
            gimbal: GimbalAngles { azimuth: gimbal[0], roll: gimbal[1] },
            status: Status::from_bits_truncate(*status),
        };
        let aiding =
            reference.map(|reference| Aiding { device_time: sample.device_time, reference });
        let output = core.step(&sample, aiding.as_ref());
        // This source doesn't follow a wild stamp either.
        if !output.health.contains(Health::OUT_OF_ORDER) {
            at = next;
        }
        prop_assert!(is_finite(&output, &core), "{output:?} {:?}", core.parameters());
        if core.refusal().is_some() {
            prop_assert_eq!(output.mode, Mode::Refused);
        }
        let _ = core.diagnostics();
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: draws(200, 50), failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn any_input_is_survived(
        inputs in inputs(),
        method in prop_oneof![
            Just(Method::Kalman),
            Just(Method::Position),
            Just(Method::ColouredSway),
            Just(Method::Psi),
            Just(Method::LeastSquares),
            Just(Method::Turntable)
        ],
        gate in 0..3u8,
        coarse in any::<bool>(),
        calibrates in prop::bool::weighted(0.8),
    ) {
        let mut config = config(method, gate, coarse);
        if !calibrates {
            config.calibration = None;
        }
        run(Core::new(&config).unwrap(), &inputs)?;
    }
}

#[test]
fn one_wild_stamp_does_not_end_the_stream() {
    let mut core = Core::new(&config(Method::Kalman, 1, false)).unwrap();
    let sample = |k: u64| Sample {
        sequence: k,
        device_time: DeviceTime::from_ns(k * PERIOD_NS),
        ..Sample::default()
    };
    for k in 1..100 {
        core.step(&sample(k), None);
    }
    let mut wild = sample(100);
    wild.device_time.ns = u64::MAX;
    assert!(core.step(&wild, None).health.contains(Health::OUT_OF_ORDER));
    wild = sample(100);
    wild.sequence = u64::MAX;
    assert!(core.step(&wild, None).health.contains(Health::OUT_OF_ORDER));
    assert!(!core.step(&sample(101), None).health.contains(Health::OUT_OF_ORDER));
}
