//! The state of a plant as bytes: a plant that was saved and loaded continues bit for bit, with
//! everything that can be under way; other bytes are refused.

use super::common::*;
use octant_earth::units::{ARCSEC, DEG, DEG_PER_HOUR, MICRO_G, PPM};
use octant_plant::config::*;
use octant_plant::course::{Course, CoursePoint};
use octant_plant::{Plant, STATE_FORMAT, draw, motion};
use octant_sample::GimbalCommand;
use octant_sample::disturbance::*;
use octant_state::{StateError, Writer, assert_layout, outline_of};
use proptest::prelude::*;
use std::sync::LazyLock;
use std::time::Instant;

/// Configuration with every imperfection of sensors and turntable.
pub(super) fn everything(motion: Motion, time_skew_s: f64) -> PlantConfig {
    let mut config = noisy();
    config.calibration_samples = 900;
    config.motion = motion;
    config.turntable.encoder_sigma_rad = 18.0 * ARCSEC;
    config.turntable.non_orthogonality_rad = 1e-4;
    config.turntable.backlash_rad = 20.0 * ARCSEC;
    config.turntable.errors = GimbalErrors {
        mounting_rad: [1e-4, -2e-4, 3e-4],
        encoder_zero_rad: [1e-5, 2e-5],
        eccentricity_rad: [[3e-5, 1e-5], [-2e-5, 1e-5]],
        encoder_noise_rad: 1e-6,
    };
    config.imu.parameters = draw::parameters(4, &draw::ParameterDraws::table_1());
    config.imu.extensions = Extensions {
        gyro_gauss_markov: Some(GaussMarkov {
            sigma: 0.01 * DEG_PER_HOUR,
            correlation_time_s: 100.0,
        }),
        accel_gauss_markov: Some(GaussMarkov { sigma: 10.0 * MICRO_G, correlation_time_s: 60.0 }),
        gyro_rate_random_walk: 1e-9,
        gyro_bias_instability: 0.02 * DEG_PER_HOUR,
        accel_bias_instability: 15.0 * MICRO_G,
        gyro_quantization_rad: 1e-7,
        accel_quantization_mps: 1e-6,
        gyro_range_radps: 6.0,
        accel_range_mps2: 400.0,
        temperature: Some(Temperature {
            ramp_kps: 0.5,
            plateau_k: 2.0,
            gyro_bias_per_k: [0.001 * DEG_PER_HOUR; 3],
            accel_bias_per_k: [MICRO_G; 3],
            gyro_scale_per_k: [PPM; 3],
            accel_scale_per_k: [PPM; 3],
        }),
        vibration: Some(Vibration {
            frequency_hz: 33.0,
            displacement_m: [1e-6, 0.0, 2e-6],
            angle_rad: [0.0, 1e-6, 0.0],
            phase_rad: 0.4,
        }),
        lever_arm_m: [[0.02, 0.0, 0.01], [0.0, -0.03, 0.0], [0.01, 0.0, 0.02]],
        time_skew_s,
        ..Extensions::default()
    };
    config.aiding =
        AidingSource { kind: AidingKind::Velocity { sigma_mps: 0.001 }, period_ns: 20 * PERIOD_NS };
    config
}

fn ship() -> Motion {
    Motion::Dockside(motion::dockside_default(2))
}

pub(super) fn ground() -> Motion {
    Motion::Static(CaseAttitude { heading_rad: 0.4, pitch_rad: 0.02, roll_rad: -0.01 })
}

fn line(frequency_hz: f64) -> SpectralLine {
    SpectralLine {
        frequency_hz,
        displacement_m: [1e-5, 0.0, -2e-5],
        angle_rad: [0.0, 1e-5, 1e-5],
        phase_rad: 0.3,
        angle_phase_rad: 1.1,
    }
}

/// One disturbance of each kind.
pub(super) fn disturbances() -> Vec<Disturbance> {
    let gimbal = |gimbal, action| Disturbance::Gimbal { gimbal, action };
    let (azimuth, roll) = (Gimbal::Azimuth, Gimbal::Roll);
    vec![
        Disturbance::Vibration { lines: vec![line(50.0), line(120.0)], edge_s: 0.4 },
        Disturbance::Shock { peak_mps2: [30.0, 0.0, -10.0], width_s: 0.011, recoil_s: 1.5 },
        Disturbance::LeverArm([[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.03]]),
        Disturbance::Temperature {
            ramp_kps: 0.2,
            plateau_k: 1.0,
            gyro_bias_per_k: [0.01 * DEG_PER_HOUR; 3],
            accel_bias_per_k: [5.0 * MICRO_G; 3],
            gyro_scale_per_k: [PPM; 3],
            accel_scale_per_k: [2.0 * PPM; 3],
        },
        Disturbance::Case { lines: vec![line(0.4)], edge_s: 0.7 },
        Disturbance::Excursion {
            displacement_m: [0.1, 0.0, 0.02],
            angle_rad: [0.01, 0.0, 0.0],
            length_s: 3.0,
        },
        gimbal(azimuth, GimbalAction::Slip { angle_rad: 0.02 * DEG, within_s: 2.0, seen: true }),
        gimbal(roll, GimbalAction::EncoderSlip { angle_rad: 0.1 * DEG, flagged: true }),
        gimbal(roll, GimbalAction::Overshoot { angle_rad: 0.01 * DEG }),
        gimbal(
            roll,
            GimbalAction::Ringing { amplitude_rad: 1e-4, frequency_hz: 5.0, decay_s: 0.4 },
        ),
        gimbal(azimuth, GimbalAction::Backlash { play_rad: 1e-3 }),
        gimbal(azimuth, GimbalAction::Stall),
        gimbal(roll, GimbalAction::Runaway { rate_radps: 0.02 }),
    ]
}

fn saved(plant: &Plant) -> Vec<u8> {
    let mut bytes = Vec::new();
    plant.save(&mut bytes);
    bytes
}

/// A set point that changes every two seconds.
pub(super) fn target(k: u64) -> GimbalCommand {
    let turn = (k / 400) as f64;
    command(10.0 * turn, if k < 700 { 0.0 } else { -6.0 * turn })
}

/// Begins and ends disturbances before sample k: each disturbance of the list sets in after the one
/// before, and they end in the same order.
fn happen(plant: &mut Plant, these: &[Disturbance], k: u64) {
    for (handle, disturbance) in (0..).zip(these) {
        let onset = 150 + 40 * u64::from(handle);
        if k == onset {
            plant.begin(handle, disturbance);
        }
        if k == onset + 800 {
            plant.end(handle);
        }
    }
}

/// Runs a plant with disturbances, and beside it copies that were saved and loaded at some samples.
fn goes_on(config: &PlantConfig, these: &[Disturbance], points: &[u64]) {
    let mut plant = Plant::new(config).unwrap();
    let mut copies: Vec<Plant> = Vec::new();
    for k in 1..=1900 {
        for one in copies.iter_mut().chain([&mut plant]) {
            happen(one, these, k);
        }
        let step = plant.step(&target(k));
        for copy in &mut copies {
            assert_eq!(copy.step(&target(k)), step, "sample {k}, {these:?}");
        }
        if points.contains(&k) {
            copies.push(Plant::load(&saved(&plant)).unwrap());
        }
        if k % 100 == 0 || points.contains(&k) {
            let truth = format!("{:?}", plant.truth());
            assert!(copies.iter().all(|copy| format!("{:?}", copy.truth()) == truth), "{k}");
        }
    }
    assert_eq!(copies.len(), points.len());
    let bytes = saved(&plant);
    assert!(copies.iter().all(|copy| saved(copy) == bytes));
}

#[test]
fn a_loaded_plant_goes_on_bit_for_bit_with_each_disturbance_and_with_all() {
    let all = disturbances();
    for (motion, skew) in [(ground(), 0.0), (ship(), 0.0), (ground(), 0.0123), (ship(), 0.004)] {
        let config = everything(motion, skew);
        for one in &all {
            // At the onset, while it lasts, after its end, in navigation.
            goes_on(&config, std::slice::from_ref(one), &[149, 153, 555, 951, 1200]);
        }
        goes_on(&config, &all, &[1, 152, 313, 640, 700, 899, 900, 901, 1111, 1440]);
    }
    // Plain plants, whose samples are made in one step while they rest.
    for motion in [ground(), ship()] {
        let config = PlantConfig { motion, ..perfect() };
        goes_on(&config, &[], &[1, 200, 420, 700]);
        goes_on(&config, &all, &[200, 313, 640, 1111, 1890]);
    }
}

#[test]
fn a_new_plant_is_saved_too() {
    let config = everything(ship(), 0.0123);
    let (mut plant, fresh) = (Plant::new(&config).unwrap(), Plant::new(&config).unwrap());
    let mut loaded = Plant::load(&saved(&fresh)).unwrap();
    for k in 1..1000 {
        assert_eq!(plant.step(&target(k)), loaded.step(&target(k)));
    }
}

#[test]
fn a_command_before_a_sample_is_the_step_in_the_other_order() {
    let config = everything(ship(), 0.0);
    let (mut one, mut other) = (Plant::new(&config).unwrap(), Plant::new(&config).unwrap());
    let mut step = one.step(&target(0));
    let (mut sample, mut aiding) = (octant_sample::Sample::default(), None);
    other.sample_into(&mut sample, &mut aiding);
    for k in 1..1500 {
        assert_eq!((sample, aiding), (step.sample, step.aiding));
        // The earlier call had its command at its end; here the command comes at the beginning.
        other.command(&target(k - 1));
        other.sample_into(&mut sample, &mut aiding);
        step = one.step(&target(k));
    }
}

#[test]
fn a_course_is_a_part_of_the_state() {
    let point = |k: u64| {
        let t = k as f64;
        core::array::from_fn(|dof| CoursePoint {
            value: 1e-3 * t * (1.0 + dof as f64),
            rate: 0.2 * (1.0 + dof as f64),
            acceleration: 1e-2 * t,
        })
    };
    let course = |k: u64| Course::between(k as f64 * DT, DT, &point(k), &point(k + 1));
    let mut plant = Plant::new(&everything(ship(), 0.0)).unwrap();
    let mut copies: Vec<Plant> = Vec::new();
    for k in 0..400 {
        let steps: Vec<String> = copies
            .iter_mut()
            .chain([&mut plant])
            .map(|one| {
                one.follow(&course(k)).unwrap();
                let step = one.step(&target(k));
                format!("{step:?} {:?}", one.truth())
            })
            .collect();
        assert!(steps.iter().all(|step| *step == steps[0]), "{k}");
        if [3, 150, 270].contains(&k) {
            let loaded = Plant::load(&saved(&plant)).unwrap();
            assert_eq!(format!("{:?}", loaded.truth()), format!("{:?}", plant.truth()));
            copies.push(loaded);
        }
    }
    assert_eq!(copies.len(), 3);
}

fn under_way(motion: Motion, skew: f64, these: &[Disturbance], samples: u64) -> Plant {
    let mut plant = Plant::new(&everything(motion, skew)).unwrap();
    for k in 1..=samples {
        happen(&mut plant, these, k);
        plant.step(&target(k));
    }
    plant
}

fn plants() -> Vec<(&'static str, Plant)> {
    let all = disturbances();
    let mut plain = Plant::new(&noisy()).unwrap();
    run(&mut plain, &target(0), 300);
    vec![
        ("plain", plain),
        ("ground, everything", under_way(ground(), 0.0123, &all, 900)),
        ("ship, everything", under_way(ship(), 0.0, &all, 760)),
        ("ship, some over", under_way(ship(), 0.01, &all, 1100)),
    ]
}

#[test]
fn the_layout_is_the_stored_one() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/state");
    let plants = plants();
    let mut outlines: Vec<_> =
        plants.iter().map(|(name, plant)| (*name, Writer::outline(plant))).collect();
    for (name, plant) in &plants {
        outlines.push((*name, outline_of("config", plant.config())));
    }
    assert_layout(&format!("{folder}/plant.txt"), STATE_FORMAT.version, &outlines);

    // Bytes of that version have to remain readable.
    let path = format!("{folder}/plant-{}.bin", STATE_FORMAT.version);
    let (_, plant) = &plants[1];
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(&path, saved(plant)).unwrap();
    }
    let stored = std::fs::read(&path).unwrap();
    let loaded = Plant::load(&stored).unwrap();
    assert_eq!(saved(&loaded), stored);
    assert_eq!(Writer::outline(&loaded), Writer::outline(plant));
}

/// A configuration that an earlier version lacked can't be made up.
#[test]
fn a_state_of_an_earlier_version_is_refused_in_words() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/state");
    for version in 1..STATE_FORMAT.version {
        let stored = std::fs::read(format!("{folder}/plant-{version}.bin")).unwrap();
        assert_eq!(
            Plant::load(&stored).unwrap_err().to_string(),
            format!("the state of a plant has version {version}, this program reads version 6")
        );
    }
}

/// Makes a frame with another payload and the right checksum.
fn reframed(payload: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    STATE_FORMAT.write(&mut bytes, |to| payload.iter().for_each(|byte| to.value("byte", byte)));
    bytes
}

fn payload(bytes: &[u8]) -> &[u8] {
    &bytes[18..bytes.len() - 4]
}

#[test]
fn what_is_wrong_is_said() {
    let good = saved(&plants()[0].1);
    assert_eq!(reframed(payload(&good)), good, "the frame is as the test thinks");
    let said = |bytes: &[u8]| Plant::load(bytes).unwrap_err().to_string();
    assert_eq!(said(b""), "not the state of a plant: it does not begin with OCTANTPL");
    assert_eq!(
        said(&good[..40]),
        format!("the state of a plant has 40 bytes, {} are expected", good.len())
    );
    // The first value of the configuration is the sample period, 5 000 000 ns in four bytes.
    let mut fast = payload(&good).to_vec();
    fast.splice(..4, [1]);
    assert_eq!(
        said(&reframed(&fast)),
        "config: sample_period_ns is 1, expected 10000 (100 kHz) to 1000000000 (1 Hz)"
    );
}

static SAVED: LazyLock<Vec<Vec<u8>>> =
    LazyLock::new(|| plants().iter().map(|(_, plant)| saved(plant)).collect());

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_altered_bit_and_any_cut_is_refused(
        which in 0..4usize,
        at in any::<prop::sample::Index>(),
        bit in 0..8u8,
    ) {
        let good = &SAVED[which];
        let at = at.index(good.len());
        prop_assert!(Plant::load(&good[..at]).is_err());
        let mut altered = good.clone();
        altered[at] ^= 1 << bit;
        let error = Plant::load(&altered).unwrap_err();
        prop_assert!(!matches!(error, StateError::Value { .. }), "{error}");
    }

    /// Any bytes with a right checksum are refused, or the plant made from them doesn't panic.
    #[test]
    fn nonsense_with_a_right_checksum_does_not_panic(
        which in 0..4usize,
        changes in prop::collection::vec(
            (any::<prop::sample::Index>(), prop_oneof![any::<u8>(), Just(0xFF), Just(0)]),
            1..12,
        ),
        run in 1..9usize,
    ) {
        let mut altered = payload(&SAVED[which]).to_vec();
        for (at, value) in &changes {
            let at = at.index(altered.len());
            let end = (at + run).min(altered.len());
            altered[at..end].fill(*value);
        }
        if let Ok(mut plant) = Plant::load(&reframed(&altered)) {
            let _ = plant.motor();
            for k in 0..40 {
                plant.step(&target(k * 20));
                if k == 5 {
                    plant.begin(77, &disturbances()[10]);
                    (0..13).for_each(|handle| plant.end(handle));
                }
                if k == 20 {
                    plant.end(77);
                }
            }
            let _ = plant.truth();
            let _ = saved(&plant);
        }
    }
}

/// Prints the duration and the size, for information.
#[test]
fn figures() {
    for (name, plant) in plants() {
        const TIMES: u32 = 200;
        let mut bytes = Vec::new();
        let start = Instant::now();
        for _ in 0..TIMES {
            std::hint::black_box(plant.clone());
        }
        let cloned = start.elapsed() / TIMES;
        let start = Instant::now();
        for _ in 0..TIMES {
            bytes.clear();
            plant.save(&mut bytes);
        }
        let saved = start.elapsed() / TIMES;
        let start = Instant::now();
        for _ in 0..TIMES {
            std::hint::black_box(Plant::load(&bytes).unwrap());
        }
        let loaded = start.elapsed() / TIMES;
        println!(
            "{name}: {} bytes in memory, {} saved; clone {cloned:?}, save {saved:?}, load {loaded:?}",
            size_of::<Plant>(),
            bytes.len()
        );
        assert!(bytes.len() < 16 * 1024);
    }
}
