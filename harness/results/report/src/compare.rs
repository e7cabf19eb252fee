//! Renders `compare.html` and the plain text of `octant compare`.

use super::chart::{Chart, Line, Role};
use super::page::page;
use maud::{Markup, html};
use octant_base::display::{DisplayUnits, ShownUnit};
use octant_base::number;
use octant_score::compare::{Claim, MeasureCell, MethodComparison, Refusals, interval, percent};
use octant_statistics::sample::ConfidenceInterval;

/// Renders the comparison as text for a terminal.
#[must_use]
pub fn table(comparison: &MethodComparison, units: &DisplayUnits) -> String {
    let width = comparison.first.len().max(comparison.second.len()).max(8);
    let mut text = format!(
        "{:<27}{:>w$}{:>w$}{:>8}{:>13}  90 % interval\n",
        "rms of maxima",
        comparison.first,
        comparison.second,
        "floor",
        "improvement",
        w = width + 2
    );
    for cell in &comparison.cells {
        let unit = units.of(cell.measure.error());
        let d = unit.decimals;
        text.push_str(&format!(
            "{:<27}{:>w$.d$}{:>w2$.d$}{:>8}{:>11} %  {}\n",
            format!("{}, {}", cell.measure.name(), unit.name),
            unit.of(cell.first),
            unit.of(cell.second),
            cell.floor.map_or_else(|| "–".to_owned(), |f| format!("{:.d$}", unit.of(f))),
            percent(cell.improvement.value),
            interval(&cell.improvement),
            w = width + 2,
            w2 = width + 2
        ));
    }
    for words in &comparison.words {
        text.push('\n');
        text.push_str(words);
    }
    text.push('\n');
    text
}

/// Renders the comparison as one HTML file.
#[must_use]
pub fn render(
    comparison: &MethodComparison,
    provenance: &[(String, String)],
    units: &DisplayUnits,
) -> String {
    let claim = comparison.cells.iter().rfind(|c| c.measure.is_longitude()).map(|c| c.claim);
    let class = match claim {
        Some(Claim::Holds) => "pass",
        Some(Claim::Worse) => "fail",
        _ => "inconclusive",
    };
    let body = html! {
        header {
            div.eyebrow { "Comparison of two methods" }
            h1 { (comparison.scenario) }
            p.lead { (comparison.second) " against " (comparison.first) ": "
                (comparison.runs.len()) " pairs of runs, the same instrument and the same noise in both of a pair." }
            div class={ "claim " (class) } {
                @for (i, words) in comparison.words.iter().enumerate() {
                    @if i == 0 { p.lead { strong { (capital(words)) "." } } } @else { p { (capital(words)) "." } }
                }
            }
        }
        @if let Some(refusals) = &comparison.refusals { (refused(comparison, refusals)) }
        h2 { "Improvement" }
        p.hint { "Root mean square over seeds of the largest error of each run. Improvement is 1 − ratio, \
            with its 90 % interval by Student's distribution, of the logarithm of the ratio, with the standard error \
            of the jackknife. Floor: exact parameters and attitude, \
            noise of the sensors alone." }
        (cells(comparison, units))
        h2 { "Every pair" }
        div.pairs { @for cell in &comparison.cells { (pairs(comparison, cell, units)) } }
        (runs(comparison, units))
        h2 { "Provenance" }
        table { tbody {
            tr { td { "octant" } td.mono { (comparison.octant) } }
            @for (name, value) in provenance { tr { td { (name) } td.mono { (value) } } }
        } }
    };
    page(&format!("{}: comparison", comparison.scenario), &body)
}

/// Renders the refusals of each method.
fn refused(comparison: &MethodComparison, refusals: &Refusals) -> Markup {
    let row = |name: &str, count: u64, rate: &ConfidenceInterval| {
        html! { tr {
            td { (name) } td.n { (count) " of " (refusals.seeds) } td.n { (percent(rate.value)) " %" }
            td.n { (percent(rate.low)) " to " (percent(rate.high)) " %" }
        } }
    };
    html! {
        h2 { "Refused calibrations" }
        table {
            thead { tr { th { "Method" } th.n { "Seeds" } th.n { "Rate" } th.n { "95 % interval" } } }
            tbody {
                (row(&comparison.first, refusals.first, &refusals.first_rate))
                (row(&comparison.second, refusals.second, &refusals.second_rate))
            }
        }
        p.hint { "Clopper and Pearson. Everything below is of the seeds that neither refused." }
    }
}

/// Capitalises the first letter, and keeps numbers on one line with their per cent sign.
fn capital(words: &str) -> String {
    let words = words.replace(" %", "\u{a0}%");
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |c| c.to_uppercase().chain(letters).collect())
}

fn cells(comparison: &MethodComparison, units: &DisplayUnits) -> Markup {
    html! {
        table {
            thead { tr {
                th { "Largest error" }
                th.n { span.baseline-text { (comparison.first) } }
                th.n { span.primary-text { (comparison.second) } }
                th.n { "Floor" } th.n { "Improvement" } th.n { "90 % interval" }
                th.strip { svg viewBox="0 0 200 16" aria-hidden="true" {
                    @for n in [-50, 0, 50, 100] {
                        text class="tick x" x=(place(f64::from(n) / 100.0)) y="13" { (number::fixed(f64::from(n), 0)) " %" }
                    }
                } }
            } }
            tbody { @for cell in &comparison.cells {
                @let unit = units.of(cell.measure.error());
                tr {
                    td { (capital(cell.measure.name())) ", " (unit.name) }
                    td.n { (number::fixed(unit.of(cell.first), unit.decimals)) }
                    td.n { (number::fixed(unit.of(cell.second), unit.decimals)) }
                    td.n { (number::optional(cell.floor.map(|f| unit.of(f)), unit.decimals)) }
                    td.n { strong { (percent(cell.improvement.value)) " %" } }
                    td.n { (percent(cell.improvement.low)) " to " (percent(cell.improvement.high)) " %" }
                    td.strip { (whisker(cell)) }
                }
            } }
        }
    }
}

/// Returns the place of an improvement on a strip of 200 px from −60 % to 120 %.
fn place(fraction: f64) -> f64 {
    libm::round((fraction.clamp(-0.6, 1.0) + 0.6) / 1.8 * 2000.0) / 10.0
}

fn whisker(cell: &MeasureCell) -> Markup {
    let i = &cell.improvement;
    html! {
        svg viewBox="0 0 200 16" aria-hidden="true" {
            rect.sigma3 x=(place(0.5)) y="1" width=(place(1.0) - place(0.5)) height="14" {}
            path.centre d={ "M" (place(0.0)) " 0V16" } {}
            path.whisker d={ "M" (place(i.low)) " 8H" (place(i.high)) } {}
            circle class="dot primary" cx=(place(i.value)) cy="8" r="4.2" {}
        }
    }
}

/// Draws both methods seed by seed, sorted by the first, so that the pairs are visible.
fn pairs(comparison: &MethodComparison, cell: &MeasureCell, units: &DisplayUnits) -> Markup {
    let unit = units.of(cell.measure.error());
    let mut values: Vec<(f64, f64)> = comparison
        .runs
        .iter()
        .filter_map(|r| r.first.get(cell.measure).zip(r.second.get(cell.measure)))
        .map(|(first, second)| (unit.of(first), unit.of(second)))
        .collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let series = |f: &dyn Fn(&(f64, f64)) -> f64| {
        values.iter().enumerate().map(|(i, v)| [1.0 + i as f64, f(v)]).collect::<Vec<_>>()
    };
    let title = format!("Largest error, {}, {}", cell.measure.name(), unit.name);
    let mut chart = Chart::new(&title, "pairs, in the order of the first method", &title);
    chart.hours = false;
    chart.paired = true;
    (chart.width, chart.height) = (480.0, 215.0);
    let highest = values.iter().map(|v| v.0.max(v.1)).fold(0.0, f64::max);
    chart.y_range = Some([0.0, 1.08 * highest]);
    if let Some(floor) = cell.floor {
        chart.levels.push((unit.of(floor), "floor".to_owned()));
    }
    chart.lines.push(Line {
        label: comparison.first.clone(),
        role: Role::Baseline,
        points: series(&|v| v.0),
    });
    chart.lines.push(Line {
        label: comparison.second.clone(),
        role: Role::Primary,
        points: series(&|v| v.1),
    });
    chart.render()
}

fn runs(comparison: &MethodComparison, units: &DisplayUnits) -> Markup {
    let unit = |cell: &MeasureCell| units.of(cell.measure.error());
    html! {
        table {
            thead { tr { th { "Seed" } @for cell in &comparison.cells {
                th.n { (cell.measure.name()) ", " (unit(cell).name) " " span.baseline-text { (comparison.first) } }
                th.n { span.primary-text { (comparison.second) } }
            } } }
            tbody { @for run in &comparison.runs {
                tr { td.mono { (run.seed) } @for cell in &comparison.cells {
                    (one(run.first.get(cell.measure), unit(cell), run.first_refused.as_deref()))
                    (one(run.second.get(cell.measure), unit(cell), run.second_refused.as_deref()))
                } }
            } }
        }
    }
}

/// Renders an error, or that the calibration was refused.
fn one(value: Option<f64>, unit: ShownUnit, refused: Option<&str>) -> Markup {
    html! { @match refused {
        Some(reason) => td.n title=(reason) { "refused" },
        None => td.n { (number::optional(value.map(|v| unit.of(v)), unit.decimals)) },
    } }
}
