//! Posterior standard deviations compared with an independent covariance analysis.

use octant_calibration::config::*;
use octant_calibration::covariance::STATE_COUNT;
use octant_calibration::filter::prior_sigmas;
use octant_calibration::positions::{EIGHT, SIX, from_degrees};
use octant_earth::units::*;
use octant_earth::{Matrix3, UnitQuaternion, Vector3};
use octant_observe::covariance::{predict, state_name};
use octant_sample::Parameters;

fn config(positions: &[(f64, f64, f64)], hours: f64, g_dph_per_g: f64) -> CoreConfig {
    CoreConfig {
        sample_period_ns: 5_000_000,
        site: Site { latitude_rad: 30.5 * DEG, longitude_rad: 0.0, height_m: 0.0 },
        alignment: Alignment::Given {
            q_nb: UnitQuaternion::identity(),
            velocity_mps: Vector3::zeros(),
        },
        calibration: Some(Calibration {
            sequence: from_degrees(positions, 1).unwrap(),
            duration_s: hours * 3600.0,
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
                        g_dph_per_g * DEG_PER_HOUR_PER_G,
                        100.0 * MICRO_G,
                        30.0 * PPM,
                        40.0 * ARCSEC,
                    ],
                },
                aiding: AidingMode::Velocity { sigma_mps: 1e-3 },
                aiding_period_ns: 1_000_000_000,
                sway: SwayNoise::White,
                refuse_above_mean_nis: 9.0,
                further: Default::default(),
                sigma_limits: Default::default(),
            }),
        }),
        navigation: None,
        turntable: TurntableRates { rate_radps: 10.0 * DEG, acceleration_radps2: 10.0 * DEG },
        noise: Noise {
            angle_random_walk: 0.0007 * DEG_PER_SQRT_HOUR,
            velocity_random_walk: 50.0 * MICRO_G,
        },
        initial_parameters: Parameters::default(),
        screening: Screening::none(),
    }
}

#[test]
fn posterior_sigmas_agree_with_the_independent_filter() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/covariance.json");
    let golden: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut worst: f64 = 0.0;
    for row in golden["rows"].as_array().unwrap() {
        let positions = if row["positions"] == "six" { SIX } else { EIGHT };
        let config = config(
            positions,
            row["calibration_h"].as_f64().unwrap(),
            row["g_prior_dph_per_g"].as_f64().unwrap(),
        );
        let Some(Calibration { estimator: Estimator::Kalman(kalman), .. }) = &config.calibration
        else {
            unreachable!()
        };
        let prediction = predict(&config, &Matrix3::identity(), &prior_sigmas(kalman)).unwrap();
        for state in 0..STATE_COUNT {
            let name = state_name(state);
            let expected = row["sigma"][&name].as_f64().unwrap();
            let ratio = prediction.believed.sigma(state) / expected;
            worst = worst.max((ratio - 1.0).abs());
            assert!((ratio - 1.0).abs() < 0.05, "{} {name}: ratio {ratio}", row["positions"]);
            // A filter that models everything achieves the σ that it believes.
            let honest = prediction.achieved.sigma(state) / prediction.believed.sigma(state);
            assert!((honest - 1.0).abs() < 1e-3, "{name}: achieved / believed {honest}");
        }
    }
    println!("largest deviation of a sigma: {:.4} %", 100.0 * worst);
}
