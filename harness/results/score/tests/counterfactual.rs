//! A faulted run against its twin.

use octant_sample::{DeviceTime, Health};
use octant_score::counterfactual::{Counterfactual, CounterfactualSide, Shift, counterfactual};
use octant_score::health::Episode;
use octant_score::summary::{CalibrationScore, HealthCounts, NavigationScore, ParameterScore};
use octant_score::trace::RunTrace;
use std::collections::BTreeMap;

fn calibration(estimate: f64, refused: Option<&str>) -> CalibrationScore {
    let score = |estimate, sigma| ParameterScore {
        r#true: None,
        estimate,
        sigma,
        gain: None,
        error: None,
        normalized: None,
        unit: "deg/h".to_owned(),
    };
    CalibrationScore {
        reference: None,
        solution: None,
        positions: "eight".to_owned(),
        estimator: "kalman".to_owned(),
        duration_h: 4.0,
        parameters: [
            ("bg_x".to_owned(), score(estimate, Some(0.5))),
            ("bg_y".to_owned(), score(7.0, Some(0.25))),
            ("g_xx".to_owned(), score(0.0, None)),
        ]
        .into(),
        further: BTreeMap::new(),
        nis_mean: None,
        nis_expected: None,
        rest: None,
        nees: BTreeMap::new(),
        worst_normalized_error: None,
        least_gain: None,
        refused: refused.map(str::to_owned),
        refusal_explained: Vec::new(),
        health: HealthCounts::default(),
        sigma_hours: Vec::new(),
    }
}

fn episode(cause: Health, start_s: u64, end_s: u64) -> Episode {
    let at = |s: u64| DeviceTime::from_ns(s * 1_000_000_000);
    Episode { cause, start: at(start_s), end: at(end_s), epochs: 1 }
}

fn side<'a>(
    c: &'a CalibrationScore,
    episodes: &'a [Episode],
    trace: &'a RunTrace,
) -> CounterfactualSide<'a> {
    CounterfactualSide {
        calibration: Some(c),
        navigation: None,
        episodes,
        trace,
        stream_hash: "abc",
        elapsed_s: 1000.0,
        lacks: None,
    }
}

fn compare(
    faulted: (&CalibrationScore, &[Episode]),
    twin: (&CalibrationScore, &[Episode]),
    onset_s: Option<f64>,
) -> Counterfactual {
    let trace = RunTrace::new();
    counterfactual(
        &side(faulted.0, faulted.1, &trace),
        &side(twin.0, twin.1, &trace),
        &[("f".to_owned(), onset_s)],
        0.005,
        0.5,
        0.0,
    )
}

#[test]
fn a_shift_is_in_sigma_of_the_twin_and_a_silent_one_is_missed() {
    let (faulted, twin) = (calibration(3.0, None), calibration(1.0, None));
    let c = compare((&faulted, &[]), (&twin, &[]), Some(100.0));
    assert_eq!(c.parameters["bg_x"], Shift { shift: 2.0, sigma: 4.0 });
    assert!(!c.parameters.contains_key("g_xx"), "it was not estimated");
    assert_eq!(c.worst_parameter.as_deref(), Some("bg_x"));
    assert!(c.harmful && c.missed && !c.refused);
    assert_eq!(c.faults[0].noticed_by, None);
}

/// A fault that opens σ: 4 σ of the twin are one of those that are published, and a refused calibration publishes none.
#[test]
fn a_shift_is_in_published_sigma_too() {
    let (mut faulted, twin) = (calibration(3.0, None), calibration(1.0, None));
    faulted.parameters.get_mut("bg_x").unwrap().sigma = Some(2.0);
    faulted.parameters.get_mut("bg_y").unwrap().estimate = 7.5;
    let c = compare((&faulted, &[]), (&twin, &[]), None);
    assert_eq!((c.worst_parameter.as_deref(), c.worst_shift_sigma), (Some("bg_x"), Some(4.0)));
    assert_eq!(c.worst_shift_published_sigma, Some(2.0), "that of bg_y: 0.5 over 0.25");
    let refused = CalibrationScore { refused: Some("no".to_owned()), ..faulted };
    let c = compare((&refused, &[]), (&twin, &[]), None);
    assert_eq!((c.worst_shift_sigma, c.worst_shift_published_sigma), (Some(4.0), None));
}

#[test]
fn what_the_twin_reports_too_is_a_false_alarm_and_no_notice() {
    let (faulted, twin) = (calibration(1.0, None), calibration(1.0, None));
    let gap = [episode(Health::GAP, 150, 150)];
    let c = compare((&faulted, &gap), (&twin, &gap), Some(100.0));
    assert_eq!((c.false_alarms, c.faults[0].noticed_by.as_deref()), (1, None));
    let late = [gap[0], episode(Health::GYRO_STUCK, 130, 160)];
    let c = compare((&faulted, &late), (&twin, &gap), Some(129.5));
    assert_eq!(c.faults[0].noticed_by.as_deref(), Some("gyro stuck"));
    assert_eq!((c.faults[0].delay_s, c.faults[0].last_report_s), (Some(0.5), Some(160.0)));
    let c = compare((&faulted, &late), (&twin, &gap), Some(129.995));
    assert_eq!(c.faults[0].delay_s, Some(0.005), "to the nanosecond");
    assert!(c.faults[0].recovered && !c.harmful);
}

#[test]
fn a_refused_calibration_is_not_missed() {
    let (faulted, twin) = (calibration(9.0, Some("no")), calibration(1.0, None));
    let c = compare((&faulted, &[]), (&twin, &[]), Some(100.0));
    assert!(c.refused && c.harmful && !c.missed && !c.faults[0].recovered);
}

#[test]
fn a_calibration_that_is_too_short_is_none() {
    let (mut faulted, twin) = (calibration(9.0, None), calibration(1.0, None));
    let c = compare((&faulted, &[]), (&twin, &[]), Some(100.0));
    assert!(c.missed && !c.unended);
    faulted.duration_h = 0.9 * twin.duration_h;
    let c = compare((&faulted, &[]), (&twin, &[]), Some(100.0));
    assert!(c.unended && c.harmful && !c.missed && !c.faults[0].recovered);
    assert_eq!(c.undetected, 1);
    faulted.refused = Some("no".to_owned());
    assert!(!compare((&faulted, &[]), (&twin, &[]), Some(100.0)).unended);
}

#[test]
fn a_fault_that_never_fired_is_noticed_by_nobody() {
    let (faulted, twin) = (calibration(1.0, None), calibration(1.0, None));
    let stuck = [episode(Health::GYRO_STUCK, 130, 160)];
    let c = compare((&faulted, &stuck), (&twin, &[]), None);
    assert_eq!(c.faults[0].noticed_by, None);
}

/// At 60° WGS 84 has M = 6 383 454 m and N = 6 394 209 m (NIMA TR8350.2, 3rd edition, by its formulas).
#[test]
fn a_difference_of_position_is_measured_on_the_ellipsoid() {
    let navigation: NavigationScore = serde_json::from_value(serde_json::json!({
        "duration_h": 1.0, "height": "held", "slope_window": null, "marks": {}, "series_hours": [],
        "latitude_error_arcmin": { "max": 0.0, "rms": 0.0, "final": 0.0, "slope_per_day": null },
        "longitude_error_arcmin": { "max": 0.0, "rms": 0.0, "final": 0.0, "slope_per_day": null },
        "radial_error_nmi": { "max": 0.25, "rms": 0.0, "final": 0.0, "rate_per_h": 0.0 },
    }))
    .unwrap();
    let calibration = calibration(1.0, None);
    let between = |latitude_rad: f64, longitude_rad: f64| {
        let (mut here, mut there) = (RunTrace::new(), RunTrace::new());
        here.navigation_begins();
        there.navigation_begins();
        here.drift(60.0, latitude_rad + 1e-4, longitude_rad);
        there.drift(60.0, 1e-4, 0.0);
        let [faulted, twin] = [&here, &there].map(|trace| CounterfactualSide {
            navigation: Some(&navigation),
            ..side(&calibration, &[], trace)
        });
        let latitude_rad = std::f64::consts::FRAC_PI_3;
        let found = counterfactual(&faulted, &twin, &[], 0.005, latitude_rad, 0.0);
        found.navigation.unwrap()
    };
    let near = |found: f64, expected: f64| {
        assert!((found / expected - 1.0).abs() < 1e-6, "{found}, expected {expected}");
    };
    let north = between(-1e-3, 0.0);
    near(north.radial_max_nmi, 6_383.453_86 / 1852.0);
    near(north.latitude_max_arcmin, 3.437_746_770_784_939);
    let east = between(0.0, 1e-3);
    near(east.radial_max_nmi, 3_197.104_58 / 1852.0);
    assert_eq!((east.latitude_max_arcmin, east.twin_radial_max_nmi), (0.0, 0.25));
}
