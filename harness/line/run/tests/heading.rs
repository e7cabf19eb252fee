//! Heading tests of a simulated unit, from switching on to the verdict.

use octant_base::control::Control;
use octant_earth::ellipsoid::EARTH_RATE_RADPS;
use octant_run::{StreamKeeping, assemble, run_method};
use octant_scenario::{Method, Scenario};
use octant_score::summary::{HeadingScore, Summary};
use octant_verdict::{Verdict, measures};
use std::path::Path;

/// Runs a shipped heading test with other settings.
fn run(test: &str, set: &[&str]) -> Summary {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/scenarios/heading");
    let set: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    let scenario = Scenario::load(&folder.join(format!("{test}.toml")), &set).unwrap();
    let method = Method::Primary;
    let run =
        run_method(&scenario, method, scenario.seed, StreamKeeping::None, &Control::default());
    assemble(&scenario, scenario.seed, run.unwrap(), None).unwrap().summary
}

#[track_caller]
fn verdict_of(summary: &Summary, id: &str) -> Verdict {
    summary.requirements.iter().find(|result| result.id == id).unwrap().verdict
}

/// A unit that levels the east gyro's rate turns by the bias over the Earth's rate in the horizon: sin ψ = −b / (Ω cos φ).
///
/// Navigation moves the heading on by what is of second order in ψ, 0.03 deg at 2.8 deg and 70 deg of latitude: headings here
/// are off by 1.4 deg at most.
#[test]
fn a_bias_of_the_east_gyro_is_the_settle_point_error_of_its_closed_form() {
    for (latitude_deg, bias_degph) in
        [(0.0, 0.25), (45.0, 0.25), (45.0, -0.15), (70.0, 0.1), (-33.0, -0.15), (-33.0, 0.25)]
    {
        let summary = run(
            "settle",
            &[
                &format!("site.latitude=\"{latitude_deg} deg\""),
                "motion.heading=\"0 deg\"",
                "procedure.heading_test.run_ups=1",
                // No other error of the sensors than the bias.
                "imu.gyro_scale={normal=\"0 ppm\"}",
                "imu.gyro_misalignment={normal=\"0 arcsec\"}",
                "imu.g_dependent={normal=\"0 deg/h/g\"}",
                "imu.accel_bias={normal=\"0 ug\"}",
                "imu.accel_scale={normal=\"0 ppm\"}",
                "imu.accel_misalignment={normal=\"0 arcsec\"}",
                &format!(
                    "imu.gyro_bias={{constant=[\"0 deg/h\",\"{bias_degph} deg/h\",\"0 deg/h\"]}}"
                ),
            ],
        );
        let heading = summary.heading.as_ref().unwrap();
        let horizon_degph =
            EARTH_RATE_RADPS.to_degrees() * 3600.0 * f64::cos(f64::to_radians(latitude_deg));
        let expected = -f64::asin(bias_degph / horizon_degph).to_degrees();
        let found = heading.settle_point_error_deg.unwrap();
        // The noise of the gyros leaves 0.53 arcmin (1σ) at 70 deg after the fine alignment, less elsewhere.
        assert!(
            (found - expected).abs() < 3.0 * 0.53 / 60.0,
            "{latitude_deg}: found {found}, expected {expected}"
        );
        let limit = 0.75 / f64::cos(f64::to_radians(latitude_deg));
        let result = summary.requirements.iter().find(|result| result.id == "A821-4.1.2").unwrap();
        assert_eq!(result.at_equator, Some(0.75));
        assert!((result.limit - limit).abs() < 1e-12, "{} {limit}", result.limit);
        let expected = if expected.abs() > limit { Verdict::Fail } else { Verdict::Pass };
        assert_eq!(result.verdict, expected);
        assert!(result.sentence().contains("0.75 × sec φ"), "{}", result.sentence());
    }
}

#[test]
fn run_ups_are_restarts_with_another_noise_and_the_same_errors() {
    let three = run("settle", &[]).heading.unwrap();
    let one = run("settle", &["procedure.heading_test.run_ups=1"]).heading.unwrap();
    assert_eq!(three.run_ups.len(), 3);
    // The noise of a run with one run-up is another one; the errors of the instrument are the same.
    let first =
        |heading: &HeadingScore| heading.run_ups[0].settle_point.unwrap().error_deg.unwrap();
    assert!((first(&three) - first(&one)).abs() < 0.01, "{three:?} {one:?}");
    let points: Vec<f64> =
        three.run_ups.iter().map(|one| one.settle_point.unwrap().error_deg.unwrap()).collect();
    assert!(points[0] != points[1] && points[1] != points[2], "{points:?}");
    let repeated = three.repeatability_deg.unwrap();
    assert!(repeated > 0.0 && repeated < 0.02, "{repeated}");
    assert_eq!(one.repeatability_deg, None);
}

#[test]
fn a_gap_at_a_reading_leaves_no_value_and_no_verdict() {
    let lost = |at: &str| {
        let fault = format!(
            "faults=[{{id=\"gap\",kind=\"dropout\",trigger={{at=\"{at}\"}},duration=\"4 s\"}}]"
        );
        run("settle", &["procedure.heading_test.run_ups=1", &fault])
    };
    // The first reading is due at 30 min.
    let summary = lost("1798 s");
    assert_eq!(summary.heading.as_ref().unwrap().settling_time_min, None);
    assert_eq!(verdict_of(&summary, "A821-4.1.1"), Verdict::Inconclusive);
    assert_eq!(verdict_of(&summary, "A821-4.1.2"), Verdict::Inconclusive);
    let between = lost("1900 s");
    assert_eq!(between.heading.as_ref().unwrap().settling_time_min, Some(90.0));
    assert_eq!(verdict_of(&between, "A821-4.1.2"), Verdict::Pass);
}

/// A vertical gyro that drifts turns the heading of a navigation by more than 0.7 deg an hour.
#[test]
fn a_unit_that_does_not_settle_fails_if_it_had_the_time() {
    let drifts = "imu.gyro_bias={constant=[\"0 deg/h\",\"0 deg/h\",\"5 deg/h\"]}";
    let one = "procedure.heading_test.run_ups=1";
    let whole = run("settle", &[one, drifts, "procedure.navigation.duration=\"6 h\""]);
    let heading = whole.heading.as_ref().unwrap();
    assert!(!heading.settled, "{heading:?}");
    assert_eq!(heading.settling_time_min, Some(450.0));
    assert_eq!(verdict_of(&whole, "A821-4.1.1"), Verdict::Fail);
    // In two hours nothing is shown.
    let short = run("settle", &[one, drifts, "procedure.navigation.duration=\"1 h\""]);
    assert_eq!(short.heading.as_ref().unwrap().settling_time_min, Some(150.0));
    assert_eq!(verdict_of(&short, "A821-4.1.1"), Verdict::Inconclusive);
}

#[test]
fn a_misaligned_gyro_shows_the_motion_of_the_table_as_a_dynamic_error() {
    let degrees = 2.5;
    let misaligned = format!(
        "imu.gyro_misalignment={{constant=[\"0 deg\",\"0 deg\",\"0 deg\",\"0 deg\",\"{degrees} deg\",\"0 deg\"]}}"
    );
    let summary = run("dynamic", &[&misaligned]);
    let heading = summary.heading.as_ref().unwrap();
    let amplitude = heading.dynamic_amplitude_deg.unwrap();
    // The roll of 20 deg times the angle between the axes, about a drift.
    let roll = 20.0 * f64::to_radians(degrees);
    assert!(amplitude > roll && amplitude < 2.0 * roll, "{amplitude} {roll}");
    // A period of 6 s: the readings of 25 min have a resolution of 1 / 1520 s.
    let frequency = heading.dynamic_frequency_hz.unwrap();
    assert!((frequency - 1.0 / 6.0).abs() < 1.0 / 1520.0, "{frequency}");
    assert_eq!(verdict_of(&summary, "MSC116-4.3.2.3-F"), Verdict::Fail);
}

#[test]
fn the_resolution_of_the_readings_is_a_band_about_the_limit() {
    let summary = run(
        "settle",
        &["procedure.heading_test.run_ups=1", "procedure.heading_test.resolution=\"0.1 deg\""],
    );
    let point = summary.heading.as_ref().unwrap().run_ups[0].settle_point.unwrap();
    assert!((point.heading_deg - 40.0).abs() < 1e-9, "{point:?}");
    let result = summary.requirements.iter().find(|result| result.id == "A821-4.1.2").unwrap();
    assert!((result.uncertainty.unwrap() - 0.05).abs() < 1e-12, "{result:?}");
}

#[test]
fn the_other_shipped_tests_pass_with_their_measures() {
    for (test, measure) in [
        ("settle-in-motion", "heading.in_motion.repeatability_deg"),
        ("scorsby", "heading.scorsby_error_deg"),
        ("dynamic", "heading.dynamic_amplitude_deg"),
    ] {
        let summary = run(test, &[]);
        assert_eq!(summary.verdict, Verdict::Pass, "{test}: {:?}", summary.reasons);
        let document = serde_json::to_value(&summary).unwrap();
        assert!(octant_score::verdict::measure(measure, &document).unwrap().abs() < 0.1);
        assert_eq!(measures::check(measure), Ok(()));
    }
}
