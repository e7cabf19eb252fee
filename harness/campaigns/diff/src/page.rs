//! Differences as one HTML file, with plots over each other.

use super::RunDiff;
use super::cases::CampaignDiff;
use super::settings::SettingDiff;
use super::side::Side;
use super::text::{in_words, number, shown, significance, stream_in_words};
use maud::{Markup, html};
use octant_base::number::{fixed, significant};
use octant_nightly::compare::Change;
use octant_report::chart::{Chart, Line, Role};
use octant_report::page::page;

/// Renders the difference between two runs.
#[must_use]
pub fn of_runs(diff: &RunDiff, sides: [&Side; 2]) -> String {
    let body = html! {
        header {
            div.eyebrow { "Difference between two runs" }
            h1 { (if diff.equal { "Equal" } else { "Different" }) }
            @for (name, about) in ["A", "B"].iter().zip(&diff.runs) {
                p.lead { strong { (name) } " " (in_words(about)) }
            }
        }
        (settings(&diff.settings))
        h2 { "Samples" }
        p { (stream_in_words(&diff.stream, &diff.runs)) }
        (channels(diff))
        @if !diff.stream.position_m.is_empty() { (positions(diff)) }
        @if !diff.scores.is_empty() {
            h2 { "Scores" }
            p.hint { "One pair of runs shows no significance: two campaigns do." }
            (errors(sides))
            table {
                thead { tr { th { "Score" } th.n { "A" } th.n { "B" } th.n { "B − A" } } }
                tbody { @for row in shown(&diff.scores) { tr {
                    td.mono { (row.score) } td.n { (number(row.first)) } td.n { (number(row.second)) }
                    td.n { (number(row.difference)) }
                } } }
            }
        }
        @if !diff.parameters.is_empty() { (parameters(diff)) }
        @for note in &diff.notes { p.hint { (note) } }
    };
    page("Difference between two runs", &body)
}

fn settings(settings: &[SettingDiff]) -> Markup {
    let value = |value: &Option<String>| {
        html! { @match value {
            Some(value) => td.mono { (value) },
            None => td { "–" },
        } }
    };
    html! {
        h2 { "Settings" }
        @if settings.is_empty() { p { "The same." } } @else {
            table {
                thead { tr { th { "Key" } th { "A" } th { "B" } } }
                tbody { @for setting in settings { tr {
                    td.mono { (setting.key) } (value(&setting.first)) (value(&setting.second))
                } } }
            }
        }
    }
}

fn channels(diff: &RunDiff) -> Markup {
    html! {
        table {
            thead { tr {
                th { "Channel" } th.n { "Messages in both" } th.n { "Different" }
                th.n { "Only in A" } th.n { "Only in B" }
            } }
            tbody { @for channel in &diff.stream.channels { tr {
                td.mono { (channel.channel) } td.n { (channel.compared) } td.n { (channel.differing) }
                td.n { (channel.only_first) } td.n { (channel.only_second) }
            } } }
        }
    }
}

/// Draws the difference of the solutions over run time.
fn positions(diff: &RunDiff) -> Markup {
    let mut chart = Chart::new(
        "Position of the solution, B minus A",
        "hours of run time",
        "position, B minus A, m",
    );
    for (label, role, column) in [("east", Role::Second, 2), ("north", Role::Primary, 1)] {
        chart.lines.push(Line {
            label: label.to_owned(),
            role,
            points: diff.stream.position_m.iter().map(|p| [p[0], p[column]]).collect(),
        });
    }
    chart.render()
}

/// Draws the errors of both navigations over each other.
fn errors(sides: [&Side; 2]) -> Markup {
    let navigation = |side: &Side| side.summary.as_ref().and_then(|s| s.navigation.clone());
    let both = sides.map(navigation);
    if both.iter().all(Option::is_none) {
        return html! {};
    }
    let chart = |name: &str, column: usize| {
        let title = format!("{name} error");
        let mut chart = Chart::new(&title, "hours of navigation", &format!("{title}, arcmin"));
        let roles = [("A", Role::Baseline), ("B", Role::Primary)];
        for ((label, role), navigation) in roles.iter().zip(&both) {
            let series = navigation.iter().flat_map(|n| &n.series_hours);
            chart.lines.push(Line {
                label: (*label).to_owned(),
                role: *role,
                points: series.map(|p| [p[0], p[column]]).collect(),
            });
        }
        chart.render()
    };
    html! { (chart("Latitude", 1)) (chart("Longitude", 2)) }
}

fn parameters(diff: &RunDiff) -> Markup {
    html! {
        h2 { "Parameters" }
        p.hint { "The last column is the difference, divided by the root of the sum of both variances." }
        table {
            thead { tr {
                th { "Parameter" } th { "Unit" } th.n { "A" } th.n { "B" } th.n { "B − A" } th.n { "in σ" }
            } }
            tbody { @for row in &diff.parameters { tr {
                td.mono { (row.parameter) } td { (row.unit) }
                td.n { (number(Some(row.first))) } td.n { (number(Some(row.second))) }
                td.n { (number(Some(row.difference))) }
                td.n { (row.in_sigma.map_or_else(|| "–".to_owned(), |sigma| fixed(sigma, 2))) }
            } } }
        }
    }
}

/// Renders the difference between two campaigns.
#[must_use]
pub fn of_campaigns(diff: &CampaignDiff) -> String {
    let tests: Vec<_> =
        diff.comparison.tests.iter().filter(|test| test.change != Change::Same).collect();
    let body = html! {
        header {
            div.eyebrow { "Difference between two campaigns" }
            h1 { (if diff.equal { "Equal" } else { "Different" }) }
            @for (name, about) in ["A", "B"].iter().zip(&diff.campaigns) {
                p.lead { strong { (name) } " " (about.path.display()) ": " (about.cases) " cases, "
                    (about.program.as_deref().unwrap_or("program unknown")) }
            }
        }
        (settings(&diff.settings))
        h2 { "Measures" }
        @for pairing in &diff.comparison.pairings {
            p { (pairing.pairs) " pairs; " (pairing.changed_inputs) " with another scenario, "
                (pairing.changed_results) " with another result." }
        }
        @if let Some(case) = &diff.streams.first {
            p { (diff.streams.differing) " of " (diff.streams.pairs)
                " streams differ, the first is that of case " span.mono { (case) } "." }
        }
        p.hint { "Means of the pairs, Wilcoxon's test for measures and McNemar's for passes, p after Holm's \
            correction for all tests. " (diff.comparison.tests.len() - tests.len())
            " tests found no difference in any pair." }
        table {
            thead { tr {
                th { "Scenario" } th { "Measure" } th.n { "Pairs" } th.n { "A" } th.n { "B" }
                th.n { "B − A, 95 % interval" } th.n { "p" } th { "Shown" }
            } }
            tbody { @for test in &tests { tr {
                td { (test.scenario) } td.mono { (test.measure) } td.n { (test.pairs) }
                td.n { (significant(test.baseline, 5)) } td.n { (significant(test.tonight, 5)) }
                td.n { @if let Some([mean, low, high]) = test.difference {
                    (significant(mean, 3)) " (" (significant(low, 3)) " to " (significant(high, 3)) ")"
                } }
                td.n { (significant(test.p_adjusted, 2)) } td { (significance(test.change)) }
            } } }
        }
        div.pairs { @for measure in &diff.measures { (pairs(&measure.scenario, &measure.measure, &measure.values)) } }
    };
    page("Difference between two campaigns", &body)
}

/// Draws both campaigns pair by pair, sorted by the first.
fn pairs(scenario: &str, measure: &str, values: &[(f64, f64)]) -> Markup {
    let mut values = values.to_vec();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let title = format!("{scenario}: {measure}");
    let mut chart = Chart::new(&title, "pairs, in the order of A", &title);
    chart.hours = false;
    chart.paired = true;
    (chart.width, chart.height) = (480.0, 215.0);
    let points = |value: &dyn Fn(&(f64, f64)) -> f64| {
        values.iter().enumerate().map(|(i, v)| [1.0 + i as f64, value(v)]).collect()
    };
    let first = Line { label: "A".to_owned(), role: Role::Baseline, points: points(&|v| v.0) };
    let second = Line { label: "B".to_owned(), role: Role::Primary, points: points(&|v| v.1) };
    chart.lines = vec![first, second];
    chart.render()
}
