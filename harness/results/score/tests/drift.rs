//! Scores compared with closed forms and golden numbers.

use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_earth::units::{
    ARCMIN, ARCSEC, DEG, DEG_PER_HOUR, DEG_PER_HOUR_PER_G, DEG_PER_SQRT_HOUR, MICRO_G,
};
use octant_score::drift::{DriftError, DriftSample, DriftScorer};
use octant_score::floor::Floor;
use octant_score::reference::{isotropic_g_sigma, vertical_drift};
use octant_score::summary::{HeightChannel, NavigationScore};
use octant_statistics::{paired, position, proportion};
use std::f64::consts::PI;

const LATITUDE: f64 = 30.5 * DEG;

/// Scores `f(t) = [latitude, longitude]` in arcmin, at a step of `dt_s`.
fn scored(hours: f64, dt_s: f64, f: impl Fn(f64) -> [f64; 2]) -> NavigationScore {
    let mut scorer = DriftScorer::new();
    let steps = (hours * 3600.0 / dt_s) as u32;
    for k in 0..=steps {
        let t_s = f64::from(k) * dt_s;
        let [latitude, longitude] = f(t_s);
        scorer.push(&DriftSample {
            t_s,
            position_error_rad: Some([latitude * ARCMIN, longitude * ARCMIN]),
            attitude_error: None,
            velocity_error_mps: None,
            latitude_rad: LATITUDE,
            height_m: 0.0,
        });
    }
    scorer.finish(HeightChannel::Held).unwrap()
}

fn assert_near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found}, expected {expected}");
}

#[test]
fn a_ramp_has_the_scores_of_a_ramp() {
    // 1.2 arcmin of latitude in 24 h. rms of a ramp is its end over √3.
    let n = scored(24.0, 60.0, |t| [1.2 * t / 86_400.0, 0.0]);
    let lat = n.latitude_error_arcmin.unwrap();
    assert_near(lat.max, 1.2, 1e-12);
    assert_near(lat.r#final, 1.2, 1e-12);
    assert_near(lat.rms, 1.2 / 3f64.sqrt(), 1e-9);
    assert_near(lat.slope_per_day.unwrap(), 1.2, 1e-9);
    assert_near(n.longitude_error_arcmin.unwrap().slope_per_day.unwrap(), 0.0, 1e-12);
    // 1.2 arcmin along the meridian: R_M(30.5°) = 6351862.351 m (golden), 1852 m a mile.
    let nmi = 1.2 / 60.0 * PI / 180.0 * 6_351_862.351_147_001 / 1852.0;
    assert_near(n.radial_error_nmi.unwrap().max, nmi, 1e-9);
    assert_near(n.radial_error_nmi.unwrap().rate_per_h, nmi / 24.0, 1e-10);
    assert_near(n.radial_error_nmi.unwrap().rms, nmi / 3f64.sqrt(), 1e-9);
}

#[test]
fn longitude_counts_by_the_cosine_of_latitude_in_distance() {
    let n = scored(2.0, 1.0, |_| [0.0, 3.0]);
    let earth = Ellipsoid::at(LATITUDE, 0.0);
    let nmi = 3.0 * ARCMIN * earth.transverse_radius_m * LATITUDE.cos() / 1852.0;
    assert_near(n.radial_error_nmi.unwrap().max, nmi, 1e-9);
    assert_near(n.radial_error_nmi.unwrap().rms, nmi, 1e-9);
}

#[test]
fn slopes_see_through_schuler_and_earth_oscillations() {
    let schuler = 2.0 * PI / Ellipsoid::at(LATITUDE, 0.0).schuler_period_s();
    for hours in [3.1, 7.0, 23.0, 24.0, 40.0, 72.0] {
        let n = scored(hours, 30.0, |t| {
            let earth =
                if hours > 23.95 { 0.9 * (1.0 - (EARTH_RATE_RADPS * t).cos()) } else { 0.0 };
            [
                0.2 * t / 86_400.0 + 0.5 * (schuler * t + 0.7).sin() + earth,
                -0.365 * t / 86_400.0 + 0.3 * (schuler * t).cos() - earth,
            ]
        });
        assert_near(n.latitude_error_arcmin.unwrap().slope_per_day.unwrap(), 0.2, 1e-6);
        assert_near(n.longitude_error_arcmin.unwrap().slope_per_day.unwrap(), -0.365, 1e-6);
        let window = n.slope_window.unwrap();
        assert_eq!(window.of == "sidereal days", hours > 23.95, "{hours} h: {window:?}");
        assert!(window.hours <= hours);
    }
}

#[test]
fn below_a_schuler_period_there_is_no_slope() {
    let n = scored(1.4, 1.0, |t| [t, t]);
    assert_eq!(n.slope_window, None);
    assert_eq!(n.latitude_error_arcmin.unwrap().slope_per_day, None);
    assert!(scored(1.41, 1.0, |t| [t, t]).slope_window.is_some(), "84.33 min are 1.4055 h");
}

#[test]
fn the_rms_of_whole_periods_of_a_sine_is_its_amplitude_over_root_two() {
    let n = scored(5.0, 10.0, |t| [2.0 * (2.0 * PI * t / 3600.0).sin(), 0.0]);
    assert_near(n.latitude_error_arcmin.unwrap().rms, 2.0 / 2f64.sqrt(), 1e-4);
    assert_near(n.latitude_error_arcmin.unwrap().max, 2.0, 1e-4);
}

#[test]
fn marks_hold_the_error_there_and_the_largest_before() {
    let n = scored(80.0, 60.0, |t| {
        let h = t / 3600.0;
        [if h < 30.0 { h } else { 60.0 - h }, -h / 10.0]
    });
    let day = &n.marks["24h"];
    assert_near(day.latitude_arcmin, 24.0, 1e-9);
    assert_near(day.latitude_max_arcmin, 24.0, 1e-9);
    assert_near(day.longitude_arcmin, -2.4, 1e-9);
    let three = &n.marks["72h"];
    assert_near(three.latitude_arcmin, -12.0, 1e-9);
    assert_near(three.latitude_max_arcmin, 30.0, 1e-9);
    assert_near(three.longitude_max_arcmin, 7.2, 1e-9);
    assert!(scored(20.0, 60.0, |_| [0.0, 0.0]).marks.is_empty());
}

#[test]
fn what_is_not_a_drift_is_told() {
    let sample = |t_s: f64, latitude_error_rad: f64| DriftSample {
        t_s,
        position_error_rad: Some([latitude_error_rad, 0.0]),
        attitude_error: None,
        velocity_error_mps: None,
        latitude_rad: LATITUDE,
        height_m: 0.0,
    };
    let mut scorer = DriftScorer::new();
    assert_eq!(scorer.finish(HeightChannel::Held), Err(DriftError::Empty));
    scorer.push(&sample(1.0, 0.0));
    scorer.push(&sample(1.0, 0.0));
    assert_eq!(
        scorer.finish(HeightChannel::Held),
        Err(DriftError::Order { sample: 1, t_s: 1.0, previous_s: 1.0 })
    );
    let mut scorer = DriftScorer::new();
    scorer.push(&sample(1.0, 0.0));
    scorer.push(&sample(2.0, f64::NAN));
    scorer.push(&sample(3.0, 0.0));
    assert_eq!(
        scorer.finish(HeightChannel::Held),
        Err(DriftError::NotFinite { sample: 1, t_s: 2.0 })
    );
}

/// Golden row: latitude (deg), error, value, unit, rows of hours, latitude, longitude (arcmin).
type Growth = (f64, String, f64, String, Vec<[f64; 3]>);

fn golden() -> Vec<Growth> {
    let path =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/static_free_inertial.json");
    let text = std::fs::read_to_string(path).unwrap();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    let rows = value["rows"].as_array().unwrap().iter();
    rows.map(|row| {
        let series =
            serde_json::from_value(row["hours_latitude_longitude_arcmin"].clone()).unwrap();
        (
            row["latitude_deg"].as_f64().unwrap(),
            row["error"].as_str().unwrap().to_owned(),
            row["value"].as_f64().unwrap(),
            row["unit"].as_str().unwrap().to_owned(),
            series,
        )
    })
    .collect()
}

#[test]
fn the_error_model_of_the_floor_grows_as_the_golden_one() {
    let mut compared = 0;
    for (latitude_deg, name, value, unit, series) in golden() {
        let si = value
            * match unit.as_str() {
                "deg/h" => DEG_PER_HOUR,
                "ug" => MICRO_G,
                "arcsec" => ARCSEC,
                "m/s" => 1.0,
                other => panic!("unit {other}"),
            };
        let (mut initial, mut error) = ([0.0; 7], [0.0; 5]);
        match name.as_str() {
            "gyro_error_north" => error[0] = si,
            "gyro_error_east" => error[1] = si,
            "gyro_error_down" => error[2] = si,
            "accel_error_north" => error[3] = si,
            "accel_error_east" => error[4] = si,
            "initial_phi_north" => initial[0] = si,
            "initial_phi_east" => initial[1] = si,
            "initial_phi_down" => initial[2] = si,
            "initial_velocity_error_north" => initial[3] = si,
            "initial_velocity_error_east" => initial[4] = si,
            other => panic!("error {other}"),
        }
        let model = Floor::new(latitude_deg * DEG, 0.0, 0.0, 0.0);
        for [hours, latitude, longitude] in series {
            let [dl, dlon] = model.propagate(initial, &error, hours * 3600.0);
            assert_near(dl / ARCMIN, latitude, 1e-6);
            assert_near(dlon / ARCMIN, longitude, 1e-6);
            compared += 1;
        }
    }
    assert_eq!(compared, 240);
}

#[test]
fn vertical_drift_is_the_secular_part_of_the_golden_growth() {
    // A downward gyro error of 0.01 °/h is the remainder of a g_zz of −0.01 °/h over local gravity.
    for (latitude_deg, name, _, _, series) in golden() {
        if name != "gyro_error_down" {
            continue;
        }
        let latitude = latitude_deg * DEG;
        let gravity = Ellipsoid::at(latitude, 0.0).gravity_mps2;
        let drift = vertical_drift(-0.01 * DEG_PER_HOUR / gravity, latitude, 0.0);
        // δλ = rate (t − sin Ωt/Ω) and δL = (bound/2)(1 − cos Ωt); Schuler oscillations of up to
        // 0.03 arcmin are superposed on both.
        for [hours, latitude_arcmin, longitude_arcmin] in series {
            let angle = EARTH_RATE_RADPS * hours * 3600.0;
            let days = (angle - angle.sin()) / EARTH_RATE_RADPS / 86_400.0;
            assert_near(longitude_arcmin, drift.longitude_arcmin_per_day * days, 0.03);
            let latitude = 0.5 * drift.latitude_bound_arcmin * (1.0 - angle.cos());
            assert_near(latitude_arcmin, latitude, 0.03);
        }
    }
}

#[test]
fn table_values_give_the_published_references() {
    let drift = vertical_drift(5e-4 * DEG_PER_HOUR_PER_G, LATITUDE, 0.0);
    assert_near(drift.longitude_arcmin_per_day, 0.365, 5e-4);
    assert_near(drift.latitude_bound_arcmin, 0.197, 5e-4);
    // √12 · 7e-4 °/√h over 15.041 °/h · cos 30.5° · (4 h)^1.5 in radians and hours.
    let arw_rad_per_sqrt_h = 7e-4 * DEG;
    let omega_rad_per_h = 7.292_115e-5 * 3600.0;
    let expected = 12f64.sqrt() * arw_rad_per_sqrt_h / (omega_rad_per_h * LATITUDE.cos() * 8.0);
    let found = isotropic_g_sigma(7e-4 * DEG_PER_SQRT_HOUR, LATITUDE, 0.0, 4.0 * 3600.0);
    let gravity = Ellipsoid::at(LATITUDE, 0.0).gravity_mps2;
    assert_near(found * gravity * 3600.0 / expected, 1.0, 1e-12);
}

#[test]
fn the_floor_of_the_random_walk_is_that_of_an_independent_monte_carlo() {
    // 20 seeds, 7e-4 °/√h and 50 µg/√Hz, 30.5° N: 0.399 / 0.475 at 24 h, 0.870 / 0.949 at 72 h.
    // The root mean square of 20 maxima has a standard error of about 8 %: three of them are 24 %.
    let floor = Floor::new(LATITUDE, 0.0, 7e-4 * DEG_PER_SQRT_HOUR, 50.0 * MICRO_G);
    let maxima = floor.maxima(&[24.0, 72.0], 400, 1);
    for (found, expected) in [
        (maxima[0].latitude_arcmin, 0.399),
        (maxima[0].longitude_arcmin, 0.475),
        (maxima[1].latitude_arcmin, 0.870),
        (maxima[1].longitude_arcmin, 0.949),
    ] {
        assert!((found / expected - 1.0).abs() < 0.24, "found {found}, expected {expected}");
    }
    assert_eq!(maxima, floor.maxima(&[24.0, 72.0], 400, 1));
}

#[test]
fn the_covariance_of_the_floor_is_the_sum_of_its_impulse_responses() {
    // σ²(T) = ∫ Σ h_i(T − s)² N_i² ds over the five noises, by Simpson-like summation of the
    // noise-free model's response to initial φ and δv.
    let (arw, vrw) = (7e-4 * DEG_PER_SQRT_HOUR, 50.0 * MICRO_G);
    let floor = Floor::new(LATITUDE, 0.0, arw, vrw);
    let hours = 6.0;
    let found = floor.summary(hours * 3600.0);
    let (n, dt) = (720u32, hours * 3600.0 / 720.0);
    let mut variance = [0.0; 2];
    for k in 0..n {
        let t = (f64::from(k) + 0.5) * dt;
        for (state, density) in [(0, arw), (1, arw), (2, arw), (3, vrw), (4, vrw)] {
            let mut initial = [0.0; 7];
            initial[state] = 1.0;
            let response = floor.propagate(initial, &[0.0; 5], t);
            for axis in 0..2 {
                variance[axis] += (response[axis] * density).powi(2) * dt;
            }
        }
    }
    assert_near(found.latitude_final_arcmin / (variance[0].sqrt() / ARCMIN), 1.0, 1e-3);
    assert_near(found.longitude_final_arcmin / (variance[1].sqrt() / ARCMIN), 1.0, 1e-3);
}

#[test]
fn zero_failures_in_59_runs_show_95_percent_at_95_percent() {
    assert!(proportion::success_lower_bound(0, 59, 0.95) >= 0.95);
    assert!(proportion::success_lower_bound(0, 58, 0.95) < 0.95);
    // No failure: (1 − confidence)^(1/n). One of ten: the beta quantile, 0.6058 (tables).
    assert_near(proportion::success_lower_bound(0, 20, 0.9), 0.1f64.powf(0.05), 1e-9);
    assert_near(proportion::success_lower_bound(1, 10, 0.95), 0.6058, 1e-4);
    assert_near(proportion::success_upper_bound(10, 10, 0.95), 1.0 - 0.05f64.powf(0.1), 1e-9);
    assert_eq!(proportion::success_lower_bound(3, 3, 0.95), 0.0);
    assert_eq!(proportion::success_upper_bound(0, 10, 0.95), 1.0);
}

#[test]
fn position_statistics_of_a_known_ensemble() {
    // 3-4-5 triangles of growing size: radial errors 5, 10, … 100.
    let errors: Vec<[f64; 2]> =
        (1..=20).map(|k| [3.0 * f64::from(k), 4.0 * f64::from(k)]).collect();
    let s = position::position_statistics(&errors).unwrap();
    // Mean of k² for 20 is 143.5.
    assert_near(s.drms, 5.0 * 143.5f64.sqrt(), 1e-9);
    assert_near(s.cep50_gaussian, 0.5887 * 7.0 * 143.5f64.sqrt(), 1e-9);
    assert_near(s.cep50_empirical, 52.5, 1e-12);
    assert_near(s.r95, 95.25, 1e-12);
    assert_eq!(position::position_statistics(&[]), None);
}

#[test]
fn an_improvement_is_of_pairs_and_inside_its_interval() {
    let first: Vec<f64> = (0..20).map(|k| 1.0 + 0.1 * f64::from(k % 7)).collect();
    let half: Vec<f64> = first.iter().map(|x| 0.5 * x).collect();
    let i = paired::improvement(&first, &half, 0.9).unwrap();
    assert_near(i.value, 0.5, 1e-12);
    // Pairs in a fixed ratio have no random part, because the comparison is paired.
    assert_near(i.low, 0.5, 1e-12);
    assert_near(i.high, 0.5, 1e-12);
    let noisy: Vec<f64> = (0..20).map(|k| 0.4 + 0.3 * f64::from((k * 5) % 11) / 10.0).collect();
    let a = paired::improvement(&first, &noisy, 0.9).unwrap();
    assert!(a.low < a.value && a.value < a.high, "{a:?}");
    let wider = paired::improvement(&first, &noisy, 0.99).unwrap();
    assert!(wider.low < a.low && a.high < wider.high, "{a:?} {wider:?}");
    assert_eq!(paired::improvement(&first, &noisy[1..], 0.9), None);
    assert_eq!(paired::improvement(&[0.0, 0.0], &[1.0, 1.0], 0.9), None);
}
