//! Gaps of a solution: bounds compared with closed forms, and the verdicts that follow.

use crate::common::{requirement, summary};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCMIN, DEG};
use octant_score::drift::{DriftSample, DriftScorer};
use octant_score::judge::{derive, judge, judge_by};
use octant_score::summary::{HeightChannel, NavigationScore, Summary};
use octant_verdict::{Comparison, Verdict};
use std::f64::consts::PI;

const LATITUDE: f64 = 45.0 * DEG;

/// Scores an error of latitude, m, with its velocity, m/s, once a second where `there` says so.
fn scored(
    hours: f64,
    error: impl Fn(f64) -> [f64; 2],
    there: impl Fn(f64) -> bool,
) -> NavigationScore {
    let earth = Ellipsoid::at(LATITUDE, 0.0);
    let mut scorer = DriftScorer::with_gaps(1.0);
    for second in (0..=(hours * 3600.0) as u32).map(f64::from).filter(|t| there(*t)) {
        let [position_m, velocity_mps] = error(second);
        scorer.push(&DriftSample {
            t_s: second,
            position_error_rad: Some([position_m / earth.meridian_radius_m, 0.0]),
            attitude_error: None,
            velocity_error_mps: Some([velocity_mps, 0.0]),
            latitude_rad: LATITUDE,
            height_m: 0.0,
        });
    }
    scorer.finish(HeightChannel::Held).unwrap()
}

fn bound(navigation: &NavigationScore, score: &str) -> Option<f64> {
    navigation.gaps.as_ref().unwrap().bounds[score]
}

fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "found {found}, expected {expected}");
}

#[test]
fn a_short_gap_is_bridged_by_the_velocity_that_the_run_shows() {
    // A steady 0.5 m/s for an hour, and 40 s without points at 2000 s: within 20 s of the ends the error moves 10 m, and by
    // a Schuler oscillation of that velocity, twice as strong, another ω V 20²: g = 9.806 m/s² at 45° makes
    // ω = sqrt(g / R) = 1.2409e-3 rad/s.
    let there = |t: f64| t <= 2000.0 || t >= 2040.0;
    let n = scored(1.0, |t| [0.5 * t, 0.5], there);
    let gaps = n.gaps.as_ref().unwrap();
    assert_eq!((gaps.count, gaps.total_s, gaps.longest_s), (1, 40.0, [2000.0, 40.0]));
    let arcmin_m = Ellipsoid::at(LATITUDE, 0.0).meridian_radius_m * ARCMIN;
    // The largest error is that at the end, 1800 m, above all that the gap may hide.
    near(bound(&n, "latitude_error_arcmin.max").unwrap(), 1800.0 / arcmin_m, 1e-9);
    // Up to the gap nothing was as large: the end of the gap at 1020 m, and twice the range over two blocks of 32 s, 63 s of
    // motion: more than V L/2 + a (L/2)²/2 = 10.2 m.
    let short = scored(2045.0 / 3600.0, |t| [0.5 * t, 0.5], there);
    let found_m = bound(&short, "latitude_error_arcmin.max").unwrap() * arcmin_m;
    near(found_m, 1020.0 + 2.0 * 63.0 * 0.5, 0.6);
    assert_eq!(scored(1.0, |t| [0.5 * t, 0.5], |_| true).gaps, None);
}

#[test]
fn the_schuler_bound_holds_where_the_run_shows_less() {
    // An error that stands still in position and has a velocity of 3 m/s by the unit's own word.
    let n = scored(1.0, |_| [100.0, 3.0], |t| t <= 2000.0 || t >= 2040.0);
    let omega = 2.0 * PI / Ellipsoid::at(LATITUDE, 0.0).schuler_period_s();
    let arcmin_m = Ellipsoid::at(LATITUDE, 0.0).meridian_radius_m * ARCMIN;
    let expected_m = 100.0 + 3.0 * 20.0 + 0.5 * (2.0 * omega * 3.0) * 400.0;
    near(bound(&n, "latitude_error_arcmin.max").unwrap() * arcmin_m, expected_m, 1e-6);
    near(bound(&n, "radial_error_nmi.max").unwrap() * 1852.0, expected_m, 1e-6);
    // rms² of 100 m, and 40 s of the bound in an hour.
    let rms_m = (100.0_f64.powi(2) + 40.0 / 3600.0 * expected_m * expected_m).sqrt();
    near(bound(&n, "latitude_error_arcmin.rms").unwrap() * arcmin_m, rms_m, 1e-6);
    let velocity = bound(&n, "velocity_north_error_mps.max").unwrap();
    near(velocity, 3.0 + 2.0 * omega * 3.0 * 20.0, 1e-9);
}

#[test]
fn a_bridge_holds_over_errors_that_it_hides() {
    // Schuler oscillations of many phases: what happens in the gap is never above its bound.
    let omega = 2.0 * PI / Ellipsoid::at(LATITUDE, 0.0).schuler_period_s();
    let arcmin_m = Ellipsoid::at(LATITUDE, 0.0).meridian_radius_m * ARCMIN;
    for phase in 0..48 {
        let phase = 2.0 * PI * f64::from(phase) / 48.0;
        for length_s in [2.0, 7.0, 30.0, 60.0] {
            let error = |t: f64| {
                let angle = omega * t + phase;
                [0.4 / omega * angle.sin(), 0.4 * angle.cos()]
            };
            let n = scored(1.0, error, |t| t <= 1500.0 || t >= 1500.0 + length_s);
            let within = (0..=100).map(|k| error(1500.0 + length_s * f64::from(k) / 100.0)[0]);
            let hidden_m = within.map(f64::abs).fold(0.0, f64::max);
            let bound_m = bound(&n, "latitude_error_arcmin.max").unwrap() * arcmin_m;
            assert!(bound_m >= hidden_m, "{phase} {length_s}: {bound_m} {hidden_m}");
        }
    }
}

#[test]
fn gaps_that_are_long_or_beside_little_have_no_bound() {
    let still = |_: f64| [100.0, 0.0];
    for (hours, from_s, length_s) in [(24.0, 36_000.0, 61.0), (0.25, 400.0, 50.0)] {
        let n = scored(hours, still, |t| t <= from_s || t >= from_s + length_s);
        assert_eq!(bound(&n, "latitude_error_arcmin.max"), None, "{length_s} s in {hours} h");
        assert_eq!(bound(&n, "latitude_error_arcmin.rms"), None);
    }
    // A gap after a mark leaves the maximum up to it alone; one at the mark doesn't.
    let n = scored(25.0, still, |t| t <= 86_500.0 || t >= 86_700.0);
    assert!(!n.gaps.as_ref().unwrap().bounds.contains_key("marks.24h.latitude_max_arcmin"));
    let n = scored(25.0, still, |t| t <= 86_300.0 || t >= 86_500.0);
    assert_eq!(bound(&n, "marks.24h.latitude_max_arcmin"), None);
    assert_eq!(bound(&n, "marks.24h.latitude_arcmin"), None);
}

#[test]
fn every_second_point_of_a_part_is_bridged() {
    // 14 min at half the rate: 420 gaps of 2 s, of which each hides a second of motion.
    let sub = |t: f64| !(3600.0..4440.0).contains(&t) || t % 2.0 == 0.0;
    let n = scored(2.0, |t| [0.2 * t, 0.2], sub);
    let gaps = n.gaps.as_ref().unwrap();
    assert_eq!((gaps.count, gaps.total_s), (420, 840.0));
    let arcmin_m = Ellipsoid::at(LATITUDE, 0.0).meridian_radius_m * ARCMIN;
    near(bound(&n, "latitude_error_arcmin.max").unwrap() * arcmin_m, 1440.0, 1e-6);
}

#[test]
fn a_limit_holds_only_if_it_holds_in_the_gaps() {
    let error = |_: f64| [100.0, 3.0];
    let navigation = |length_s: f64| scored(1.0, error, |t| t <= 2000.0 || t >= 2000.0 + length_s);
    // 100 m are 0.0540 nmi; with a gap of 40 s 163 m or 0.0880 nmi may be hidden.
    let verdict = |length_s: f64, limit: f64, uncertainty: f64| {
        let mut judged = Summary { navigation: Some(navigation(length_s)), ..summary() };
        let asked = requirement("navigation.radial_error_nmi.max", Comparison::AtMost, limit);
        let known = |_: &str| Ok::<_, String>(uncertainty);
        judge_by(&mut judged, std::slice::from_ref(&asked), &[], known).unwrap();
        // Every reader derives the same.
        let read = Summary::from_json(&judged.to_json().unwrap()).unwrap();
        assert_eq!(derive(&read).verdict, judged.verdict);
        (judged.verdict, judged.reasons.join("; "))
    };
    let (pass, open, fail) = (Verdict::Pass, Verdict::Inconclusive, Verdict::Fail);
    assert_eq!(verdict(40.0, 0.09, 0.0).0, pass);
    assert_eq!(verdict(40.0, 0.09, 0.005).0, open);
    let (found, reason) = verdict(40.0, 0.08, 0.0);
    assert_eq!(found, open);
    assert!(
        reason.contains("of 1 gap, the longest of 40 s from 2000 s, one may hide a value"),
        "{reason}"
    );
    assert_eq!(verdict(40.0, 0.05, 0.0).0, fail);
    let (found, reason) = verdict(120.0, 10.0, 0.0);
    assert_eq!(found, open);
    assert!(reason.contains("the longest of 120 s from 2000 s, one is too long"), "{reason}");
    // A lower limit that is reached stays reached, and the last value isn't in a gap.
    let mut judged = Summary { navigation: Some(navigation(120.0)), ..summary() };
    let asked = [
        requirement("navigation.radial_error_nmi.max", Comparison::AtLeast, 0.01),
        requirement("navigation.radial_error_nmi.final", Comparison::AtMost, 0.1),
    ];
    judge(&mut judged, &asked, &[]).unwrap();
    assert_eq!(judged.verdict, pass, "{:?}", judged.reasons);
}
