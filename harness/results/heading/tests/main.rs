//! Measures of heading type tests against closed forms.

#![allow(clippy::unwrap_used, reason = "tests")]

mod angles;
mod motion;
mod score;
mod settle;

use octant_heading::{Reading, Series};

/// Readings every `every_s` from 0 to `end_s`, with a heading and a true heading as functions of time, deg.
fn series(
    every_s: f64,
    end_s: f64,
    heading: impl Fn(f64) -> f64,
    truth: impl Fn(f64) -> f64,
) -> Series {
    let count = (end_s / every_s) as usize;
    let at = |index: usize| {
        let t_s = index as f64 * every_s;
        Reading {
            t_s,
            heading_deg: Some(octant_heading::angle::heading(heading(t_s))),
            true_deg: Some(octant_heading::angle::heading(truth(t_s))),
            moving: false,
        }
    };
    (0..=count).map(at).collect()
}

/// The same without the readings between two times.
fn with_gap(all: &Series, from_s: f64, to_s: f64) -> Series {
    let outside = |reading: &&Reading| reading.t_s < from_s || reading.t_s > to_s;
    all.readings().iter().filter(outside).copied().collect()
}

#[track_caller]
fn assert_near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "found {found}, expected {expected} ± {within}");
}
