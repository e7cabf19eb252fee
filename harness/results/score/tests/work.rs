//! Work planned and done.

use octant_score::work::{RunPart, Work};

const PLAN: Work = Work {
    stops: Some(8),
    calibration_s: Some(14_400.0),
    references: Some(14_400),
    navigation_s: Some(86_400.0),
};

fn texts(done: &Work) -> Vec<String> {
    PLAN.short_of(done).into_iter().map(|short| short.text).collect()
}

#[test]
fn what_is_done_as_planned_falls_short_of_nothing() {
    assert!(texts(&PLAN).is_empty());
    let late = Work { calibration_s: Some(14_399.5), references: Some(14_300), ..PLAN };
    assert!(texts(&late).is_empty());
    // Unknown numbers of stops and references are no shortfall, and neither is unplanned work.
    assert!(texts(&Work { stops: None, references: None, ..PLAN }).is_empty());
    assert!(Work::default().short_of(&Work::default()).is_empty());
}

#[test]
fn each_shortfall_is_told_with_plan_and_done() {
    for (done, text) in [
        (Work { navigation_s: Some(1.0), ..PLAN }, "navigation: planned 24 h, done 1 s"),
        (Work { navigation_s: None, ..PLAN }, "navigation: planned 24 h, done 0 s"),
        (Work { navigation_s: Some(f64::NAN), ..PLAN }, "navigation: planned 24 h, done – s"),
        (Work { calibration_s: Some(3522.0), ..PLAN }, "calibration: planned 4 h, done 3522 s"),
        (Work { stops: Some(3), ..PLAN }, "stops of the calibration: planned 8, done 3"),
        (
            Work { references: Some(200), ..PLAN },
            "references for the calibration: planned 14400, done 200",
        ),
    ] {
        assert_eq!(texts(&done), [text]);
    }
    // A short plan tolerates only a small shortfall.
    let plan = Work { navigation_s: Some(10.0), ..Work::default() };
    assert_eq!(plan.short_of(&Work { navigation_s: Some(9.5), ..plan }).len(), 1);
}

#[test]
fn a_measure_belongs_to_its_part() {
    for (path, part) in [
        ("navigation.longitude_error_arcmin.max", Some(RunPart::Navigation)),
        ("|baseline.navigation.latitude_error_arcmin.final|", Some(RunPart::Navigation)),
        ("counterfactual.navigation.radial_max_nmi", Some(RunPart::Navigation)),
        ("|calibration.parameters.g_zz.error|", Some(RunPart::Calibration)),
        ("counterfactual.parameters.g_zz.shift", Some(RunPart::Calibration)),
        ("pacing.overruns", None),
    ] {
        assert_eq!(RunPart::of(path), part, "{path}");
    }
}
