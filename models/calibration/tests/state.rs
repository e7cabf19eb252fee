//! The state of a core as bytes: its layout, and the refusal of other bytes.
//!
//! A test in the harness, with the plant, checks that a core continues bit for bit.

use super::instrument::{ARW, EIGHT, HEADING_RAD, Instrument, PERIOD_NS, SITE, VRW, truth};
use octant_calibration::Core;
use octant_calibration::config::*;
use octant_calibration::positions::{SIXTEEN, from_degrees};
use octant_calibration::state_machine::{CoreConfigError, STATE_FORMAT};
use octant_earth::frames::{c_nc, quaternion_from_matrix};
use octant_earth::units::*;
use octant_earth::{UnitQuaternion, Vector3};
use octant_sample::{Aiding, Mode, Parameters, Reference, Sample};
use octant_state::{StateError, Writer, assert_layout, outline_of};
use proptest::prelude::*;
use std::sync::LazyLock;

const DURATION_S: f64 = 300.0;

fn q_nc() -> UnitQuaternion<f64> {
    quaternion_from_matrix(&c_nc(HEADING_RAD, 0.0, 0.0))
}

pub(super) fn kalman() -> Estimator {
    Estimator::Kalman(Kalman {
        error_model: ErrorModel::Phi,
        estimated: [true; 7],
        prior: Prior {
            attitude_rad: [60.0 * ARCSEC, 60.0 * ARCSEC, 0.1 * DEG],
            velocity_mps: 0.02,
            position_m: 1.0,
            parameters: [
                0.01 * DEG_PER_HOUR,
                30.0 * PPM,
                40.0 * ARCSEC,
                1e-3 * DEG_PER_HOUR_PER_G,
                100.0 * MICRO_G,
                30.0 * PPM,
                40.0 * ARCSEC,
            ],
        },
        aiding: AidingMode::Velocity { sigma_mps: 1e-3 },
        aiding_period_ns: 1_000_000_000,
        sway: SwayNoise::White,
        refuse_above_mean_nis: 1e9,
        further: Default::default(),
        sigma_limits: Default::default(),
    })
}

pub(super) fn config(estimator: Estimator, screening: Screening) -> CoreConfig {
    let stops: Vec<_> = EIGHT.iter().map(|(azimuth, roll)| (*azimuth, *roll, 1.0)).collect();
    CoreConfig {
        sample_period_ns: PERIOD_NS,
        site: SITE,
        alignment: Alignment::Given { q_nb: q_nc(), velocity_mps: Vector3::zeros() },
        calibration: Some(Calibration {
            sequence: from_degrees(&stops, 1).unwrap(),
            duration_s: DURATION_S,
            estimator,
        }),
        navigation: Some(NavigationPlan {
            duration_s: None,
            rotation: from_degrees(SIXTEEN, 1).unwrap(),
            dwell_s: 60.0,
        }),
        turntable: TurntableRates { rate_radps: 10.0 * DEG, acceleration_radps2: 10.0 * DEG },
        noise: Noise { angle_random_walk: ARW, velocity_random_walk: VRW },
        initial_parameters: Parameters::default(),
        screening,
    }
}

/// Samples of the eight positions with a velocity reference once a second.
static STREAM: LazyLock<Vec<(Sample, Option<Aiding>)>> = LazyLock::new(|| {
    let mut all = Vec::new();
    // Moves of this instrument have no ramps, which is irrelevant for the core.
    Instrument::new(truth(), ARW, VRW, 1).run(EIGHT, 7.0, |sample, _, _| {
        let aiding = (sample.sequence % 50 == 0).then_some(Aiding {
            device_time: sample.device_time,
            reference: Reference::Velocity([1e-4, -1e-4, 0.0]),
        });
        all.push((*sample, aiding));
    });
    all
});

pub(super) fn go_on(core: &mut Core, from: usize, to: usize) {
    for (sample, aiding) in &STREAM[from.min(STREAM.len())..to.min(STREAM.len())] {
        core.step(sample, aiding.as_ref());
    }
}

pub(super) fn after(config: &CoreConfig, samples: usize) -> Core {
    let mut core = Core::new(config).unwrap();
    go_on(&mut core, 0, samples);
    core
}

fn least_squares(gyro: GyroReference, intervals: StaticIntervals) -> Estimator {
    Estimator::LeastSquares(LeastSquares { gravity_mps2: None, gyro, intervals })
}

/// Cores of every sort, each at some point of its run; together they contain every part of a state.
fn cores() -> Vec<(&'static str, Core)> {
    let hardened = || Screening::hardened(Base::Still);
    let detected = StaticIntervals::Detected {
        initial_s: 3.0,
        window_s: 1.0,
        threshold: 4.0,
        shortest_s: 2.0,
    };
    let mut aligning = config(kalman(), hardened());
    aligning.alignment = Alignment::Coarse { duration_s: 5.0 };
    let bare = config(kalman(), Screening::none());
    let mut short = config(kalman(), hardened());
    short.calibration.as_mut().unwrap().duration_s = 250.0;
    let mut navigating = after(&short, 0);
    for k in 0.. {
        go_on(&mut navigating, k, k + 1);
        if navigating.table().is_some() {
            go_on(&mut navigating, k + 1, k + 100);
            break;
        }
        assert!(k < STREAM.len(), "{:?}", navigating.refusal());
    }
    let mut strict = bare.clone();
    if let Estimator::Kalman(kalman) = &mut strict.calibration.as_mut().unwrap().estimator {
        kalman.refuse_above_mean_nis = 1e-6;
    }
    let mut refused = after(&strict, 2000);
    refused.end_of_stream();
    let external =
        Estimator::ExternalTurntable(ExternalTurntable { q_nc: q_nc(), encoder_sigma_rad: ARCSEC });
    vec![
        ("aligning", after(&aligning, 100)),
        ("kalman, hardened", after(&config(kalman(), hardened()), 6_017)),
        ("kalman, bare", after(&bare, 3_007)),
        (
            "least squares, commanded",
            after(
                &config(
                    least_squares(GyroReference::EarthRate, StaticIntervals::Commanded),
                    hardened(),
                ),
                6_013,
            ),
        ),
        (
            "least squares, detected",
            after(&config(least_squares(GyroReference::RotatedGravity, detected), hardened()), 900),
        ),
        ("external turntable", after(&config(external, Screening::none()), 5_003)),
        ("navigating", navigating),
        ("refused", refused),
        // The drift test has its first mark after 150 s.
        (
            "kalman, marked",
            after(&config(kalman(), hardened()), (160_000_000_000 / PERIOD_NS) as usize),
        ),
    ]
}

fn bytes(core: &Core) -> Vec<u8> {
    let mut bytes = Vec::new();
    core.save(&mut bytes);
    bytes
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
fn a_state_is_read_back_and_gives_the_same_bytes() {
    // Cores by value, of 100 kB and more each, are large for the 2 MB stack of a test.
    let roomy = std::thread::Builder::new().stack_size(16 << 20);
    roomy.spawn(every_state_is_read_back).unwrap().join().unwrap();
}

fn every_state_is_read_back() {
    for (name, core) in cores() {
        let saved = bytes(&core);
        assert_eq!(reframed(payload(&saved)), saved, "the frame is as the test thinks");
        let loaded = Core::load(&saved).unwrap();
        assert_eq!(bytes(&loaded), saved, "{name}");
        assert!(loaded.concluded().is_none(), "a stored state has no covariance of the past");
        assert_eq!(shown(&loaded), shown(&core), "{name}");
    }
}

#[test]
fn a_navigation_planned_while_the_calibration_runs_is_that_of_the_configuration() {
    let roomy = std::thread::Builder::new().stack_size(16 << 20);
    roomy.spawn(navigations_are_planned_anew).unwrap().join().unwrap();
}

fn navigations_are_planned_anew() {
    let mut first = config(kalman(), Screening::hardened(Base::Still));
    first.calibration.as_mut().unwrap().duration_s = 250.0;
    let rotation = from_degrees(&[(0.0, 0.0, 1.0), (90.0, 0.0, 2.0)], 1).unwrap();
    let other = NavigationPlan { duration_s: Some(10.0), rotation, dwell_s: 3.0 };
    let plans = [first.navigation.clone(), Some(other), None];
    let end = Core::new(&first).unwrap().calibration_samples() as usize;
    for navigation in plans {
        let planned = CoreConfig { navigation: navigation.clone(), ..first.clone() };
        for at in [0, 1, end / 2, end - 1] {
            let mut core = after(&first, at);
            core.plan_navigation(navigation.clone()).unwrap();
            go_on(&mut core, at, end + 700);
            assert!(core.table().is_some(), "{:?}", core.refusal());
            assert_eq!(bytes(&core), bytes(&after(&planned, end + 700)), "{at} {navigation:?}");
        }
        // When it has begun it is too late.
        let mut core = after(&first, end);
        let before = bytes(&core);
        assert_eq!(core.plan_navigation(navigation), Err(CoreConfigError::CalibrationOver));
        assert_eq!(bytes(&core), before);
    }
    let mut core = after(&first, 100);
    let before = bytes(&core);
    let endless = NavigationPlan { dwell_s: f64::NAN, ..first.navigation.clone().unwrap() };
    assert!(core.plan_navigation(Some(endless)).is_err());
    assert_eq!(bytes(&core), before, "a plan that is refused changes nothing");
}

/// Every field of a core but those of its past: the covariance at the end of its calibration, and the filter's last
/// passage.
fn shown(core: &Core) -> String {
    let text = format!("{core:?}");
    let (before, rest) = text.split_once("concluded: ").unwrap();
    let (_, after) = rest.split_once(", gimbals: ").unwrap();
    let text = format!("{before}{after}");
    let Some((before, rest)) = text.split_once("passage: ") else { return text };
    let (_, after) = rest.split_once(", elapsed_s: ").unwrap();
    format!("{before}{after}")
}

#[test]
fn the_layout_is_the_stored_one() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/state");
    let cores = cores();
    let mut outlines: Vec<_> =
        cores.iter().map(|(name, core)| (*name, Writer::outline(core))).collect();
    // The configuration, where it has other variants.
    for (name, core) in &cores {
        outlines.push((*name, outline_of("config", core.config())));
    }
    assert_layout(&format!("{folder}/core.txt"), STATE_FORMAT.version, &outlines);

    // Bytes of that version have to remain readable.
    let path = format!("{folder}/core-{}.bin", STATE_FORMAT.version);
    let (_, core) = &cores[4];
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(&path, bytes(core)).unwrap();
    }
    let stored = std::fs::read(&path).unwrap();
    let loaded = Core::load(&stored).unwrap();
    assert_eq!(bytes(&loaded), stored);
    assert_eq!(Writer::outline(&loaded), Writer::outline(core));
}

/// Data that an earlier version lacked can't be made up.
#[test]
fn a_state_of_an_earlier_version_is_refused_in_words() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/state");
    for version in 1..STATE_FORMAT.version {
        let stored = std::fs::read(format!("{folder}/core-{version}.bin")).unwrap();
        assert_eq!(
            Core::load(&stored).unwrap_err().to_string(),
            format!(
                "the state of a calibration core has version {version}, this program reads version {}",
                STATE_FORMAT.version
            )
        );
    }
}

#[test]
fn what_is_wrong_is_said() {
    let (_, core) = &cores()[1];
    let good = bytes(core);
    let said = |bytes: &[u8]| Core::load(bytes).unwrap_err().to_string();
    assert_eq!(
        said(b"OCTCAL"),
        "not the state of a calibration core: it does not begin with OCTANTCC"
    );
    let mut newer = good.clone();
    newer[8] += 1;
    assert_eq!(
        said(&newer),
        format!(
            "the state of a calibration core has version {}, this program reads version {}",
            STATE_FORMAT.version + 1,
            STATE_FORMAT.version
        )
    );
    let cut = &good[..good.len() / 2];
    assert_eq!(
        said(cut),
        format!(
            "the state of a calibration core has {} bytes, {} are expected",
            cut.len(),
            good.len()
        )
    );
    let mut longer = payload(&good).to_vec();
    longer.push(0);
    assert_eq!(said(&reframed(&longer)), "end: 1 byte is left over");
    // The first value of the configuration is the sample period, 20 000 000 ns in four bytes.
    let mut stopped = payload(&good).to_vec();
    stopped.splice(..4, [0]);
    assert_eq!(said(&reframed(&stopped)), "config: sample period is 0 ns, 1 ns to 1 s is expected");
}

static SAVED: LazyLock<Vec<Vec<u8>>> =
    LazyLock::new(|| cores().iter().map(|(_, core)| bytes(core)).collect());

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_altered_bit_and_any_cut_is_refused(
        which in 0..8usize,
        at in any::<prop::sample::Index>(),
        bit in 0..8u8,
    ) {
        let good = &SAVED[which];
        let at = at.index(good.len());
        prop_assert!(Core::load(&good[..at]).is_err());
        let mut altered = good.clone();
        altered[at] ^= 1 << bit;
        let error = Core::load(&altered).unwrap_err();
        prop_assert!(!matches!(error, StateError::Value { .. }), "{error}");
    }

    /// Any bytes with a right checksum are refused, or the core made from them doesn't panic.
    #[test]
    fn nonsense_with_a_right_checksum_does_not_panic(
        which in 0..8usize,
        changes in proptest::collection::vec(
            (any::<prop::sample::Index>(), prop_oneof![any::<u8>(), Just(0xFF), Just(0)]),
            1..12,
        ),
        near_the_start: bool,
        run in 1..9usize,
    ) {
        let good = &SAVED[which];
        let mut altered = payload(good).to_vec();
        // Counts, indices and flags are in the first kilobytes and in the last.
        let length = if near_the_start { altered.len().min(3000) } else { altered.len() };
        for (at, value) in &changes {
            let at = at.index(length);
            let end = (at + run).min(altered.len());
            altered[at..end].fill(*value);
        }
        if let Ok(mut core) = Core::load(&reframed(&altered)) {
            go_on(&mut core, 2_000, 2_300);
            go_on(&mut core, 6_000, 6_060);
            core.end_of_stream();
            let _ = core.diagnostics();
            let _ = core.refusal().map(ToString::to_string);
            let _ = bytes(&core);
        }
    }
}

#[test]
fn the_cores_of_these_tests_are_where_they_should_be() {
    let modes: Vec<_> = cores()
        .iter()
        .map(|(name, core)| {
            let mut core = core.clone();
            (*name, core.end_of_stream().mode)
        })
        .collect();
    println!("{modes:?}");
    assert!(cores()[6].1.table().is_some());
    assert!(cores()[7].1.refusal().is_some());
    assert_eq!(modes[6].1, Mode::Navigating);
    assert_eq!(modes[7].1, Mode::Refused);
}
