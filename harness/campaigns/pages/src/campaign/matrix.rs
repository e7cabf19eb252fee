//! Trace in both directions: from each requirement to its cases, and from each case to its
//! requirements.

use super::elements::{case_link, heading};
use super::requirements::check;
use maud::{Markup, html};
use octant_campaign::report::combination::shown;
use octant_campaign::report::{CampaignReport, ROWS_MAX};
use octant_report::page::badge;

pub(super) fn section(report: &CampaignReport<'_>, beside: Option<&str>) -> Markup {
    let trace = &report.trace;
    html! {
        (heading("trace"))
        p.hint { "A case leads to the file of its result. A campaign keeps no recordings: octant campaign case runs a \
            case again, to the same stream hash, with its recording and the report of a run." }
        h3 { "From requirements to cases" }
        @if trace.requirements.is_empty() { p.empty { "There is no requirement." } }
        @for row in &trace.requirements {
            details {
                summary {
                    strong { (row.id) } ": "
                    @match row.verdict { Some(verdict) => (badge(verdict)), None => span.soft { "not by a run" } }
                    " " (row.counts.all()) " cases, verified by " (row.verification)
                }
                p.reason { (row.reason) }
                p.cases {
                    @for link in row.cases.iter().take(ROWS_MAX) {
                        span.key { (case_link(&link.case, beside)) " "
                            @match link.verdict { Some(verdict) => (verdict.name()), None => "not run" } } " "
                    }
                }
                (rest(usize::try_from(row.counts.all()).unwrap_or(usize::MAX)))
            }
        }
        (missing("Requirements without a case", &trace.without_case, None))
        (missing("Cases without a requirement", &trace.without_requirement, beside))
        @if !report.status.not_by_test.is_empty() {
            h3 { "Requirements that no run verifies" }
            p { (report.status.not_by_test.join(", ")) }
        }
        h3 { "From cases to requirements" }
        (cases(report, beside))
    }
}

fn rest(all: usize) -> Markup {
    html! {
        @if all > ROWS_MAX {
            p.hint { (all - ROWS_MAX) " more: octant campaign trace lists all of them." }
        }
    }
}

fn missing(title: &str, ids: &[String], beside: Option<&str>) -> Markup {
    html! {
        h3 { (title) }
        @if ids.is_empty() { p { "None." } } @else {
            p.cases { @for id in ids.iter().take(ROWS_MAX) {
                @if beside.is_some() { (case_link(id, beside)) } @else { strong { (id) } } " "
            } }
            (rest(ids.len()))
        }
    }
}

fn cases(report: &CampaignReport<'_>, beside: Option<&str>) -> Markup {
    let requirements = &report.statistics.requirements;
    let mut worst_first: Vec<usize> = (0..report.rows.len()).collect();
    worst_first.sort_by_key(|place| std::cmp::Reverse(report.rows.verdict(*place)));
    worst_first.truncate(ROWS_MAX);
    html! {
        details {
            summary { (report.rows.len()) " cases, the worst first" }
            div.wide tabindex="0" role="region" aria-label="Cases" {
                table.filtered {
                    thead { tr {
                        th { "Case" } th { "Scenario and factors" } th.n { "Seed" } th.n { "Verdict" }
                        @for r in requirements { th.n { (r.id) } }
                        th style="padding-left:14px" { "Stream hash" }
                    } }
                    tbody { @for row in report.rows.at(worst_first) {
                        @let outcome = row.outcome.as_ref();
                        tr {
                            td { (case_link(&row.case.id, beside)) }
                            td { (row.case.scenario)
                                @for (name, value) in row.case.factors.iter() { "; " (name) " " (shown(value)) } }
                            td.n { (row.case.seed) }
                            td.n { (check(outcome.map(|outcome| outcome.verdict))) }
                            @for r in requirements { td.n {
                                @match octant_campaign::report::discrepancy::checks_of(report.plan, &row, &r.id) {
                                    Some(verdict) => (check(verdict)),
                                    None => "–",
                                }
                            } }
                            td.mono style="padding-left:14px" {
                                (outcome.and_then(|o| o.stream_hash.as_deref()).map_or("–", super::elements::short))
                            }
                        }
                    } }
                }
            }
            (rest(report.rows.len()))
        }
    }
}
