//! `trend.html`: every measure over the nights, one file without network access.

use super::history::{History, TrendLine, TrendPoint};
use maud::{Markup, html};
use octant_report::chart::{Chart, ChartLine as Drawn, ChartRole};
use octant_report::page::page;
use std::collections::BTreeMap;

/// Renders the page. `baseline` is the accepted night.
#[must_use]
pub fn render(history: &History, baseline: Option<&str>) -> String {
    let nights = history.nights();
    let mut groups: BTreeMap<(String, String), Vec<TrendLine>> = BTreeMap::new();
    for line in history.lines() {
        groups.entry((line.campaign.clone(), line.scenario.clone())).or_default().push(line);
    }
    let number =
        |name: &str| nights.iter().position(|night| night.get("night").is_some_and(|n| n == name));
    let marked = baseline.and_then(number);
    let body = html! {
        header {
            div.eyebrow { "Nights" }
            h1 { "Trend over " (nights.len()) " nights" }
            p.lead { @match baseline {
                Some(night) => { "The accepted baseline is night " strong { (night) } "." }
                None => { "No baseline is accepted yet." }
            } }
        }
        h2 { "Nights" }
        (table(&nights, baseline))
        @for ((campaign, scenario), lines) in &groups {
            h2 { (campaign) ": " (scenario) }
            @for line in lines { (chart(line, marked)) }
        }
    };
    page("Nights", &body)
}

fn table(nights: &[BTreeMap<&'static str, String>], baseline: Option<&str>) -> Markup {
    html! {
        table {
            thead { tr {
                th { "number" } th { "night" } th { "verdict" } th { "against" } th { "octant" }
                th { "commit" } th { "program" }
            } }
            tbody { @for (index, night) in nights.iter().enumerate() {
                @let get = |name: &str| night.get(name).cloned().unwrap_or_default();
                @let short = |name: &str| get(name).chars().take(12).collect::<String>();
                tr {
                    td { (index + 1) }
                    td { (get("night")) @if baseline == Some(get("night").as_str()) { " (baseline)" } }
                    td { span class={ "badge " (get("verdict")) } { (get("verdict")) } }
                    td { (get("baseline")) }
                    td { (get("octant")) }
                    td { code { (short("commit")) } }
                    td { code { (short("program_sha256")) } }
                }
            } }
        }
    }
}

fn chart(line: &TrendLine, baseline: Option<usize>) -> Markup {
    let mut chart = Chart::new(&line.measure, "night", &line.measure);
    chart.hours = false;
    chart.height = 170.0;
    let of = |value: fn(&TrendPoint) -> f64| -> Vec<[f64; 2]> {
        line.points.iter().map(|point| [(point.night + 1) as f64, value(point)]).collect()
    };
    chart.lines = vec![
        Drawn { label: "95th percentile".into(), role: ChartRole::Baseline, points: of(|p| p.p95) },
        Drawn { label: "median".into(), role: ChartRole::Primary, points: of(|p| p.median) },
    ];
    let reference =
        baseline.and_then(|night| line.points.iter().find(|point| point.night == night));
    if let Some(point) = reference.filter(|point| point.median.is_finite()) {
        chart.levels.push((point.median, "median of the baseline".to_owned()));
    }
    let told = |what: &str| -> Vec<String> {
        let nights = line.points.iter().filter(|point| point.change == what);
        nights.map(|point| (point.night + 1).to_string()).collect()
    };
    let (worse, better) = (told("worse"), told("better"));
    html! {
        @if let [only] = line.points.as_slice() {
            h3 { (line.measure) }
            p { "median " (octant_base::number::significant(only.median, 4)) ", 95th percentile "
                (octant_base::number::significant(only.p95, 4)) ", in one night" }
        } @else { (chart.render()) }
        @if !worse.is_empty() { p.hint { "Worse than its baseline in night " (worse.join(", ")) "." } }
        @if !better.is_empty() { p.hint { "Better than its baseline in night " (better.join(", ")) "." } }
    }
}
