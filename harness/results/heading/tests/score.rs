//! All measures of a test together.

use crate::{assert_near, series, with_gap};
use octant_heading::Series;
use octant_heading::score::{HeadingPlan, HeadingScore, HeadingTest};

const HOUR: f64 = 3600.0;

const PLAN: HeadingPlan = HeadingPlan {
    test: HeadingTest::Settle,
    run_up_s: 6.0 * HOUR,
    run_ups: 3,
    motion_s: None,
    resolution_deg: 0.0,
    latitude_deg: 45.0,
};

fn constant(error_deg: f64) -> Series {
    series(1.0, 6.0 * HOUR, |_| 359.8 + error_deg, |_| 359.8)
}

#[test]
fn values_of_several_run_ups_are_the_worst_and_their_difference() {
    let all = [constant(0.1), constant(-0.3), constant(0.25)];
    let score = HeadingScore::of(&PLAN, &all);
    assert_near(score.settle_point_error_deg.unwrap(), -0.3, 1e-12);
    assert_near(score.settle_point_heading_deg.unwrap(), 359.9, 1e-12);
    assert_near(score.repeatability_deg.unwrap(), 0.55, 1e-12);
    assert_eq!(score.settling_time_min, Some(90.0));
    assert!(score.settled && !score.is_unsettled("heading.settling_time_min"));
    assert_eq!(score.in_motion, None);
}

#[test]
fn a_run_up_that_is_missing_leaves_no_value() {
    let score = HeadingScore::of(&PLAN, &[constant(0.1), constant(0.1)]);
    assert_eq!(score.run_ups.len(), 3);
    assert_eq!((score.settling_time_min, score.settle_point_error_deg), (None, None));
    assert_eq!(score.repeatability_deg, None);
    // One of them with a gap at a reading.
    let gap = with_gap(&constant(0.1), 5400.0 + 1190.0, 5400.0 + 1210.0);
    let score = HeadingScore::of(&PLAN, &[constant(0.1), gap, constant(0.1)]);
    assert_eq!(score.settling_time_min, Some(90.0));
    assert_eq!((score.settle_point_error_deg, score.repeatability_deg), (None, None));
}

#[test]
fn one_run_up_has_no_repeatability() {
    let plan = HeadingPlan { run_ups: 1, ..PLAN };
    assert_eq!(HeadingScore::of(&plan, &[constant(0.1)]).repeatability_deg, None);
}

#[test]
fn a_drifting_unit_is_not_settled_and_has_no_settle_point() {
    let plan = HeadingPlan { run_ups: 1, ..PLAN };
    let drifting = series(1.0, 6.0 * HOUR, |t_s| 2.0 * t_s / HOUR, |_| 0.0);
    let score = HeadingScore::of(&plan, &[drifting]);
    assert_eq!(score.settling_time_min, Some(390.0));
    assert!(!score.settled && score.is_unsettled("heading.settling_time_min"));
    assert_eq!(score.settle_point_error_deg, None);
}

#[test]
fn in_motion_and_after_it_are_apart() {
    let plan = HeadingPlan {
        test: HeadingTest::SettleInMotion,
        run_up_s: 9.0 * HOUR,
        run_ups: 2,
        motion_s: Some([0.0, 5.5 * HOUR]),
        ..PLAN
    };
    let run_up = |moving: f64, after: f64| {
        series(1.0, 9.0 * HOUR, move |t_s| if t_s < 5.5 * HOUR { moving } else { after }, |_| 0.0)
    };
    let score = HeadingScore::of(&plan, &[run_up(0.4, 0.1), run_up(-0.2, 0.15)]);
    let moving = score.in_motion.unwrap();
    assert_eq!(moving.settling_time_min, Some(90.0));
    assert_near(moving.settle_point_error_deg.unwrap(), 0.4, 1e-12);
    assert_near(moving.repeatability_deg.unwrap(), 0.6, 1e-12);
    let after = score.after_motion.unwrap();
    assert_near(after.settle_point_error_deg.unwrap(), 0.15, 1e-12);
    assert_near(after.repeatability_deg.unwrap(), 0.05, 1e-12);
    // At rest nothing was measured.
    assert_eq!((score.settling_time_min, score.settle_point_error_deg), (None, None));
}

#[test]
fn readings_at_rest_end_where_the_motion_begins() {
    let at = |from_s: f64| {
        let motion_s = Some([from_s, from_s + 1520.0]);
        let plan = HeadingPlan { test: HeadingTest::Scorsby, run_ups: 1, motion_s, ..PLAN };
        HeadingScore::of(&plan, &[constant(0.2)])
    };
    // 90 min to settle, and ten readings of 20 min.
    let enough = at(17_400.0);
    assert_near(enough.settle_point_error_deg.unwrap(), 0.2, 1e-12);
    assert_near(enough.scorsby_error_deg.unwrap(), 0.0, 1e-12);
    let short = at(17_399.0);
    assert_eq!(short.settling_time_min, Some(90.0));
    assert_eq!((short.settle_point_error_deg, short.scorsby_error_deg), (None, None));
}

#[test]
fn the_resolution_is_an_uncertainty() {
    let plan = HeadingPlan { resolution_deg: 0.1, ..PLAN };
    let score = HeadingScore::of(&plan, &[]);
    for (measure, expected) in [
        ("heading.settle_point_error_deg", 0.05),
        ("heading.in_motion.settle_point_error_deg", 0.05),
        ("heading.repeatability_deg", 0.1),
        ("heading.scorsby_error_deg", 0.1),
        ("heading.settling_time_min", 0.0),
        ("navigation.heading_error_arcmin.max", 0.0),
    ] {
        assert_near(score.resolution_error(measure), expected, 1e-15);
    }
}
