//! Scores of the whole navigation solution as a table: position, attitude, velocity.

use maud::{Markup, html};
use octant_base::number;
use octant_score::floor::FloorSummary;
use octant_score::summary::Navigation;

/// Time-RMS that the random walk alone leaves of an error by its name.
fn floor_rms(floor: &FloorSummary, name: &str) -> Option<f64> {
    match name {
        "latitude" => Some(floor.latitude_rms_arcmin),
        "longitude" => Some(floor.longitude_rms_arcmin),
        other => Some(floor.solution?.of(other)?.rms),
    }
}

/// Renders the scores of each method's navigation, with its name, beside the floor of the random walk.
pub(super) fn scores(all: &[(&str, &Navigation)], floor: Option<&FloorSummary>) -> Markup {
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
                        @if let (name, unit, Some(e)) = n.errors()[row] {
                            tr {
                                td { (heading(name)) }
                                @if several { td { (label) } }
                                td.n { (number::significant(e.max, 3)) }
                                td.n { (number::significant(e.rms, 3)) }
                                td.n { (number::significant(e.r#final, 3)) }
                                td.n { (number::optional(e.slope_per_day, 3)) }
                                td.n { (number::optional(e.schuler_amplitude, 3)) }
                                td.n { (floor.and_then(|f| floor_rms(f, name))
                                    .map_or_else(|| "–".to_owned(), |v| number::significant(v, 3))) }
                                td style="padding-left:14px" { (unit) }
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
