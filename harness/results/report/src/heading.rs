//! Heading test: the run-ups with their readings' results.

use maud::{Markup, html};
use octant_base::number;
use octant_score::summary::{HeadingScore, Summary};

/// Renders the heading test of a run; empty without one.
pub(super) fn heading(summary: &Summary) -> Markup {
    let Some(test) = &summary.heading else { return html! {} };
    let degrees = |value: Option<f64>| number::optional(value, 4);
    let has_after = test.run_ups.iter().any(|one| one.after_motion.is_some());
    html! {
        p.hint { (hint(test)) }
        @if !test.knows_truth() {
            p.hint { "Errors are not tested: no true heading is known." }
        }
        table {
            thead { tr {
                th.n { "Run-up" } th.n { "Settled after, min" } th.n { "Settle point, deg" }
                th.n { "Settle point error, deg" } th.n { "Rms of the readings, deg" }
                @if has_after { th.n { "Error after the motion, deg" } }
                @if test.scorsby_error_deg.is_some() { th.n { "Change after the motion, deg" } }
                @if test.dynamic_amplitude_deg.is_some() {
                    th.n { "Amplitude in motion, deg" } th.n { "Frequency, Hz" }
                }
            } }
            tbody { @for (index, one) in test.run_ups.iter().enumerate() { tr {
                td.n { (index + 1) }
                td.n {
                    @if !one.settled && one.settling_time_min.is_some() { "not before " }
                    (number::optional(one.settling_time_min, 1))
                }
                td.n { (degrees(one.settle_point.map(|point| point.heading_deg))) }
                td.n { (degrees(one.settle_point.and_then(|point| point.error_deg))) }
                td.n { (degrees(one.settle_point.map(|point| point.readings_rms_deg))) }
                @if has_after { td.n { (degrees(one.after_motion.and_then(|point| point.error_deg))) } }
                @if test.scorsby_error_deg.is_some() { td.n { (degrees(one.scorsby_error_deg)) } }
                @if test.dynamic_amplitude_deg.is_some() {
                    td.n { (degrees(one.dynamic_amplitude_deg)) } td.n { (degrees(one.dynamic_frequency_hz)) }
                }
            } } }
        }
    }
}

/// Text about the readings.
fn hint(test: &HeadingScore) -> String {
    let resolution = match test.resolution_deg {
        0.0 => String::new(),
        step => format!(" Headings are read with a resolution of {} deg.", number::plain(step, 4)),
    };
    format!(
        "Test {} at a latitude of {} deg. Settled: three readings every 30 min within 0.7 deg. Settle point: mean of ten \
         readings every 20 min after that.{resolution}",
        test.test.name(),
        number::plain(test.latitude_deg, 6)
    )
}
