//! Errors after a motion and in it.

use crate::{assert_near, series, with_gap};
use octant_heading::motion::{dynamic_error, error_after_deg};
use octant_heading::{Reading, Series};
use std::f64::consts::TAU;

fn sine(amplitude: f64, period_s: f64) -> Series {
    series(0.1, 600.0, |t_s| 359.9 + amplitude * (TAU * t_s / period_s).sin(), |_| 359.9)
}

#[test]
fn a_sine_has_its_amplitude_and_frequency() {
    for (amplitude, period_s) in [(0.6, 6.0), (-1.2, 60.0), (2.0, 25.0)] {
        let found = dynamic_error(&sine(amplitude, period_s), 0.0, 0.0, 600.0).unwrap();
        assert_near(found.amplitude_deg, f64::abs(amplitude), 1e-3 * f64::abs(amplitude));
        // 6001 readings: the nearest of their frequencies is off by less than half of their distance, 1 / 600 s.
        assert_near(found.frequency_hz, 1.0 / period_s, 0.5 / 600.0);
    }
}

#[test]
fn the_frequency_counts_above_half_a_degree() {
    let below = dynamic_error(&sine(0.49, 6.0), 0.0, 0.0, 600.0).unwrap();
    assert_near(below.amplitude_deg, 0.49, 1e-3);
    assert_eq!(below.frequency_hz, 0.0);
    // The settle point error is taken off: 0.49 about 0.3 is up to 0.79.
    let off = dynamic_error(&sine(0.49, 6.0), -0.3, 0.0, 600.0).unwrap();
    assert_near(off.amplitude_deg, 0.79, 1e-3);
}

#[test]
fn the_largest_component_has_the_frequency() {
    let error = |t_s: f64| 0.4 * (TAU * t_s / 6.0).sin() + 1.0 * (TAU * t_s / 60.0).cos();
    let both = series(0.1, 600.0, error, |_| 0.0);
    let found = dynamic_error(&both, 0.0, 0.0, 600.0).unwrap();
    assert_near(found.frequency_hz, 1.0 / 60.0, 0.5 / 600.0);
    // An offset alone has frequency 0.
    let constant = series(0.1, 600.0, |_| 0.9, |_| 0.0);
    assert_eq!(dynamic_error(&constant, 0.0, 0.0, 600.0).unwrap().frequency_hz, 0.0);
}

#[test]
fn a_gap_in_the_motion_gives_no_value() {
    let all = sine(1.0, 6.0);
    assert!(dynamic_error(&all, 0.0, 10.0, 590.0).is_some());
    assert_eq!(dynamic_error(&with_gap(&all, 99.95, 100.15), 0.0, 10.0, 590.0), None);
    assert_eq!(dynamic_error(&all, 0.0, 10.0, 601.0), None);
    assert_eq!(dynamic_error(&Series::default(), 0.0, 0.0, 600.0), None);
}

#[test]
fn the_heading_after_a_motion_is_read_when_the_table_has_stopped() {
    for error in [0.3, -0.3] {
        let stopped_s = 300.0;
        // While the table moves the error is another one.
        let heading = move |t_s: f64| if t_s < stopped_s { 5.0 } else { error };
        let moving = |reading: &Reading| Reading { moving: reading.t_s < stopped_s, ..*reading };
        let all = series(1.0, 600.0, heading, |_| 0.0);
        let all: Series = all.readings().iter().map(moving).collect();
        let found = error_after_deg(&all, -0.1, stopped_s).unwrap();
        assert_near(found, error + 0.1, 1e-12);
        assert_eq!(error_after_deg(&with_gap(&all, 298.5, 301.5), -0.1, stopped_s), None);
        assert_eq!(error_after_deg(&all, -0.1, 299.0), None, "it moves there");
    }
}
