//! Titles and charts of the page of trends.

use octant_base::display::DisplayUnits;
use octant_nightly::history::{TrendLine, TrendPoint};
use octant_nightly::trend::{chart, severity, short, title};

#[test]
fn titles_are_words_with_a_unit_and_no_paths() {
    let title = |measure: &str| title(measure, &DisplayUnits::default());
    assert_eq!(
        title("navigation.longitude_error_arcmin.max"),
        "navigation longitude error max, arcmin"
    );
    assert_eq!(
        title("navigation.radial_error_nmi.rate_per_h"),
        "navigation radial error rate, nmi/h"
    );
    assert_eq!(
        title("|calibration.parameters.g_zz.error|"),
        "calibration parameters g zz error, deg/h/g"
    );
    assert_eq!(
        title("calibration.parameters.gyro_bias.error_rms"),
        "calibration parameters gyro bias error rms, deg/h"
    );
    assert_eq!(title("passes of NAV-1"), "passes of NAV-1");
    assert_eq!(title("margin of NAV-1"), "margin of NAV-1, in the unit of its measure");
    assert_eq!(short("fixtures/campaigns/certification.toml"), "certification");
    assert_eq!(short("suite"), "suite");
}

#[test]
fn titles_and_values_have_the_units_that_are_chosen() {
    let units = DisplayUnits::default().with("deg,kn".parse().unwrap());
    for (measure, expected) in [
        ("navigation.heading_error_arcmin.rms", "navigation heading error rms, deg"),
        ("navigation.velocity_north_error_mps.rms", "navigation velocity north error rms, kn"),
        ("navigation.longitude_error_arcmin.max", "navigation longitude error max, arcmin"),
        ("calibration.worst_normalized_error", "calibration worst normalized error, σ"),
    ] {
        assert_eq!(title(measure, &units), expected);
    }
    let line = |measure: &str, median: f64, p95: f64| TrendLine {
        campaign: String::new(),
        scenario: String::new(),
        measure: measure.to_owned(),
        points: vec![TrendPoint { night: 0, median, p95, change: String::new() }],
    };
    let shown =
        |measure, median, p95| chart(&line(measure, median, p95), None, &units).into_string();
    // 90′ are 1.5°; 1852 m in an hour are a knot.
    let heading = shown("navigation.heading_error_arcmin.rms", 90.0, 180.0);
    assert!(heading.contains("median 1.500, 95th percentile 3.000, in one night"), "{heading}");
    let velocity = shown("navigation.velocity_east_error_mps.rms", 1852.0 / 3600.0, 5.0);
    assert!(velocity.contains("median 1.000, 95th percentile 9.719,"), "{velocity}");
    let longitude = shown("navigation.longitude_error_arcmin.rms", 2.0, 3.0);
    assert!(longitude.contains("median 2.000, 95th percentile 3.000,"), "{longitude}");
}

#[test]
fn a_line_that_got_worse_comes_first() {
    let line = |changes: &[&str]| TrendLine {
        campaign: String::new(),
        scenario: String::new(),
        measure: String::new(),
        points: changes
            .iter()
            .enumerate()
            .map(|(night, change)| TrendPoint {
                night,
                median: 1.0,
                p95: 2.0,
                change: (*change).to_owned(),
            })
            .collect(),
    };
    assert_eq!(severity(&line(&["", "worse"])), 2);
    assert_eq!(severity(&line(&["worse", ""])), 1);
    assert_eq!(severity(&line(&["", "better"])), 0);
}
