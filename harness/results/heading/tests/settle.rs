//! Settling time and settle point of headings with a closed form.

use crate::{assert_near, series, with_gap};
use octant_heading::settle::{Settling, settle_point, settling};
use octant_heading::{Reading, Series};

const HOUR: f64 = 3600.0;

/// Heading that comes to its end exponentially: `end + start · exp(−t / τ)`. Readings 30 min apart are within a band b of
/// three from the reading at t on, if start · exp(−t / τ) · (1 − exp(−60 min / τ)) is at most b.
fn decaying(end_deg: f64, start_deg: f64, tau_s: f64) -> Series {
    series(10.0, 12.0 * HOUR, |t_s| end_deg + start_deg * (-t_s / tau_s).exp(), |_| end_deg)
}

#[test]
fn an_exponential_settles_when_its_closed_form_says_so() {
    for end_deg in [0.0, 40.0, 359.9, 180.0] {
        for start_deg in [60.0, -60.0, 5.0, -5.0] {
            let tau_s = 2400.0;
            let within = |first: u32| {
                let t_s = f64::from(first) * 1800.0;
                f64::abs(start_deg) * (-t_s / tau_s).exp() * (1.0 - (-3600.0 / tau_s).exp()) <= 0.7
            };
            let first = (1..).find(|first| within(*first)).unwrap();
            let expected = Settling { time_s: f64::from(first + 2) * 1800.0, settled: true };
            let found = settling(&decaying(end_deg, start_deg, tau_s), 12.0 * HOUR);
            assert_eq!(found, Some(expected), "{end_deg} {start_deg}");
        }
    }
}

#[test]
fn a_band_is_kept_with_its_edge() {
    // Readings at +0.35 and −0.35 by turns: a band of 0.7, or a little more.
    let alternating = |half: f64| {
        let heading = move |t_s: f64| {
            let number = (t_s / 1800.0).round() as i64;
            if number % 2 == 0 { half } else { -half }
        };
        settling(&series(10.0, 6.0 * HOUR, heading, |_| 0.0), 6.0 * HOUR).unwrap()
    };
    assert_eq!(alternating(0.34), Settling { time_s: 5400.0, settled: true });
    // 12 readings are due in six hours; the next one would be at 390 min.
    assert_eq!(alternating(0.36), Settling { time_s: 23_400.0, settled: false });
}

#[test]
fn a_drift_settles_below_0_7_deg_an_hour() {
    let drifting = |rate_degph: f64| {
        let all = series(10.0, 3.0 * HOUR, |t_s| 359.5 + rate_degph * t_s / HOUR, |_| 0.0);
        // The true heading stays: the band is that of the heading.
        settling(&all, 3.0 * HOUR).unwrap().settled
    };
    assert!(drifting(0.69) && drifting(-0.69));
    assert!(!drifting(0.71) && !drifting(-0.71));
}

#[test]
fn a_missing_reading_gives_no_value_and_others_do_no_harm() {
    let all = decaying(40.0, 60.0, 2400.0);
    let whole = settling(&all, 12.0 * HOUR);
    let time_s = whole.unwrap().time_s;
    assert!(time_s > 2.0 * 5400.0);
    assert_eq!(settling(&with_gap(&all, 5390.0, 5410.0), 12.0 * HOUR), None);
    assert_eq!(settling(&with_gap(&all, 5410.0, 7190.0), 12.0 * HOUR), whole);
    // After it settled.
    assert_eq!(settling(&with_gap(&all, time_s + 1.0, 12.0 * HOUR), 12.0 * HOUR), whole);
    // A record that ends before.
    assert_eq!(settling(&with_gap(&all, time_s - 1.0, 12.0 * HOUR), 12.0 * HOUR), None);
    let short = settling(&all, time_s - 1.0).unwrap();
    assert_eq!(short, Settling { time_s, settled: false });
    assert_eq!(settling(&all, 1799.0), None);
}

#[test]
fn a_unit_without_a_heading_is_not_settled() {
    let aligned = |after_s: f64| -> Series {
        let all = series(10.0, 6.0 * HOUR, |_| 12.0, |_| 12.0);
        let heading = |r: &Reading| r.heading_deg.filter(|_| r.t_s >= after_s);
        all.readings().iter().map(|r| Reading { heading_deg: heading(r), ..*r }).collect()
    };
    assert_eq!(settling(&aligned(0.0), 6.0 * HOUR).unwrap().time_s, 5400.0);
    assert_eq!(settling(&aligned(1800.0), 6.0 * HOUR).unwrap().time_s, 5400.0);
    assert_eq!(settling(&aligned(1801.0), 6.0 * HOUR).unwrap().time_s, 7200.0);
}

#[test]
fn a_settle_point_is_the_mean_of_ten_readings_at_their_times() {
    // A ramp of 0.03°/h about the true heading: readings at 20, 40 … 200 min after settling, whose mean is at 110 min.
    for truth_deg in [0.0, 0.2, 359.9, 123.0] {
        for rate in [0.03, -0.03] {
            for offset in [0.4, -0.4] {
                let heading = move |t_s: f64| truth_deg + offset + rate * t_s / HOUR;
                let all = series(10.0, 6.0 * HOUR, heading, |_| truth_deg);
                let point = settle_point(&all, 5400.0, 6.0 * HOUR).unwrap();
                let expected = offset + rate * (5400.0 + 6600.0) / HOUR;
                assert_near(point.error_deg.unwrap(), expected, 1e-12);
                let from_truth = octant_heading::angle::difference(point.heading_deg, truth_deg);
                assert_near(from_truth, expected, 1e-12);
                // Ten equal steps d have an rms of d √(99/12).
                let rms = f64::abs(rate) / 3.0 * (99.0f64 / 12.0).sqrt();
                assert_near(point.readings_rms_deg, rms, 1e-12);
            }
        }
    }
}

#[test]
fn a_settle_point_needs_all_ten_readings() {
    let all = series(10.0, 6.0 * HOUR, |_| 40.1, |_| 40.0);
    assert!(settle_point(&all, 5400.0, 5400.0 + 12_000.0).is_some());
    assert_eq!(settle_point(&all, 5400.0, 5400.0 + 11_999.0), None);
    let tenth_s = 5400.0 + 12_000.0;
    assert_eq!(
        settle_point(&with_gap(&all, tenth_s - 5.0, tenth_s + 5.0), 5400.0, 6.0 * HOUR),
        None
    );
    let between = with_gap(&all, tenth_s - 1000.0, tenth_s - 100.0);
    assert!(settle_point(&between, 5400.0, 6.0 * HOUR).is_some());
}

#[test]
fn the_motion_of_the_table_is_not_an_error_of_the_unit() {
    let yaw = |t_s: f64| 5.0 * (2.0 * std::f64::consts::PI * t_s / 1000.0).sin();
    let all = series(10.0, 6.0 * HOUR, |t_s| 0.3 + yaw(t_s), yaw);
    assert_eq!(settling(&all, 6.0 * HOUR), Some(Settling { time_s: 5400.0, settled: true }));
    let point = settle_point(&all, 5400.0, 6.0 * HOUR).unwrap();
    assert_near(point.error_deg.unwrap(), 0.3, 1e-12);
    assert_near(point.readings_rms_deg, 0.0, 1e-12);
}

#[test]
fn a_heading_without_a_truth_has_a_settle_point_and_no_error() {
    let all = series(10.0, 6.0 * HOUR, |_| 359.95, |_| 0.0);
    let unknown: Series = all.readings().iter().map(|r| Reading { true_deg: None, ..*r }).collect();
    let point = settle_point(&unknown, 5400.0, 6.0 * HOUR).unwrap();
    assert_near(point.heading_deg, 359.95, 1e-12);
    assert_eq!(point.error_deg, None);
}
