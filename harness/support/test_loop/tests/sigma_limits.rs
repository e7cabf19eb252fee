//! A calibration that knows too little at its end isn't published.

use octant_calibration::config::*;
use octant_calibration::positions::EIGHT;
use octant_calibration::state_machine::CalibrationRefusal;
use octant_earth::units::*;
use octant_sample::Mode;
use octant_sample::counts::GIMBAL_LSB_RAD;
use octant_test_loop::instrument::InstrumentCase;
use octant_test_loop::plant_and_core::ClosedLoop;

const HZ: u64 = 50;
const SECONDS: u64 = 3600;

/// Calibrates for an hour at rest. `slip_s` before the end the roll gimbal slips by 5°, which its encoder doesn't see.
fn calibrated(limits: SigmaLimits, slip_s: Option<u64>) -> ClosedLoop {
    let case = InstrumentCase { calibration_h: 1.0, ..InstrumentCase::table_1(1, EIGHT) };
    let (mut plant, mut core) = (case.plant(), case.core());
    (plant.sample_period_ns, core.sample_period_ns) = (1_000_000_000 / HZ, 1_000_000_000 / HZ);
    plant.calibration_samples = SECONDS * HZ;
    let Estimator::Kalman(kalman) = &mut core.calibration.as_mut().unwrap().estimator else {
        unreachable!();
    };
    kalman.sigma_limits = limits;
    let mut run = ClosedLoop::new(&plant, &core);
    let from = slip_s.map_or(u64::MAX, |s| (SECONDS - s) * HZ);
    let slip = (5.0 * DEG / GIMBAL_LSB_RAD) as i32;
    while matches!(run.output.mode, Mode::Aligning | Mode::Calibrating) {
        // The table drives to the turned set point by its own profile, and its encoder stays.
        let slipped = if run.output.sequence >= from { slip } else { 0 };
        run.command.target.roll += slipped;
        run.step_altered(|mut sample, aiding| {
            let before = from.saturating_add(1);
            if slipped != 0 && sample.sequence > before {
                sample.gimbal.roll = sample.gimbal.roll.min(0);
            }
            Some((sample, aiding))
        });
    }
    run
}

#[test]
fn a_slip_near_the_end_is_refused_with_what_is_left_of_the_heading() {
    let slipped = calibrated(SigmaLimits::default(), Some(20));
    let Some(&CalibrationRefusal::Uncertain { of, sigma, limit }) = slipped.core.refusal() else {
        panic!("{:?}", slipped.core.refusal());
    };
    // Twice the azimuth of 0.1° that is handed over: 12′.
    assert_eq!(of, UncertainQuantity::Heading);
    assert!((limit / (12.0 * ARCMIN) - 1.0).abs() < 1e-12, "{limit}");
    // A recovery opens 3°.
    assert!((1.0 * DEG..3.1 * DEG).contains(&sigma), "{sigma}");
    let told = slipped.core.refusal().unwrap().to_string();
    assert!(
        told.starts_with("the heading is known to 1") && told.contains("12.000 arcmin"),
        "{told}"
    );

    // Without the limits it is published.
    let wide =
        SigmaLimits { heading_rad: Some(3.2), tilt_rad: Some(3.2), ..SigmaLimits::default() };
    let published = calibrated(wide, Some(20));
    assert_eq!(published.output.mode, Mode::Done, "{:?}", published.core.refusal());
    assert_eq!(published.core.concluded().unwrap().phi[2][2].sqrt().to_bits(), sigma.to_bits());
}

#[test]
fn a_clean_calibration_is_published_and_each_limit_refuses_it() {
    let clean = calibrated(SigmaLimits::default(), None);
    assert_eq!(clean.output.mode, Mode::Done, "{:?}", clean.core.refusal());
    let phi = clean.core.concluded().unwrap().phi;
    let (heading, tilt) = (phi[2][2].sqrt(), phi[0][0].max(phi[1][1]).sqrt());
    let accel_scale = clean.core.sigma()[24..27].iter().fold(0.0, |a: f64, b| a.max(*b));
    let mut parameters = [None; 7];
    parameters[5] = Some(0.99 * accel_scale);
    let limits = [
        (
            SigmaLimits { heading_rad: Some(0.99 * heading), ..Default::default() },
            "the heading",
            heading,
        ),
        (SigmaLimits { tilt_rad: Some(0.99 * tilt), ..Default::default() }, "the tilt", tilt),
        (SigmaLimits { parameters, ..Default::default() }, "accel_scale", accel_scale),
    ];
    for (limits, name, expected) in limits {
        let refused = calibrated(limits, None);
        match refused.core.refusal() {
            Some(&CalibrationRefusal::Uncertain { of, sigma, limit }) => {
                assert!(of.name().starts_with(name), "{name}: {of:?}");
                assert!((sigma / expected - 1.0).abs() < 1e-9, "{name}: {sigma}");
                assert!((limit / sigma - 0.99).abs() < 1e-9, "{name}: {limit}");
            }
            other => panic!("{name}: {other:?}"),
        }
    }
}
