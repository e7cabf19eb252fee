//! Scores of the whole navigation solution as a table: position, attitude, velocity.

use maud::{Markup, html};
use octant_base::display::{DisplayUnits, ShownUnit};
use octant_base::number;
use octant_score::floor::FloorSummary;
use octant_score::summary::{NavigationScore, SolutionScore, Summary};

/// Time-RMS that the random walk alone leaves of an error by its name.
fn floor_rms(floor: &FloorSummary, name: &str) -> Option<f64> {
    match name {
        "latitude" => Some(floor.latitude_rms_arcmin),
        "longitude" => Some(floor.longitude_rms_arcmin),
        other => Some(floor.solution?.of(other)?.rms),
    }
}

/// Renders the scores of each method's navigation, with its name, beside the floor of the random walk.
pub(super) fn scores(
    all: &[(&str, &NavigationScore)],
    floor: Option<&FloorSummary>,
    units: &DisplayUnits,
) -> Markup {
    let shown = |value: f64, unit: ShownUnit| number::significant(unit.of(value), 3);
    let optional =
        |value: Option<f64>, unit| value.map_or_else(|| "–".to_owned(), |v| shown(v, unit));
    let several = all.len() > 1;
    let count = all.first().map_or(0, |(_, n)| n.errors().len());
    html! {
        h3 { "Scores of the solution" }
        p.hint { "Attitude is that of the case: the gimbals are turned back by their true angles. Secular is \
            the slope of a line that is fitted together with the oscillations; Schuler is the amplitude of the \
            oscillation, fitted in each Schuler period and averaged as squares. Random walk is the time-RMS that the noise of the sensors alone would leave." }
        table {
            thead { tr {
                th { "Error" }
                @if several { th { "Method" } }
                th.n { "Largest" } th.n { "Time-RMS" } th.n { "Final" } th.n { "Secular, per day" }
                th.n { "Schuler" } th.n { "Random walk" } th style="padding-left:14px" { "Unit" }
            } }
            tbody {
                @for row in 0..count {
                    @for (label, n) in all {
                        @if let (name, _, Some(e)) = n.errors()[row] {
                            @let unit = units.of(name);
                            tr {
                                td { (heading(name)) }
                                @if several { td { (label) } }
                                td.n { (shown(e.max, unit)) }
                                td.n { (shown(e.rms, unit)) }
                                td.n { (shown(e.r#final, unit)) }
                                td.n { (optional(e.slope_per_day, unit)) }
                                td.n { (optional(e.schuler_amplitude, unit)) }
                                td.n { (optional(floor.and_then(|f| floor_rms(f, name)), unit)) }
                                td style="padding-left:14px" { (unit.name) }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Name of an error at the start of a row.
fn heading(name: &str) -> &str {
    match name {
        "latitude" => "Latitude",
        "longitude" => "Longitude",
        "heading" => "Heading",
        "pitch" => "Pitch",
        "roll" => "Roll",
        "north" => "Velocity north",
        "east" => "Velocity east",
        other => other,
    }
}

/// Renders the solution at the end of alignment and calibration of each method; empty if none is known.
pub(super) fn alignment(summary: &Summary, units: &DisplayUnits) -> Markup {
    let primary = (summary.method.as_str(), summary.alignment, summary.calibration.as_ref());
    let baseline = summary.baseline.as_ref();
    let methods = std::iter::once(primary)
        .chain(baseline.map(|b| (b.label.as_str(), b.alignment, b.calibration.as_ref())));
    let mut all: Vec<(String, String, SolutionScore)> = Vec::new();
    for (label, aligned, calibration) in methods {
        if let Some(aligned) = aligned {
            let duration = octant_score::work::duration(aligned.duration_s);
            let what = format!("alignment, {}, {duration}", aligned.reference.name());
            all.push((label.to_owned(), what, aligned.solution));
        }
        if let Some(calibration) = calibration
            && let Some(solution) = calibration.solution
        {
            let reference = calibration.reference.map_or("", |reference| reference.name());
            let duration = octant_score::work::duration(3600.0 * calibration.duration_h);
            all.push((label.to_owned(), format!("calibration, {reference}, {duration}"), solution));
        }
    }
    if all.is_empty() {
        return html! {};
    }
    let degrees = |value: Option<f64>| number::optional(value, 3);
    html! {
        p.hint { "Attitude of the case by the encoders of the gimbals, with error and σ at the end of each phase. The σ \
            is that of the filter: its prior after an alignment, its covariance after a calibration; without a filter \
            that of the average of the last standstill." }
        table {
            thead { tr {
                th { "Method" } th { "After" } th.n { "Heading, deg" } th.n { "Pitch, deg" } th.n { "Roll, deg" }
            } }
            tbody { @for (label, what, solution) in &all { tr {
                td { (label) } td { (what) } td.n { (degrees(solution.heading_deg)) }
                td.n { (degrees(solution.pitch_deg)) } td.n { (degrees(solution.roll_deg)) }
            } } }
        }
        table {
            thead { tr {
                th { "Method" } th { "After" } th { "Of" } th.n { "Error" } th.n { "σ" } th.n { "Error/σ" }
                th style="padding-left:14px" { "Unit" }
            } }
            tbody { @for (label, what, solution) in &all { @for (name, _, point) in solution.points() {
                @let unit = units.of(name);
                @let value = |value: Option<f64>| value
                    .map_or_else(|| "–".to_owned(), |v| number::significant(unit.of(v), 3));
                tr {
                    td { (label) } td { (what) } td { (heading(name)) }
                    td.n { (value(point.error)) } td.n { (value(point.sigma)) }
                    td.n { (number::optional(point.normalized, 2)) }
                    td style="padding-left:14px" { (unit.name) }
                }
            } } }
        }
    }
}
