//! The list of measures, and the check of paths.

use octant_verdict::measures::{MeasureNeed, all, check, unasked};
use std::collections::BTreeSet;

/// Every path that the check accepts, found by asking it for the keys of each place.
fn accepted(place: &str, found: &mut Vec<String>) {
    let error = check(&format!("{place}no_such_name")).unwrap_err();
    for key in error.keys {
        let path = format!("{place}{key}");
        match check(&path) {
            Ok(()) => found.push(path),
            Err(_) => accepted(&format!("{path}."), found),
        }
    }
}

#[test]
fn all_that_is_listed_is_accepted_and_all_that_is_accepted_is_listed() {
    let listed: Vec<String> = all().into_iter().map(|entry| entry.measure).collect();
    let mut found = Vec::new();
    accepted("", &mut found);
    assert_eq!(listed, found);
    let once: BTreeSet<&String> = listed.iter().collect();
    assert_eq!(once.len(), listed.len());
    // 30 parameters with six numbers, of two methods, are 360 of them.
    let parameters = |path: &&String| path.contains("calibration.parameters.");
    assert_eq!(listed.iter().filter(parameters).count(), 360);
}

#[test]
fn an_entry_has_what_its_path_says() {
    let all = all();
    let entry = |path: &str| all.iter().find(|entry| entry.measure == path).unwrap();
    let slope = entry("baseline.navigation.longitude_error_arcmin.slope_per_day");
    assert_eq!((slope.unit, slope.signed), ("arcmin/day", true));
    assert_eq!(
        slope.needs,
        [
            MeasureNeed::Navigation,
            MeasureNeed::Truth,
            MeasureNeed::SchulerPeriod,
            MeasureNeed::Baseline
        ]
    );
    assert!(slope.meaning.starts_with("second method: navigation: longitude error"));
    let error = entry("calibration.parameters.g_zz.error");
    assert_eq!((error.unit, error.signed), ("deg/h/g", true));
    assert_eq!(error.needs, [MeasureNeed::Calibration, MeasureNeed::Truth]);
    assert!(error.meaning.contains("g_zz"), "{}", error.meaning);
    let nis = entry("calibration.nis_mean");
    assert_eq!((nis.unit, nis.signed), ("1", false));
    for entry in &all {
        assert!(!entry.meaning.is_empty() && !entry.meaning.ends_with(": "), "{entry:?}");
        assert!(!entry.needs.windows(2).any(|pair| pair[0] >= pair[1]), "{entry:?}");
    }
}

/// The names of the summary end in their units: each number whose name does has that unit.
#[test]
fn units_are_those_of_the_names() {
    const ENDS: [(&str, &str); 9] = [
        ("_arcmin", "arcmin"),
        ("_nmi", "nmi"),
        ("_mps", "m/s"),
        ("_deg", "deg"),
        ("_us", "us"),
        ("_ppm", "ppm"),
        ("_min", "min"),
        ("_h", "h"),
        ("_s", "s"),
    ];
    let mut checked = 0;
    for entry in all() {
        let parts: Vec<&str> = entry.measure.split('.').rev().collect();
        let named =
            |part: &&str| ENDS.iter().find(|(end, _)| part.ends_with(end)).map(|(_, unit)| *unit);
        let expected = match parts.as_slice() {
            ["normalized", ..] => "1".to_owned(),
            ["slope_per_day", of, ..] => format!("{}/day", named(of).unwrap()),
            ["rate_per_h", of, ..] => format!("{}/h", named(of).unwrap()),
            [last, of, ..] => match named(last).or_else(|| named(of)) {
                Some(unit) => unit.to_owned(),
                None => continue,
            },
            [_] => "1".to_owned(),
            [] => unreachable!(),
        };
        assert_eq!(entry.unit, expected, "{}", entry.measure);
        checked += 1;
    }
    assert!(checked > 150, "{checked}");
}

#[test]
fn a_path_that_leads_nowhere_is_told_with_the_keys_there() {
    let error = |path| check(path).unwrap_err();
    assert_eq!(error("navigation").part, None);
    assert_eq!(error("navigation.radial_error_nmi").keys, ["max", "rms", "final", "rate_per_h"]);
    let unknown = error("navigation.radial_error_nmi.least");
    assert_eq!(
        (unknown.place.as_str(), unknown.part.as_deref()),
        ("navigation.radial_error_nmi", Some("least"))
    );
    let beyond = error("calibration.nis_mean.max");
    assert_eq!((beyond.place.as_str(), beyond.keys.len()), ("calibration.nis_mean", 0));
    assert_eq!(error("nothing").place, "the summary");
}

#[test]
fn a_set_that_lacks_a_kind_is_told_which() {
    let lacks = |measures: &[&str]| -> Vec<&str> {
        unasked(measures.iter().copied()).iter().map(|kind| kind.measure).collect()
    };
    let radial = "navigation.radial_error_nmi.max";
    let all = ["calibration.worst_normalized_error", "calibration.least_gain", "false_alarms"];
    assert_eq!(lacks(&[radial]), all);
    assert_eq!(lacks(&[radial, all[0], all[1], all[2]]), [""; 0]);
    let others = [
        "calibration.nees.gyro_bias",
        "|calibration.parameters.g_zz.sigma|",
        "calibration.health.rejected",
    ];
    assert_eq!(lacks(&others), [""; 0]);
    assert_eq!(lacks(&[radial, "calibration.parameters.g_zz.gain"]), [all[0], all[2]]);
    // A heading test, and what isn't tested, have no calibration to ask about.
    assert_eq!(lacks(&["heading.settling_time_min"]), [""; 0]);
    assert_eq!(lacks(&[]), [""; 0]);
    for measure in all {
        assert!(check(measure).is_ok());
    }
}
