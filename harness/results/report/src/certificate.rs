//! Certificate of a heading test: the first page of a report, one row for each requirement.
//!
//! [`page`] renders the rows that [`of_run`], or the report of a campaign, has made. Printed it is one page of A4.

use crate::data::ReportData;
use crate::page::badge;
use crate::units::unit;
use maud::{Markup, html};
use octant_base::number;
use octant_score::verdict::RequirementResult;
use octant_verdict::Verdict;

/// Maximum number of rows on one A4.
pub const ROWS_MAX: usize = 28;

/// Content of a certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Title of the run or the campaign.
    pub title: String,
    /// Lines below the title: conditions that are the same for all rows, or their values.
    pub lines: Vec<String>,
    /// Verdict of the run or the campaign.
    pub verdict: Verdict,
    /// The rows.
    pub rows: Vec<Row>,
}

/// Requirement with its result.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name of the test.
    pub test: String,
    /// Document and clause of origin; the id where there is none.
    pub clause: String,
    /// Condition; empty if the requirement wasn't tested.
    pub condition: String,
    /// Check with its value; `None` if nothing was checked.
    pub result: Option<RequirementResult>,
    /// Verdict; `None`: not tested.
    pub verdict: Option<Verdict>,
}

/// Returns whether a measure belongs on a certificate of headings.
#[must_use]
pub fn is_of_heading(measure: &str) -> bool {
    let path = measure.trim_matches('|');
    is_of_test(measure) || path.starts_with("navigation.heading_output.")
}

/// Returns whether a measure is of a heading test: a report with one has a certificate.
#[must_use]
pub fn is_of_test(measure: &str) -> bool {
    measure.trim_matches('|').starts_with("heading.")
}

/// Certificate of a run; `None` without a requirement on a heading test.
#[must_use]
pub fn of_run(data: &ReportData) -> Option<Certificate> {
    let all = &data.summary.requirements;
    if !all.iter().any(|result| is_of_test(&result.measure)) {
        return None;
    }
    let row = |result: &RequirementResult| {
        let text = data.requirement_texts.get(&result.id).filter(|text| !text.is_empty());
        Row {
            test: text.unwrap_or(&result.id).clone(),
            clause: data.requirement_clauses.get(&result.id).unwrap_or(&result.id).clone(),
            condition: data.heading_condition.clone(),
            verdict: Some(result.verdict),
            result: Some(result.clone()),
        }
    };
    let shown = all.iter().filter(|result| is_of_heading(&result.measure));
    Some(Certificate {
        title: data.summary.scenario.clone(),
        lines: vec![origin(data)],
        verdict: data.summary.verdict,
        rows: shown.map(row).collect(),
    })
}

/// Line that says who made a run, when, with which program, and what its evidence rests on.
fn origin(data: &ReportData) -> String {
    let hash = data.summary.stream_hash.clone();
    let own = [("seed", data.summary.seed.to_string()), ("stream hash", hash)];
    let own = own.iter().map(|(name, value)| format!("{name}: {value}"));
    let entries = data.provenance.entries.iter().map(|(name, value)| format!("{name}: {value}"));
    entries.chain(own).collect::<Vec<_>>().join("; ")
}

/// Renders a certificate as the first page of a report.
#[must_use]
pub fn page(certificate: &Certificate) -> Markup {
    let shown = certificate.rows.iter().take(ROWS_MAX);
    let further = certificate.rows.len().saturating_sub(ROWS_MAX);
    html! {
        section.certificate id="certificate" {
            div.top {
                div {
                    div.eyebrow { "Heading test" }
                    h2 { (certificate.title) }
                }
                (badge(certificate.verdict))
            }
            @for line in &certificate.lines { p.hint { (line) } }
            table {
                thead { tr {
                    th { "Test" } th { "Paragraph" } th { "Condition" } th.n { "Limit" } th.n { "Value" }
                    th.n { "Uncertainty" } th.n { "Verdict" }
                } }
                tbody { @for row in shown { (row_of(row)) } }
            }
            @if further > 0 {
                p.hint { (further) " more are among the requirements below." }
            }
            p.hint { "This page replaces no certificate: tests, measures and limits are those of the files named in the \
                provenance." }
        }
    }
}

fn row_of(row: &Row) -> Markup {
    html! {
        tr {
            td { (row.test) }
            td { (row.clause) }
            td { @if row.condition.is_empty() { "–" } @else { (row.condition) } }
            td.n { @match &row.result { Some(result) => (limit(result)), None => "–" } }
            td.n { (of(row, |result| result.value)) }
            td.n { (of(row, |result| result.uncertainty)) }
            td.n { @match row.verdict { Some(verdict) => (badge(verdict)), None => "not tested" } }
        }
    }
}

/// Number of a result with its unit, or a dash.
fn of(row: &Row, value: impl Fn(&RequirementResult) -> Option<f64>) -> String {
    let result = row.result.as_ref();
    result
        .and_then(|result| Some(with_unit(value(result)?, &result.measure)))
        .unwrap_or_else(|| "–".to_owned())
}

fn with_unit(value: f64, measure: &str) -> String {
    let value = number::plain(value, 4);
    match unit(measure) {
        "" => value,
        unit => format!("{value} {unit}"),
    }
}

/// Limit at the latitude of the test, and the figure that was written with its factor.
fn limit(result: &RequirementResult) -> Markup {
    let sign = match result.comparison.sign() {
        "<=" => "≤",
        ">=" => "≥",
        other => other,
    };
    html! {
        (sign) " " (with_unit(result.limit, &result.measure))
        @if let Some(written) = result.at_equator {
            div.reason { (with_unit(written, &result.measure)) " × sec φ" }
        }
    }
}
