//! Time keeping of a run.

use super::chart::{Chart, ChartLine, ChartRole};
use maud::{Markup, html};
use octant_base::number;
use octant_score::summary::{LatenessQuantiles, PacingRecord, Summary};

/// Renders the section; empty for a run that didn't go by the clock.
pub(super) fn pacing(summary: &Summary) -> Markup {
    let Some(pacing) = &summary.pacing else { return html! {} };
    let us = |value: f64| number::significant(value, 3);
    let row = |name: &str, of: &LatenessQuantiles| {
        html! {
            tr {
                td { (name) }
                td.n { (us(of.p50)) } td.n { (us(of.p99)) } td.n { (us(of.p999)) } td.n { (us(of.max)) }
            }
        }
    };
    html! {
        p.hint {
            (number::counted(pacing.frames, "sample", "samples")) ", one every " (number::plain(pacing.period_us, 6)) " µs. "
            (pacing.overruns) " of them left more than " (number::plain(pacing.overrun_us, 6))
            " µs late" @if let Some(first) = pacing.first_overrun {
                ", the first was sample " (first) ", and at most " (pacing.overruns_in_a_row)
                " followed each other"
            } ". " (pacing.late_answers) " periods ended without their answer, "
            (pacing.dropped_records) " steps were not recorded."
            @if pacing.missed_answers + pacing.not_sent > 0 {
                " " (pacing.missed_answers) " samples were never answered, " (pacing.not_sent)
                " could not be sent."
            }
            @if let Some(clock) = &pacing.device_clock {
                " The device's clock was " (us(clock.offset_us)) " µs ahead of the host's, within "
                (us(clock.bound_us)) " µs"
                @if let Some(skew) = clock.skew_ppm { ", and goes " (us(skew)) " ppm faster" } "."
            }
        }
        table {
            thead { tr {
                th { "Duration, µs" } th.n { "median" } th.n { "99 %" } th.n { "99.9 %" } th.n { "largest" }
            } }
            tbody {
                (row("from its time until a sample left", &pacing.lateness_us))
                (row("from there until the answer came", &pacing.answer_us))
            }
        }
        (later_than(pacing).render())
    }
}

/// Draws the share of samples that left later than x.
fn later_than(pacing: &PacingRecord) -> Chart {
    let mut chart = Chart::new("Lateness", "lateness, µs", "Share of the samples that left later");
    chart.hours = false;
    chart.logarithmic = true;
    chart.height = 200.0;
    chart.legend = false;
    let total: u64 = pacing.lateness_histogram_ns.iter().map(|[_, count]| count).sum();
    let mut left = total;
    let mut points = vec![[0.0, 1.0]];
    for [edge_ns, count] in &pacing.lateness_histogram_ns {
        left = left.saturating_sub(*count);
        points.push([*edge_ns as f64 / 1e3, left as f64 / total as f64]);
    }
    chart.lines.push(ChartLine { label: "later".to_owned(), role: ChartRole::Primary, points });
    chart
}
