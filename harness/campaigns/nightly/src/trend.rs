//! `trend.html`: every measure over the nights, one file without network access.

use super::history::{History, TrendLine, TrendPoint};
use super::units::TrendUnits;
use maud::{Markup, html};
use octant_base::display::DisplayUnits;
use octant_base::number::counted;
use octant_report::chart::{Chart, Line as Drawn, Role};
use octant_report::page::page;
use octant_report::units::{shown, unit};
use std::collections::BTreeMap;

/// Renders the page. `baseline` is the accepted night.
#[must_use]
pub fn render(history: &History, baseline: Option<&str>, units: &TrendUnits) -> String {
    let nights = history.nights();
    let mut groups: BTreeMap<(String, String), Vec<TrendLine>> = BTreeMap::new();
    for line in history.lines() {
        groups.entry((line.campaign.clone(), line.scenario.clone())).or_default().push(line);
    }
    // The worst first: groups and lines whose last night is worse than its baseline.
    let mut groups: Vec<_> = groups.into_iter().collect();
    for (_, lines) in &mut groups {
        lines.sort_by_key(|line| std::cmp::Reverse(severity(line)));
    }
    groups.sort_by_key(|(_, lines)| std::cmp::Reverse(lines.iter().map(severity).max()));
    let number =
        |name: &str| nights.iter().position(|night| night.get("night").is_some_and(|n| n == name));
    let marked = baseline.and_then(number);
    let body = html! {
        header {
            div.eyebrow { "Nightly regression" }
            h1 { "Trend over " (counted(nights.len(), "night", "nights")) }
            p.lead { @match baseline {
                Some(night) => { "The accepted baseline is night " strong { (night) } "." }
                None => { "No baseline is accepted yet." }
            } }
        }
        nav.contents aria-label="Contents" {
            a href="#nights" { "Nights" } " "
            @for (index, ((campaign, scenario), _)) in groups.iter().enumerate() {
                a href={ "#scenario-" (index) } { (short(campaign)) ": " (short(scenario)) } " "
            }
        }
        section {
            h2 #nights { "Nights" }
            (table(&nights, baseline))
        }
        @for (index, ((campaign, scenario), lines)) in groups.iter().enumerate() {
            @let of_scenario = units.of(campaign, scenario);
            section {
                h2 id={ "scenario-" (index) } { (short(campaign)) ": " (short(scenario)) }
                @if let Some(remark) = units.remark(campaign, scenario) { p.hint { (remark) } }
                div.plots { @for line in lines { (chart(line, marked, &of_scenario)) } }
            }
        }
    };
    page("Nightly trend", &body)
}

/// Severity of a line: 2 if its last night is worse than its baseline, 1 if an earlier one is.
#[must_use]
pub fn severity(line: &TrendLine) -> u8 {
    let worse = |point: &TrendPoint| point.change == "worse";
    if line.points.last().is_some_and(worse) { 2 } else { u8::from(line.points.iter().any(worse)) }
}

/// Name of a campaign or scenario: of a path its file without folder and extension.
#[must_use]
pub fn short(name: &str) -> &str {
    let file = name.rsplit('/').next().unwrap_or(name);
    file.strip_suffix(".toml").filter(|stem| !stem.is_empty()).unwrap_or(file)
}

/// Title of a measure in words, with the unit in which it is shown where it has one.
#[must_use]
pub fn title(measure: &str, units: &DisplayUnits) -> String {
    if measure.starts_with("margin of ") {
        // The history doesn't know its requirement.
        return format!("{measure}, in the unit of its measure");
    }
    let own = unit(measure);
    let words = measure.trim_matches('|').replace(['.', '_'], " ");
    // The unit ends the title and needn't be in the name as well.
    let (base, per) = match own.rsplit_once('/') {
        Some((base, "day")) => (base, " per day"),
        Some((base, "h")) => (base, " per h"),
        _ => (own, ""),
    };
    let words = words.strip_suffix(per).unwrap_or(&words);
    let ending = match base {
        "m/s" => "mps",
        "µs" => "us",
        other => other,
    };
    let words = words.split(' ').filter(|word| *word != ending).collect::<Vec<_>>().join(" ");
    let shown = shown(measure, units).name;
    if shown.is_empty() { words } else { format!("{words}, {shown}") }
}

fn table(nights: &[BTreeMap<&'static str, String>], baseline: Option<&str>) -> Markup {
    html! {
        table {
            thead { tr {
                th { "Number" } th { "Verdict" } th { "Night" } th { "Started" } th { "Baseline" }
                th { "Octant" } th { "Commit" } th { "Program" }
            } }
            tbody { @for (index, night) in nights.iter().enumerate() {
                @let get = |name: &str| night.get(name).cloned().unwrap_or_default();
                @let short = |name: &str| get(name).chars().take(12).collect::<String>();
                tr {
                    td { (index + 1) }
                    td { span class={ "badge " (get("verdict")) } { (get("verdict")) } }
                    td { (get("night")) @if baseline == Some(get("night").as_str()) { " (baseline)" } }
                    td { (get("started")) }
                    td { (get("baseline")) }
                    td { (get("octant")) }
                    td { code { (short("commit")) } }
                    td { code { (short("program_sha256")) } }
                }
            } }
        }
    }
}

/// Chart of a line; `baseline` is the number of the accepted night.
#[must_use]
pub fn chart(line: &TrendLine, baseline: Option<usize>, units: &DisplayUnits) -> Markup {
    let title = title(&line.measure, units);
    let unit = shown(&line.measure, units);
    let mut chart = Chart::new(&title, "number of the night", &title);
    chart.hours = false;
    chart.dots = true;
    chart.height = 170.0;
    let of = |value: fn(&TrendPoint) -> f64| -> Vec<[f64; 2]> {
        let at = |point: &TrendPoint| [(point.night + 1) as f64, unit.of(value(point))];
        line.points.iter().map(at).collect()
    };
    chart.lines = vec![
        Drawn { label: "95th percentile".into(), role: Role::Baseline, points: of(|p| p.p95) },
        Drawn { label: "median".into(), role: Role::Primary, points: of(|p| p.median) },
    ];
    let reference =
        baseline.and_then(|night| line.points.iter().find(|point| point.night == night));
    if let Some(point) = reference.filter(|point| point.median.is_finite()) {
        chart.levels.push((unit.of(point.median), "median of the baseline".to_owned()));
    }
    let told = |what: &str| -> Vec<String> {
        let nights = line.points.iter().filter(|point| point.change == what);
        nights.map(|point| (point.night + 1).to_string()).collect()
    };
    let (worse, better) = (told("worse"), told("better"));
    html! {
        @if let [only] = line.points.as_slice() {
            h3 { (title) }
            p { "median " (octant_base::number::significant(unit.of(only.median), 4)) ", 95th percentile "
                (octant_base::number::significant(unit.of(only.p95), 4)) ", in one night" }
        } @else { (chart.render()) }
        @if !worse.is_empty() { p.hint { "Worse than its baseline in night " (worse.join(", ")) "." } }
        @if !better.is_empty() { p.hint { "Better than its baseline in night " (better.join(", ")) "." } }
    }
}
