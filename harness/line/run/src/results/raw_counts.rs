//! Renders a calibration in the raw numbers of a real instrument's file, as data sheets print it.

use octant_calibration::least_squares::raw::{Nominal, RawModel, accelerometer, gyroscope};
use octant_sample::Parameters;
use octant_scenario::SourceSpec;
use octant_scenario::file_names::FileNames;

/// Renders both sensors in raw numbers; empty where samples don't come from a text file.
#[must_use]
pub fn text(source: &SourceSpec, parameters: &Parameters) -> String {
    use std::fmt::Write as _;
    let Some(mapping) = source.text() else { return String::new() };
    let nominal = |axes: &[octant_scenario::recorded::AxisColumn; 3]| Nominal {
        bias_counts: [0, 1, 2].map(|i| axes[i].offset),
        scale: [0, 1, 2].map(|i| axes[i].scale),
    };
    let models = [
        ("accelerometer", "m/s²", accelerometer(parameters, &nominal(&mapping.accelerometer))),
        ("gyro", "rad/s", gyroscope(parameters, &nominal(&mapping.gyro))),
    ];
    let mut out = String::from(
        "in raw numbers of the file, value = T · K · (raw − bias), T with a unit diagonal\n",
    );
    // Writing to a String can't fail.
    if let Some(axes) = FileNames::of(source).line() {
        let _ = writeln!(out, "  columns        {axes}");
    }
    for (name, unit, model) in models {
        let Some(RawModel { bias_counts: b, scale: k, cross: t }) = model else { continue };
        let _ = writeln!(out, "  {name:14} bias  {:>14.3} {:>14.3} {:>14.3}", b[0], b[1], b[2]);
        let _ = writeln!(
            out,
            "  {:14} K     {:>14.8} {:>14.8} {:>14.8}  {unit} per count",
            "", k[0], k[1], k[2]
        );
        for (axis, row) in ["T x", "T y", "T z"].iter().zip(t) {
            let _ = writeln!(
                out,
                "  {:14} {axis}   {:>14.6} {:>14.6} {:>14.6}",
                "", row[0], row[1], row[2]
            );
        }
    }
    out
}
