//! Drift of the cases: figures with bounds, and percentiles over time.

use super::elements::{heading, with_bounds_in};
use maud::{Markup, html};
use octant_base::display::ShownUnit;
use octant_base::number;
use octant_campaign::report::CampaignReport;
use octant_campaign::report::envelope::PERCENTILES;
use octant_campaign::report::figures::{CombinationFigures, ScenarioFigures};
use octant_report::chart::{Band, Chart, Line, Role};

/// Maximum number of combinations that are drawn.
pub(super) const DRAWN_MAX: usize = 24;

pub(super) fn table(report: &CampaignReport<'_>) -> Markup {
    let statistics = &report.statistics;
    let none = statistics.combinations.iter().all(|figures| figures.navigated == 0);
    let unit = report.units.shown().radial();
    let name = unit.name;
    html! {
        (heading("drift"))
        @if none {
            p.empty { "No case has a navigation." }
        } @else {
            p.hint { "Radial errors at the end of the navigation: CEP50 is their median, R95 their 95th percentile. The \
                rate is the regression of the radial error on time through the origin, time-RMS is √(1/T ∫ r² dt). Below \
                each figure its interval at " (number::plain(100.0 * statistics.confidence, 3))
                " %, from order statistics, without a distribution; ∞ where there are too few cases. Cases that were \
                refused or ended as errors are in the sample, beyond every number: a figure that falls on one is not \
                defined." }
            div.wide tabindex="0" role="region" aria-label="Drift by combination" {
                table {
                    thead { tr {
                        th { "Combination" } th.n { "Cases" } th.n { "CEP50, " (name) } th.n { "R95, " (name) }
                        th.n { "Largest, 95 %, " (name) } th.n { "Rate 50 %, " (name) "/h" }
                        th.n { "Rate 95 %, " (name) "/h" } th.n { "Time-RMS 50 %, " (name) } th.n { "95 %" }
                    } }
                    tbody { @for scenario in &statistics.scenarios {
                        @let mine: Vec<_> = report.combinations.iter().zip(&statistics.combinations)
                            .filter(|(combination, _)| combination.scenario == scenario.scenario).collect();
                        @if mine.len() > 1 { (whole(scenario, unit)) }
                        @for (combination, figures) in &mine {
                            @let name = if mine.len() > 1 { combination.short() } else { combination.name() };
                            (row(&name, figures, unit))
                        }
                    } }
                }
            }
            @if statistics.scenarios.iter().any(|scenario| scenario.combinations > 1) {
                p.hint { "Rows of a whole scenario have no interval: the same instruments are in all of its combinations." }
            }
            (marks(report))
            (solution(report))
        }
    }
}

/// Renders a scenario over all of its combinations.
fn whole(scenario: &ScenarioFigures, unit: ShownUnit) -> Markup {
    let value = |value: Option<f64>| match value {
        None => "–".to_owned(),
        Some(value) if value.is_finite() => number::significant(unit.of(value), 3),
        Some(_) => "not defined".to_owned(),
    };
    html! {
        tr.group {
            td { (scenario.scenario) }
            td.n { (scenario.navigated)
                @if scenario.beyond > 0 { div.reason { (scenario.beyond) " beyond" } } }
            td.n { (value(scenario.cep50_nmi)) } td.n { (value(scenario.r95_nmi)) } td.n { }
            td.n { (value(scenario.rate50_nmi_per_h)) } td.n { (value(scenario.rate95_nmi_per_h)) }
            td.n { (value(scenario.time_rms_nmi)) } td.n { }
        }
    }
}

fn row(name: &str, figures: &CombinationFigures, unit: ShownUnit) -> Markup {
    let with_bounds = |interval| with_bounds_in(interval, unit);
    html! {
        tr {
            td { (name) }
            td.n { (figures.navigated)
                @if figures.navigated < figures.cases { div.reason { "of " (figures.cases) } }
                @if figures.beyond > 0 { div.reason { (figures.beyond) " beyond" } } }
            @match (figures.at_end, figures.largest_nmi, figures.rate_nmi_per_h, figures.time_rms_nmi) {
                (Some(at_end), Some(largest), Some(rate), Some(time_rms)) => {
                    td.n { (with_bounds(&at_end.cep50)) }
                    td.n { (with_bounds(&at_end.r95)) }
                    td.n { (with_bounds(&largest.p95)) }
                    td.n { (with_bounds(&rate.rate50)) }
                    td.n { (with_bounds(&rate.rate95)) }
                    td.n { (with_bounds(&time_rms.p50)) }
                    td.n { (with_bounds(&time_rms.p95)) }
                }
                _ => { @for _ in 0..7 { td.n { "–" } } }
            }
        }
    }
}

/// Renders errors at 24 h and 72 h, for navigations that lasted as long.
fn marks(report: &CampaignReport<'_>) -> Markup {
    let all = || report.combinations.iter().zip(&report.statistics.combinations);
    if all().all(|(_, figures)| figures.at_marks.is_empty()) {
        return html! {};
    }
    let unit = report.units.shown().radial();
    let with_bounds = |interval| with_bounds_in(interval, unit);
    html! {
        h3 { "At marks" }
        table {
            thead { tr { th { "Combination" } th.n { "After" } th.n { "CEP50, " (unit.name) }
                th.n { "R95, " (unit.name) } } }
            tbody { @for (combination, figures) in all() { @for (mark, position) in &figures.at_marks { tr {
                td { (combination.name()) } td.n { (mark) }
                td.n { (with_bounds(&position.cep50)) } td.n { (with_bounds(&position.r95)) }
            } } } }
        }
    }
}

/// Renders the largest errors of attitude and velocity.
fn solution(report: &CampaignReport<'_>) -> Markup {
    let all = || report.combinations.iter().zip(&report.statistics.combinations);
    if all().all(|(_, figures)| figures.solution.is_empty()) {
        return html! {};
    }
    html! {
        h3 { "Attitude and velocity" }
        p.hint { "Largest error of each navigation: heading, pitch and roll of the case, velocity to the north and east." }
        table {
            thead { tr { th { "Combination" } th { "Largest error" } th.n { "50 %" } th.n { "95 %" } } }
            tbody { @for (combination, figures) in all() { @for (name, spread) in &figures.solution {
                // The key has the name and its unit in the results.
                @let name = name.split(',').next().unwrap_or(name);
                @let unit = report.units.shown().of(name);
                tr {
                    td { (combination.name()) } td { (name) ", " (unit.name) }
                    td.n { (with_bounds_in(&spread.p50, unit)) } td.n { (with_bounds_in(&spread.p95, unit)) }
                }
            } } }
        }
    }
}

/// Draws percentiles of the errors over time. Curves of a prediction belong into the same charts.
pub(super) fn envelopes(report: &CampaignReport<'_>) -> Markup {
    let combinations = report.combinations.iter().zip(&report.statistics.combinations).enumerate();
    let there: Vec<_> = combinations
        .filter(|(_, (_, figures))| figures.envelope.is_some())
        .map(|(place, (combination, _))| (place, combination.name()))
        .collect();
    let unit = report.units.shown().latitude().name;
    html! {
        (heading("envelopes"))
        @if there.is_empty() {
            p.empty { "There are no errors over time, or their lengths differ too much for one picture." }
        } @else {
            p.hint { "Navigation minus truth, by percentile of the cases at each time. Every pair has its own scale. A case \
                beyond every number counts as far below for the percentiles under the median and as far above for those \
                over it: a percentile that falls on one isn't drawn, and neither is the median."
                @if report.units.shown().position.is_distance() {
                    " Errors are distances along the ground, those of each case at its own site."
                } }
            @for (place, name) in there.iter().take(DRAWN_MAX) {
                @if let Some(envelope) = report.envelope(*place) {
                    h3 { (name) }
                    div.pairs {
                        (chart(name, &format!("Latitude error, {unit}"), &envelope.hours, &envelope.latitude))
                        (chart(name, &format!("Longitude error, {unit}"), &envelope.hours, &envelope.longitude))
                    }
                }
            }
            @if there.len() > DRAWN_MAX {
                p.hint { "The other " (there.len() - DRAWN_MAX) " combinations are in statistics.json." }
            }
        }
    }
}

fn chart(of: &str, name: &str, hours: &[f64], curves: &[Vec<f64>]) -> Markup {
    let mut chart = Chart::new(&format!("{name}, {of}"), "hours of navigation", name);
    (chart.width, chart.height) = (480.0, 200.0);
    // The envelopes of all combinations share range and cursor.
    chart.run_offset_h = Some(0.0);
    let [least, low, middle, high, greatest] = [0, 1, 2, 3, 4];
    let value = |curve: usize, k: usize| {
        curves.get(curve).and_then(|curve| curve.get(k)).copied().unwrap_or(f64::NAN)
    };
    let percentile = |curve: usize| number::plain(100.0 * PERCENTILES[curve], 3);
    for (role, from, to) in [(Role::Reference, least, greatest), (Role::Primary, low, high)] {
        let points = hours.iter().enumerate();
        chart.bands.push(Band {
            label: format!("{} to {} %", percentile(from), percentile(to)),
            role,
            points: points.map(|(k, hours)| [*hours, value(from, k), value(to, k)]).collect(),
        });
    }
    let points = hours.iter().enumerate();
    chart.lines.push(Line {
        label: "median".to_owned(),
        role: Role::Primary,
        points: points.map(|(k, hours)| [*hours, value(middle, k)]).collect(),
    });
    chart.render()
}
