//! Scores of the whole navigation solution as a table: position, attitude, velocity.

use maud::{Markup, html};
use octant_base::number;
use octant_score::summary::Navigation;

/// Renders the scores of each method's navigation, with its name.
pub(super) fn scores(all: &[(&str, &Navigation)]) -> Markup {
    let several = all.len() > 1;
    let count = all.first().map_or(0, |(_, n)| n.errors().len());
    html! {
        h3 { "Scores of the solution" }
        p.hint { "Attitude is that of the case: the gimbals are turned back by their true angles. Secular is \
            the slope of a line that is fitted together with the oscillations; Schuler is the amplitude of the \
            oscillation, fitted in each Schuler period and averaged as squares." }
        table {
            thead { tr {
                th { "Error" }
                @if several { th { "Method" } }
                th.n { "Largest" } th.n { "Time-RMS" } th.n { "Final" } th.n { "Secular, per day" }
                th.n { "Schuler" } th style="padding-left:14px" { "Unit" }
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
