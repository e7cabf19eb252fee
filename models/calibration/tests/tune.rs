//! A core whose gate, reference and limits change while it runs, against closed forms and a twin that is left alone.

use super::state::{after, config, go_on, kalman};
use octant_calibration::Core;
use octant_calibration::config::*;
use octant_calibration::state_machine::{CalibrationRefusal, CoreConfigError};
use octant_sample::Mode;

/// Sample of the first measurement after [`BEFORE`]; the reference comes with every fiftieth.
const BEFORE: usize = 1010;
const MEASURED: usize = 1050;

fn hardened() -> CoreConfig {
    config(kalman(), Screening::hardened(Base::Still))
}

fn with(config: &CoreConfig, change: impl FnOnce(&mut Kalman, &mut Screening)) -> CoreConfig {
    let mut config = config.clone();
    let calibration = config.calibration.as_mut().unwrap();
    let Estimator::Kalman(kalman) = &mut calibration.estimator else { panic!("no filter") };
    change(kalman, &mut config.screening);
    config
}

fn bytes(core: &Core) -> Vec<u8> {
    let mut bytes = Vec::new();
    core.save(&mut bytes);
    bytes
}

/// The innovation is that of the filter before; its variance is H P Hᵀ + R, of which only R is another.
#[test]
fn the_noise_of_the_reference_acts_from_the_next_measurement_on() {
    let (old, new) = (1e-3, 4e-3);
    let mut core = after(&hardened(), BEFORE);
    let mut twin = core.clone();
    core.tune(&with(&hardened(), |kalman, _| {
        kalman.aiding = AidingMode::Velocity { sigma_mps: new }
    }))
    .unwrap();
    go_on(&mut core, BEFORE, MEASURED - 1);
    go_on(&mut twin, BEFORE, MEASURED - 1);
    assert_eq!(core.latest().navigation, twin.latest().navigation, "nothing was measured yet");
    go_on(&mut core, MEASURED - 1, MEASURED);
    go_on(&mut twin, MEASURED - 1, MEASURED);
    let (with, without) = (core.innovation(), twin.innovation());
    assert_eq!(with.value, without.value);
    for axis in 0..3 {
        let (s, t) = (with.sigma[axis].powi(2), without.sigma[axis].powi(2));
        assert!(t > old * old);
        assert!((s - t - (new * new - old * old)).abs() < 1e-12 * s, "{axis}: {s:e} {t:e}");
    }
    assert_ne!(core.latest().navigation, twin.latest().navigation);
}

#[test]
fn the_gate_closes_and_opens() {
    let used = |core: &Core| {
        let quality = core.diagnostics().quality;
        (quality.used, quality.rejected)
    };
    let mut core = after(&hardened(), BEFORE);
    assert_eq!(used(&core), (20, 0));
    let gate = |nis, rejections| {
        with(&hardened(), |_, screening| {
            screening.gate = Some(Gate { nis, rejections, recovery: Recovery::Widening });
        })
    };
    core.tune(&gate(1e-12, u32::MAX)).unwrap();
    go_on(&mut core, BEFORE, BEFORE + 150);
    assert_eq!(used(&core), (20, 3));
    core.tune(&with(&hardened(), |_, screening| screening.gate = None)).unwrap();
    go_on(&mut core, BEFORE + 150, BEFORE + 300);
    assert_eq!(used(&core), (23, 3));
    // The state is that of the configuration it has now.
    let mut loaded = Core::load(&bytes(&core)).unwrap();
    go_on(&mut core, BEFORE + 300, BEFORE + 900);
    go_on(&mut loaded, BEFORE + 300, BEFORE + 900);
    assert_eq!(bytes(&core), bytes(&loaded));
}

#[test]
fn a_calibration_is_judged_by_the_limits_at_its_end() {
    let mut short = hardened();
    short.calibration.as_mut().unwrap().duration_s = 250.0;
    let limited = |limit| with(&short, |kalman, _| kalman.refuse_above_mean_nis = limit);
    let mut core = after(&short, BEFORE);
    let mut strict = core.clone();
    // There and back is no change.
    core.tune(&limited(1e-6)).unwrap();
    core.tune(&short).unwrap();
    assert_eq!(bytes(&core), bytes(&after(&short, BEFORE)));
    strict.tune(&limited(1e-6)).unwrap();
    let end = 250 * 50 + 10;
    go_on(&mut core, BEFORE, end);
    go_on(&mut strict, BEFORE, end);
    assert_eq!(core.latest().mode, Mode::Navigating, "{:?}", core.refusal());
    let mean = core.table().unwrap().quality.nis_mean;
    assert_eq!(strict.refusal(), Some(&CalibrationRefusal::Inconsistent { mean, limit: 1e-6 }));
    // And the limit of the drift: any correction is above zero.
    let mut drifting = after(&short, BEFORE);
    drifting.tune(&with(&short, |_, screening| screening.drift_sigmas = Some(1e-9))).unwrap();
    go_on(&mut drifting, BEFORE, end);
    let found = drifting.refusal();
    assert!(matches!(found, Some(CalibrationRefusal::Drift { .. })), "{found:?}");
}

/// A change of a configuration.
type Change = fn(&mut CoreConfig);

#[test]
fn what_can_t_change_is_refused_and_changes_nothing() {
    let mut core = after(&hardened(), BEFORE);
    let before = bytes(&core);
    core.tune(&hardened()).unwrap();
    assert_eq!(bytes(&core), before, "the same configuration");
    let fixed: [(&str, Change); 9] = [
        ("the sample period", |c| c.sample_period_ns /= 2),
        ("the site", |c| c.site.height_m += 1.0),
        ("the noise", |c| c.noise.angle_random_walk *= 2.0),
        ("the turntable", |c| c.turntable.rate_radps *= 2.0),
        ("the calibration", |c| c.calibration.as_mut().unwrap().duration_s += 1.0),
        ("the navigation", |c| c.navigation = None),
        ("an initial parameter", |c| c.initial_parameters.gyro_bias[0] = 1e-9),
        ("a screen", |c| c.screening.jumps = false),
        ("a screen", |c| c.screening.drift_sigmas = None),
    ];
    for (expected, change) in fixed {
        // What could change goes down with it.
        let mut config = with(&hardened(), |kalman, _| kalman.refuse_above_mean_nis = 1.0);
        change(&mut config);
        assert_eq!(core.tune(&config), Err(CoreConfigError::Fixed { part: expected }));
    }
    for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        let config =
            with(&hardened(), |kalman, _| kalman.aiding = AidingMode::Velocity { sigma_mps: bad });
        assert!(matches!(core.tune(&config), Err(CoreConfigError::NotPositive { .. })), "{bad}");
        let config = with(&hardened(), |_, s| s.gate.as_mut().unwrap().nis = bad);
        assert!(matches!(core.tune(&config), Err(CoreConfigError::NotPositive { .. })), "{bad}");
    }
    let config = with(&hardened(), |kalman, _| kalman.refuse_above_mean_nis = f64::NAN);
    assert!(matches!(core.tune(&config), Err(CoreConfigError::NotFinite { .. })));
    assert_eq!(bytes(&core), before);
}
