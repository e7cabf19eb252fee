//! Time keeping of a run.

use super::chart::{Band, Chart, Line, Role};
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
        @if let Some(chart) = over_run(pacing) { (chart.render()) }
    }
}

/// Draws the lateness over the run, from smallest to largest in each interval, with the intervals that
/// have overruns marked; `None` for a run that kept none, or whose lists don't belong together.
fn over_run(pacing: &PacingRecord) -> Option<Chart> {
    let over = pacing.lateness_over_run.as_ref()?;
    let count = over.largest_ns.len();
    if count < 2 || over.least_ns.len() != count || over.overruns.len() != count {
        return None;
    }
    let mut chart = Chart::new("Lateness over the run", "hours of the run", "Lateness, µs");
    chart.logarithmic = true;
    chart.height = 200.0;
    chart.run_offset_h = Some(0.0);
    let interval_h = over.frames_per_interval as f64 * pacing.period_us / 3.6e9;
    // Below the resolution of the clock there is no logarithm.
    let us = |ns: u64| ns.max(1) as f64 / 1e3;
    let at = |k: usize| k as f64 * interval_h;
    let ends = over.least_ns.iter().zip(&over.largest_ns).enumerate();
    let interval_s = number::plain(3600.0 * interval_h, 3);
    chart.bands.push(Band {
        label: format!("smallest to largest in {interval_s} s"),
        role: Role::Primary,
        points: ends.map(|(k, (least, largest))| [at(k), us(*least), us(*largest)]).collect(),
    });
    let largest = over.largest_ns.iter().enumerate();
    chart.lines.push(Line {
        label: "largest".to_owned(),
        role: Role::Primary,
        points: largest.map(|(k, largest)| [at(k), us(*largest)]).collect(),
    });
    let late = over.overruns.iter().zip(&over.largest_ns).enumerate();
    let stems: Vec<[f64; 2]> = late
        .filter(|(_, (overruns, _))| **overruns > 0)
        .flat_map(|(k, (_, largest))| {
            [[at(k), pacing.overrun_us], [at(k), us(*largest)], [at(k), f64::NAN]]
        })
        .collect();
    if !stems.is_empty() {
        let overruns: u64 = over.overruns.iter().sum();
        let label = number::counted(overruns, "overrun", "overruns");
        chart.levels.push((pacing.overrun_us, "limit".to_owned()));
        chart.lines.push(Line { label, role: Role::Baseline, points: stems });
    }
    Some(chart)
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
    chart.lines.push(Line { label: "later".to_owned(), role: Role::Primary, points });
    chart
}
