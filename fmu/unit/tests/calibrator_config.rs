//! The core's configuration as parameters, and back; and what is made of parameters that are wrong.

use octant_calibration::config::*;
use octant_calibration::positions::{EIGHT, SIXTEEN, from_degrees, named};
use octant_calibration::sequence::{STOPS_MAX, Sequence, Stop};
use octant_calibration::{Core, CoreConfig};
use octant_earth::units::*;
use octant_earth::{Vector3, rotation};
use octant_fmu::calibrator::table::MODEL;
use octant_fmu::calibrator::{Calibrator, config, put};
use octant_fmu::component::ModelComponent;
use octant_fmu::values::CellValues;
use octant_sample::Parameters;

/// Numbers with all digits, none twice.
struct Numbers(f64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 += 1.0;
        self.0 / 7.0
    }

    fn array<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.next())
    }
}

fn estimators(n: &mut Numbers) -> Vec<Estimator> {
    let mut all = Vec::new();
    for (i, error_model) in [ErrorModel::Phi, ErrorModel::Psi].into_iter().enumerate() {
        all.push(Estimator::Kalman(Kalman {
            error_model,
            estimated: std::array::from_fn(|group| group % 2 == i),
            prior: Prior {
                attitude_rad: n.array(),
                velocity_mps: n.next(),
                position_m: n.next(),
                parameters: n.array(),
            },
            aiding: match i {
                0 => AidingMode::Velocity { sigma_mps: n.next() },
                _ => AidingMode::Position { sigma_m: n.next() },
            },
            aiding_period_ns: 123_456_789_012_345_678,
            sway: if i == 0 { SwayNoise::White } else { SwayNoise::Coloured },
            refuse_above_mean_nis: n.next(),
            further: Default::default(),
            sigma_limits: Default::default(),
        }));
    }
    for (gravity_mps2, gyro, intervals) in [
        (None, GyroReference::EarthRate, StaticIntervals::Commanded),
        (
            Some(n.next()),
            GyroReference::RotatedGravity,
            StaticIntervals::Detected {
                initial_s: n.next(),
                window_s: n.next(),
                threshold: n.next(),
                shortest_s: n.next(),
            },
        ),
    ] {
        all.push(Estimator::LeastSquares(LeastSquares { gravity_mps2, gyro, intervals }));
    }
    all.push(Estimator::ExternalTurntable(ExternalTurntable {
        q_nc: rotation::exp(&Vector3::from(n.array())),
        encoder_sigma_rad: n.next(),
    }));
    all
}

fn sequences(n: &mut Numbers) -> Vec<Sequence> {
    let mut own =
        || Stop { azimuth_rad: n.next() % 15.0, roll_rad: -n.next() % 15.0, weight: n.next() };
    let all: Vec<Stop> = (0..STOPS_MAX).map(|_| own()).collect();
    vec![
        from_degrees(EIGHT, 1).unwrap(),
        from_degrees(named("twenty-four").unwrap(), u32::MAX).unwrap(),
        from_degrees(SIXTEEN, 2).unwrap(),
        from_degrees(&[(0.0, 0.0, 1.0)], 1).unwrap(),
        // A sequence that is only almost one with a name.
        from_degrees(&[(0.0, -0.0, 1.0)], 1).unwrap(),
        Sequence::new(&all[..1], 3).unwrap(),
        Sequence::new(&all, 1).unwrap(),
    ]
}

fn screenings(n: &mut Numbers) -> Vec<Screening> {
    let reset =
        Recovery::Reset { attitude_rad: n.next(), velocity_mps: n.next(), position_m: n.next() };
    let moving = Base::Moving(BaseMotion {
        angle_rad: n.next(),
        rate_radps: n.next(),
        acceleration_radps2: n.next(),
        force_mps2: n.next(),
        jerk_mps3: n.next(),
    });
    vec![
        Screening::none(),
        Screening::gated(reset),
        Screening::hardened(Base::Still),
        Screening {
            gate: Some(Gate { nis: n.next(), rejections: u32::MAX, recovery: reset }),
            stuck_samples: Some(u32::MAX),
            drift_sigmas: Some(n.next()),
            encoder_sigma_rad: n.next(),
            resolution: (n.next(), n.next()),
            vibration: (n.next(), n.next()),
            bridging: false,
            ..Screening::hardened(moving)
        },
    ]
}

#[test]
fn everything_that_a_core_is_configured_with_survives() {
    let n = &mut Numbers(0.0);
    let (estimators, sequences, screenings) = (estimators(n), sequences(n), screenings(n));
    let mut tried = 0;
    for (i, estimator) in estimators.iter().enumerate() {
        for (j, sequence) in sequences.iter().enumerate() {
            for (k, screening) in screenings.iter().enumerate() {
                let original = CoreConfig {
                    sample_period_ns: 1 + u64::MAX / 3,
                    site: Site {
                        latitude_rad: n.next(),
                        longitude_rad: -n.next(),
                        height_m: n.next(),
                    },
                    alignment: match i % 3 {
                        0 => Alignment::Given {
                            q_nb: rotation::exp(&Vector3::from(n.array())),
                            velocity_mps: Vector3::from(n.array()),
                        },
                        1 => Alignment::Coarse { duration_s: n.next() },
                        _ => Alignment::Inertial { duration_s: n.next() },
                    },
                    calibration: (j > 0).then(|| Calibration {
                        sequence: sequence.clone(),
                        duration_s: n.next(),
                        estimator: *estimator,
                    }),
                    navigation: (k > 0).then(|| NavigationPlan {
                        duration_s: (k > 1).then(|| n.next()),
                        rotation: sequences[(j + k) % sequences.len()].clone(),
                        dwell_s: n.next(),
                    }),
                    turntable: TurntableRates {
                        rate_radps: n.next(),
                        acceleration_radps2: n.next(),
                    },
                    noise: Noise { angle_random_walk: n.next(), velocity_random_walk: n.next() },
                    initial_parameters: Parameters::from_array(&n.array()),
                    screening: *screening,
                };
                let mut values = CellValues::new(&MODEL);
                put(&original, &mut values);
                // Debug prints every field, and floats so that they read back to the same bits.
                let found = format!("{:?}", config(&values).unwrap());
                assert_eq!(found, format!("{original:?}"), "{i} {j} {k}");
                tried += 1;
            }
        }
    }
    assert_eq!(tried, 5 * 7 * 4);
}

#[test]
fn the_start_values_are_the_reference_instrument_in_eight_positions() {
    let values = CellValues::new(&MODEL);
    let found = config(&values).unwrap();
    Core::new(&found).unwrap();
    let calibration = found.calibration.unwrap();
    assert_eq!(calibration.sequence, from_degrees(EIGHT, 1).unwrap());
    assert_eq!(calibration.duration_s, 4.0 * 3600.0);
    let Estimator::Kalman(kalman) = calibration.estimator else { panic!("a Kalman filter") };
    assert_eq!(kalman.estimated, [true; 7]);
    assert_eq!(kalman.prior.parameters[0], 0.005 * DEG_PER_HOUR);
    assert_eq!(found.noise.angle_random_walk, 0.0007 * DEG_PER_SQRT_HOUR);
    assert_eq!(found.noise.velocity_random_walk, 50.0 * MICRO_G);
    assert_eq!(found.screening, Screening::hardened(Base::Still));
    assert_eq!(found.navigation.unwrap().rotation, from_degrees(SIXTEEN, 1).unwrap());
    // The tables of one's own start as the named ones.
    for (name, stops) in
        [("procedure.calibration.positions", EIGHT), ("procedure.navigation.rotation", SIXTEEN)]
    {
        let mut values = CellValues::new(&MODEL);
        values.set_integer(MODEL.slot(name), 0);
        let found = config(&values).unwrap();
        let sequence = match name {
            "procedure.calibration.positions" => found.calibration.unwrap().sequence,
            _ => found.navigation.unwrap().rotation,
        };
        assert_eq!(sequence, from_degrees(stops, 1).unwrap());
    }
}

#[test]
fn what_contradicts_itself_is_refused_with_the_variable_and_what_is_expected() {
    let refused = |change: &dyn Fn(&mut CellValues)| {
        let mut values = CellValues::new(&MODEL);
        change(&mut values);
        Calibrator::initialize(&mut values).err().unwrap().to_string()
    };
    let slot = |name| MODEL.slot(name);
    let attitude = "procedure.alignment.attitude";
    let said = refused(&|values| {
        values.set_integer(slot("procedure.alignment.method"), 0);
        values.set_reals(slot(attitude), &[1.0, 0.5, 0.0, 0.0]);
    });
    assert_eq!(
        said,
        "procedure.alignment.attitude has the norm 1.118033988749895, a unit quaternion is expected"
    );
    let said = refused(&|values| {
        values.set_integer(slot("procedure.calibration.positions"), 0);
        values.set_integer(slot("procedure.calibration.stops.count"), 65);
    });
    assert_eq!(said, "procedure.calibration.stops.count is 65, 1 to 64 is expected");
    let said = refused(&|values| {
        values.set_integer(slot("procedure.calibration.positions"), 0);
        values.set_real(slot("procedure.calibration.stops.weight") + 3, 0.0);
    });
    assert_eq!(
        said,
        "procedure.calibration.positions: stop 3: dwell weight 0 is not a positive number"
    );
    let said = refused(&|values| values.set_integer(slot("procedure.navigation.rotation"), 4));
    assert_eq!(said, "procedure.navigation.rotation is 4, which is none of its items");
    let said = refused(&|values| values.set_count(slot("procedure.calibration.passes"), 1 << 32));
    assert_eq!(said, "procedure.calibration.passes is 4294967296, at most 4294967295 is expected");
    let said = refused(&|values| values.set_count(slot("imu.period_ns"), 0));
    assert_eq!(said, "sample period is 0 ns, 1 ns to 1 s is expected");
    let said = refused(&|values| {
        values.set_boolean(slot("procedure.calibration.enabled"), false);
        values.set_boolean(slot("procedure.navigation.enabled"), false);
    });
    assert_eq!(said, "neither a calibration nor a navigation is configured");
}
