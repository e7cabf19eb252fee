//! Requirements of a run: verdict, value, limit, margin, unit and text, in sight on every screen.

use super::data::ReportData;
use super::page::badge;
use super::units::shown;
use maud::{Markup, html};
use octant_base::number;
use octant_score::verdict::RequirementResult;

/// Renders the requirements, the worst first.
pub(super) fn requirements(data: &ReportData) -> Markup {
    let summary = &data.summary;
    let mut worst_first: Vec<&RequirementResult> = summary.requirements.iter().collect();
    worst_first.sort_by_key(|r| std::cmp::Reverse(r.verdict));
    html! {
        @if let Some(decided) = &summary.decision {
            p.hint { (decided.text) "." }
        }
        @if worst_first.is_empty() {
            p.empty { "No requirement was checked: the run shows what happened, and asks nothing of it." }
        } @else {
            table.cards.requirements {
                thead { tr {
                    th { "Verdict" } th { "Requirement" } th.n { "Value" } th.n { "Limit" } th.n { "Margin" }
                    th.unit { "Unit" }
                } }
                tbody { @for r in worst_first { (row(data, r)) } }
            }
        }
    }
}

fn row(data: &ReportData, r: &RequirementResult) -> Markup {
    let text = data.requirement_texts.get(&r.id).filter(|text| !text.is_empty());
    let unit = shown(&r.measure, &data.units);
    let significant = |value: Option<f64>, digits| {
        value.map_or_else(|| "–".to_owned(), |v| number::significant(unit.of(v), digits))
    };
    html! {
        tr id={ "req-" (r.id) } {
            td.verdict { (badge(r.verdict)) }
            td.text {
                strong { (r.id) }
                @if let Some(text) = text { " " (text) }
                div.reason { span.mono { (r.measure) } }
                @if let Some(reason) = &r.reason { div.reason { (reason) } }
            }
            td.n data-label="Value" { (significant(r.value, 4)) }
            td.n data-label="Limit" {
                (sign(r.comparison.sign())) " " (number::plain(unit.of(r.limit), 4))
                @if let Some(limit) = r.at_equator {
                    " (" (number::plain(unit.of(limit), 4)) " × sec φ)"
                }
                @if let Some(u) = r.uncertainty { " ± " (number::plain(unit.of(u), 3)) }
            }
            td.n data-label="Margin" { (significant(r.margin, 3)) }
            td.unit data-label="Unit" { @if unit.name.is_empty() { "1" } @else { (unit.name) } }
        }
    }
}

/// Sign of a comparison as it is printed.
fn sign(sign: &str) -> &str {
    match sign {
        "<=" => "≤",
        ">=" => "≥",
        other => other,
    }
}
