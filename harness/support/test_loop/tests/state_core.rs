//! A core that was saved and loaded continues bit for bit: at any point of the procedure, with
//! every estimator, on land and on a ship, with every screen, during faults.

use octant_calibration::Core;
use octant_calibration::config::*;
use octant_calibration::positions::EIGHT;
use octant_earth::UnitQuaternion;
use octant_earth::units::*;
use octant_plant::config as plant;
use octant_sample::canonical;
use octant_sample::{Aiding, Mode, Output, Reference, Sample, Status};
use octant_test_loop::instrument::{InstrumentCase, PERIOD_NS, dockside};
use octant_test_loop::plant_and_core::{ClosedLoop, on_two_threads};
use std::time::Instant;

/// Eight minutes of calibration, and four of navigation.
const SAMPLES: u64 = 12 * 60 * 200;
const CALIBRATION: u64 = 8 * 60 * 200;

fn case(seed: u64) -> InstrumentCase {
    InstrumentCase {
        calibration_h: 8.0 / 60.0,
        navigation_h: 4.0 / 60.0,
        ..InstrumentCase::table_1(seed, EIGHT)
    }
}

fn with_estimator(mut config: CoreConfig, estimator: Estimator) -> CoreConfig {
    config.calibration.as_mut().unwrap().estimator = estimator;
    config
}

fn kalman(config: &CoreConfig) -> Kalman {
    match config.calibration.as_ref().unwrap().estimator {
        Estimator::Kalman(kalman) => Kalman { refuse_above_mean_nis: 1e12, ..kalman },
        _ => unreachable!(),
    }
}

/// Lists every estimator on land, the Kalman filter on a ship.
fn methods(seed: u64) -> Vec<(&'static str, plant::PlantConfig, CoreConfig)> {
    let case = case(seed);
    let (ground, base) = (case.plant(), case.core());
    let psi = Kalman { error_model: ErrorModel::Psi, ..kalman(&base) };
    let mut without_g = kalman(&base);
    without_g.estimated[octant_sample::parameters::ParameterGroup::GDependent as usize] = false;
    let least_squares = |gyro, intervals| {
        Estimator::LeastSquares(LeastSquares { gravity_mps2: None, gyro, intervals })
    };
    let detected = StaticIntervals::Detected {
        initial_s: 10.0,
        window_s: 2.0,
        threshold: 3.0,
        shortest_s: 4.0,
    };
    let external = Estimator::ExternalTurntable(ExternalTurntable {
        q_nc: UnitQuaternion::identity(),
        encoder_sigma_rad: 18.0 * ARCSEC,
    });
    let mut coarse = base.clone();
    coarse.alignment = Alignment::Coarse { duration_s: 10.0 };
    let (ship, afloat) = dockside(&case);
    let mut all: Vec<_> = [
        ("phi", with_estimator(base.clone(), Estimator::Kalman(kalman(&base)))),
        ("psi", with_estimator(coarse.clone(), Estimator::Kalman(psi))),
        ("without G", with_estimator(base.clone(), Estimator::Kalman(without_g))),
        (
            "Earth rate, commanded",
            with_estimator(
                base.clone(),
                least_squares(GyroReference::EarthRate, StaticIntervals::Commanded),
            ),
        ),
        (
            "rotated gravity, detected",
            with_estimator(coarse, least_squares(GyroReference::RotatedGravity, detected)),
        ),
        ("external turntable", with_estimator(base, external)),
    ]
    .into_iter()
    .map(|(name, core)| (name, ground.clone(), core))
    .collect();
    // Noise from which on the filter takes the known motion at rest.
    for (name, mut plant, mut core) in
        [("noisy", ground, case.core()), ("noisy, ship", ship.clone(), afloat.clone())]
    {
        plant.imu.angle_random_walk *= 100.0;
        core.noise.angle_random_walk *= 100.0;
        let told = kalman(&core);
        all.push((name, plant, with_estimator(core, Estimator::Kalman(told))));
    }
    let white = kalman(&afloat);
    let coloured = Kalman {
        sway: SwayNoise::Coloured,
        aiding: AidingMode::Position { sigma_m: 0.01 },
        ..white
    };
    for (name, kalman) in [("ship", white), ("ship, coloured sway", coloured)] {
        let core = with_estimator(afloat.clone(), Estimator::Kalman(kalman));
        all.push((name, ship.clone(), core));
    }
    all
}

fn screenings(base: Base) -> [(&'static str, Screening); 4] {
    let reset =
        Recovery::Reset { attitude_rad: 3600.0 * ARCSEC, velocity_mps: 1.0, position_m: 10.0 };
    [
        ("none", Screening::none()),
        ("gate, reset", Screening::gated(reset)),
        ("gate, widening", Screening::gated(Recovery::Widening)),
        ("hardened", Screening::hardened(base)),
    ]
}

/// SplitMix64: numbers of a test, the same on every run.
fn mix(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// Alters the stream for a while about every twenty seconds: gaps, jumps, stuck channels, flags,
/// wrong references.
fn altered(sample: Sample, aiding: Option<Aiding>) -> Option<(Sample, Option<Aiding>)> {
    let (mut sample, mut aiding) = (sample, aiding);
    let (stretch, within) = (sample.sequence / 4000, sample.sequence % 4000);
    let channel = (mix(stretch) >> 8) as usize % 3;
    match mix(stretch) % 8 {
        0 if (500..507).contains(&within) => return None,
        1 if (500..520).contains(&within) => sample.delta_theta[channel] += 40_000_000,
        2 if (500..900).contains(&within) => sample.delta_theta[channel] = 12_345,
        3 if (500..560).contains(&within) => sample.delta_velocity[channel] = -777,
        4 if (500..510).contains(&within) => sample.status |= Status::INERTIAL_INVALID,
        5 if within > 2500 => {
            if let Some(Aiding { reference: Reference::Velocity([north, ..]), .. }) = &mut aiding {
                *north += 0.3;
            }
        }
        6 if within > 3000 => aiding = None,
        _ => {}
    }
    Some((sample, aiding))
}

fn bits(output: &Output) -> [u8; canonical::OUTPUT_BYTES] {
    let mut bytes = [0; canonical::OUTPUT_BYTES];
    canonical::output(output, &mut bytes);
    bytes
}

fn estimate_bits(core: &Core) -> [u8; canonical::PARAMETERS_BYTES] {
    let mut bytes = [0; canonical::PARAMETERS_BYTES];
    canonical::parameters(core.parameters(), core.sigma(), &mut bytes);
    bytes
}

fn saved(core: &Core) -> Vec<u8> {
    let mut bytes = Vec::new();
    core.save(&mut bytes);
    bytes
}

/// Runs a method and, from each of some points on, also a core that was saved and loaded there.
/// Returns the modes at these points.
fn run(
    plant: &plant::PlantConfig,
    core: &CoreConfig,
    faults: bool,
    seed: u64,
) -> Vec<(Mode, usize)> {
    // One in the first seconds, three in the calibration, one at its end, one in the navigation.
    let at = |nth: u64, from: u64, to: u64| from + mix(seed * 16 + nth) % (to - from);
    let points = [
        at(0, 1, 1500),
        at(1, 1500, CALIBRATION / 2),
        at(2, CALIBRATION / 2, CALIBRATION),
        at(3, 1500, CALIBRATION),
        at(4, CALIBRATION - 2, CALIBRATION + 3),
        at(5, CALIBRATION, SAMPLES),
    ];
    let mut original = ClosedLoop::new(plant, core);
    let mut copies: Vec<Core> = Vec::new();
    let mut told = Vec::new();
    let mut revision = 0;
    for k in 1..=SAMPLES {
        let mut given = None;
        let output = original.step_altered(|sample, aiding| {
            given = if faults { altered(sample, aiding) } else { Some((sample, aiding)) };
            given
        });
        if let (Some((sample, aiding)), Some(output)) = (given, output) {
            for copy in &mut copies {
                assert_eq!(bits(&copy.step(&sample, aiding.as_ref())), bits(&output), "at {k}");
            }
            if output.parameters_revision != revision {
                revision = output.parameters_revision;
                for copy in &copies {
                    assert_eq!(estimate_bits(copy), estimate_bits(&original.core), "at {k}");
                }
            }
        }
        if points.contains(&k) {
            let bytes = saved(&original.core);
            copies.push(Core::load(&bytes).unwrap());
            told.push((original.output.mode, bytes.len()));
        }
    }
    let last = original.core.end_of_stream();
    let bytes = saved(&original.core);
    for copy in &mut copies {
        assert_eq!(bits(&copy.end_of_stream()), bits(&last));
        assert_eq!(saved(copy), bytes);
        assert_eq!(
            format!("{:?}", copy.diagnostics()),
            format!("{:?}", original.core.diagnostics())
        );
    }
    told
}

#[test]
fn a_loaded_core_goes_on_bit_for_bit() {
    let mut cases = Vec::new();
    for (index, (method, plant, core)) in methods(3).into_iter().enumerate() {
        for (screen, screening) in screenings(core.screening.base) {
            // With faults where a screen can detect them, and the bare filter too.
            let faults = screen != "gate, widening";
            let core = CoreConfig { screening, ..core.clone() };
            cases.push((method, screen, faults, plant.clone(), core.clone(), 10 + index as u64));
            if screen == "hardened" {
                cases.push((method, screen, false, plant.clone(), core, 30 + index as u64));
            }
        }
    }
    let all = on_two_threads(&cases, |(method, screen, faults, plant, core, seed)| {
        let told = run(plant, core, *faults, *seed);
        println!("{method}, {screen}, faults {faults}: {told:?}");
        told
    });
    // Saves happened in every mode.
    for mode in [Mode::Calibrating, Mode::Navigating, Mode::Refused] {
        assert!(all.iter().flatten().any(|(found, _)| *found == mode), "{mode:?}");
    }
}

#[test]
fn a_loaded_core_goes_on_in_the_middle_of_its_alignment_and_of_a_move() {
    let case = case(5);
    let mut core = case.core();
    core.alignment = Alignment::Coarse { duration_s: 12.0 };
    let mut original = ClosedLoop::new(&case.plant(), &core);
    original.run_to(1_000);
    assert_eq!(original.output.mode, Mode::Aligning);
    let mut aligning = original.clone();
    aligning.core = Core::load(&saved(&original.core)).unwrap();
    while !original.output.moving {
        original.step();
    }
    for _ in 0..300 {
        original.step();
    }
    let mut moving = original.clone();
    moving.core = Core::load(&saved(&original.core)).unwrap();
    assert!(original.output.moving);
    aligning.run_to(original.output.sequence);
    for _ in 0..20_000 {
        let output = bits(&original.step());
        assert_eq!(bits(&aligning.step()), output);
        assert_eq!(bits(&moving.step()), output);
    }
    assert_eq!(saved(&aligning.core), saved(&original.core));
}

/// Prints the duration and size of a save.
#[test]
fn figures() {
    let case = case(1);
    let mut running = ClosedLoop::of(&case);
    running.run_to(CALIBRATION / 2);
    let external = &methods(1)[3];
    let mut other = ClosedLoop::new(&external.1, &external.2);
    other.run_to(CALIBRATION / 2);
    for (name, core) in [("Kalman", &running.core), ("least squares", &other.core)] {
        const TIMES: u32 = 200;
        let (mut bytes, mut found) = (Vec::new(), None);
        let start = Instant::now();
        for _ in 0..TIMES {
            std::hint::black_box(core.clone());
        }
        let cloned = start.elapsed() / TIMES;
        let start = Instant::now();
        for _ in 0..TIMES {
            bytes.clear();
            core.save(&mut bytes);
        }
        let saved = start.elapsed() / TIMES;
        let start = Instant::now();
        for _ in 0..TIMES {
            found = Some(Core::load(&bytes).unwrap());
        }
        let loaded = start.elapsed() / TIMES;
        println!(
            "{name}: {} bytes in memory, {} saved; clone {cloned:?}, save {saved:?}, load {loaded:?}",
            size_of::<Core>(),
            bytes.len()
        );
        assert!(found.is_some() && bytes.len() < 64 * 1024);
    }
    assert_eq!(PERIOD_NS, 5_000_000);
}
