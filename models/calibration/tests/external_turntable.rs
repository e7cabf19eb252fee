//! The external turntable as the reference: all thirty parameters, including the isotropic part of
//! G.

use super::instrument::{ARW, EIGHT, HEADING_RAD, Instrument, SITE, SIX, VRW, truth};
use octant_calibration::config::{ExternalTurntable, Noise};
use octant_calibration::external_turntable::ExternalTurntableEstimator;
use octant_calibration::least_squares::{Adjustment, AdjustmentRefusal};
use octant_earth::Vector3;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::frames::{c_cb, c_nc, quaternion_from_matrix};
use octant_earth::units::{ARCSEC, DEG, DEG_PER_HOUR_PER_G};
use octant_sample::Parameters;
use octant_sample::parameters::{NAMES, ParameterGroup};

fn run(
    instrument: Instrument,
    stops: &[(f64, f64)],
    dwell_s: f64,
    initial: &Parameters,
) -> Result<Adjustment, AdjustmentRefusal> {
    let settings = ExternalTurntable {
        q_nc: quaternion_from_matrix(&c_nc(HEADING_RAD, 0.0, 0.0)),
        encoder_sigma_rad: ARCSEC,
    };
    let noise = Noise { angle_random_walk: ARW, velocity_random_walk: VRW };
    let mut estimator = ExternalTurntableEstimator::new(&settings, &SITE, &noise, initial).unwrap();
    instrument.run(stops, dwell_s, |sample, dt_s, standing| {
        estimator.step(sample, dt_s, standing);
    });
    estimator.finish()
}

#[test]
fn without_noise_all_thirty_parameters_come_back() {
    let truth = truth();
    let instrument = || Instrument::new(truth, 0.0, 0.0, 1);
    let first = run(instrument(), EIGHT, 20.0, &Parameters::default()).unwrap();
    let second = run(instrument(), EIGHT, 20.0, &first.parameters).unwrap();
    // Tolerances in ppm, arcsec and ug, and for G in deg/h/g: second order of the errors in the
    // first pass, encoder counts of 0.0015″ in the second; and the effect of an M_g wrong by that
    // on 15 deg/h.
    for (estimate, tolerance, g_tolerance) in [(&first, 0.1, 1e-5), (&second, 3e-3, 3e-7)] {
        let (found, expected) = (estimate.parameters.to_array(), truth.to_array());
        for i in 0..30 {
            let error = (found[i] - expected[i]).abs() / ParameterGroup::of(i).si_per_unit();
            assert!(error < tolerance, "{}: {error:e}", NAMES[i]);
            if ParameterGroup::of(i) == ParameterGroup::GDependent {
                assert!(error < g_tolerance, "{}: {error:e} deg/h/g", NAMES[i]);
            }
        }
    }
}

#[test]
fn with_noise_the_errors_are_as_large_as_sigma_says() {
    let (mut squares, mut count) = (0.0, 0.0);
    for seed in 1..=10 {
        let truth = truth();
        let mut instrument = Instrument::new(truth, ARW, VRW, seed);
        instrument.encoder_sigma_rad = ARCSEC;
        let estimate = run(instrument, EIGHT, 60.0, &Parameters::default()).unwrap();
        let (found, expected) = (estimate.parameters.to_array(), truth.to_array());
        for i in 0..30 {
            let ratio = (found[i] - expected[i]) / estimate.sigma[i];
            assert!(ratio.abs() < 4.0, "seed {seed}, {}: {ratio} sigma", NAMES[i]);
            squares += ratio * ratio;
            count += 1.0;
        }
    }
    let mean = squares / count;
    println!("mean of the squared errors in sigma {mean:.2}");
    assert!((0.7..1.3).contains(&mean), "{mean}");
}

#[test]
fn in_four_hours_g_is_known_to_what_the_random_walk_allows_isotropic_part_included() {
    let truth = truth();
    let dwell_s = (4.0 * 3600.0 - 20.0 * 9.0) / EIGHT.len() as f64;
    let mut instrument = Instrument::new(truth, ARW, VRW, 7);
    instrument.encoder_sigma_rad = ARCSEC;
    let estimate = run(instrument, EIGHT, dwell_s, &Parameters::default()).unwrap();
    let in_field_units = |sigma: f64| sigma / DEG_PER_HOUR_PER_G;
    for i in 12..21 {
        println!("{} sigma {:.2e} deg/h/g", NAMES[i], in_field_units(estimate.sigma[i]));
    }
    // Closed form: with known attitude each gyro is a regression of white noise q/t on (1, f):
    // the covariance is q (Σ t a a')⁻¹, the same for all three gyros.
    let gravity = Ellipsoid::at(SITE.latitude_rad, SITE.height_m).gravity_mps2;
    let mut information = nalgebra::Matrix4::<f64>::zeros();
    for (azimuth, roll) in EIGHT {
        let force = c_cb(azimuth * DEG, roll * DEG).transpose() * Vector3::new(0.0, 0.0, -gravity);
        let a = nalgebra::Vector4::new(1.0, force.x, force.y, force.z);
        information += a * a.transpose() * (dwell_s / (ARW * ARW));
    }
    let covariance = information.try_inverse().unwrap();
    let widening = estimate.residual_rms.max(1.0);
    for row in 0..3 {
        for column in 0..3 {
            let expected = covariance[(column + 1, column + 1)].sqrt() * widening;
            let found = estimate.sigma[12 + 3 * row + column];
            // 1″ of encoder turns 15 °/h by 7e-5 °/h, against 1.7e-3 °/h of a dwell's noise.
            assert!((found / expected - 1.0).abs() < 0.01, "{found:e}, expected {expected:e}");
        }
    }
    let trace_error = [12, 16, 20]
        .map(|i| estimate.parameters.to_array()[i] - truth.to_array()[i])
        .iter()
        .sum::<f64>();
    println!("error of the trace of G {:.2e} deg/h/g", in_field_units(trace_error));
    assert!(in_field_units(trace_error).abs() < 5e-3);
}

#[test]
fn six_positions_show_all_of_g_on_the_table() {
    // Down is ±x, ±y, ±z in six positions, which is sufficient for a linear G.
    let estimate = run(Instrument::new(truth(), 0.0, 0.0, 1), SIX, 20.0, &Parameters::default());
    assert!(estimate.is_ok(), "{estimate:?}");
}

#[test]
fn too_few_positions_and_missing_encoders_are_refused() {
    let one_gimbal = [(0.0, 0.0), (0.0, 90.0), (0.0, 180.0), (0.0, 0.0)];
    let refused =
        run(Instrument::new(truth(), 0.0, 0.0, 1), &one_gimbal, 20.0, &Parameters::default());
    assert!(matches!(refused, Err(AdjustmentRefusal::Undetermined { .. })), "{refused:?}");

    let settings = ExternalTurntable {
        q_nc: quaternion_from_matrix(&c_nc(HEADING_RAD, 0.0, 0.0)),
        encoder_sigma_rad: ARCSEC,
    };
    let noise = Noise { angle_random_walk: ARW, velocity_random_walk: VRW };
    let initial = Parameters::default();
    let mut estimator =
        ExternalTurntableEstimator::new(&settings, &SITE, &noise, &initial).unwrap();
    Instrument::new(truth(), 0.0, 0.0, 1).run(SIX, 2.0, |sample, dt_s, standing| {
        let mut sample = *sample;
        sample.status |= octant_sample::Status::GIMBAL_INVALID;
        estimator.step(&sample, dt_s, standing);
    });
    assert_eq!(estimator.finish(), Err(AdjustmentRefusal::NoEncoder { interval: 0 }));
}
