//! Verdicts of the requirements: overall, and by combination.

use super::elements::heading;
use maud::{Markup, html};
use octant_base::number;
use octant_campaign::plan::looks::LookWay;
use octant_campaign::report::requirement::{self, CombinationChecks, RequirementFigures};
use octant_campaign::report::{CampaignReport, POLICY};
use octant_report::page::badge;
use octant_report::units::{PageUnit, is_of_place, shown, unit};
use octant_statistics::cluster::DrawCounts;
use octant_statistics::proportion::Needed;
use octant_verdict::Verdict;
use octant_verdict::requirement::percent;
use octant_verdict::trace::VerdictCounts;

pub(super) fn section(report: &CampaignReport<'_>) -> Markup {
    let all = &report.statistics.requirements;
    html! {
        (heading("requirements"))
        @if all.is_empty() {
            p.empty { "No requirement was checked: whatever happened, nothing is shown by it." }
        } @else {
            (table(report, all))
            @if all.iter().any(|r| unit_of(report, r).is_none()) {
                p.hint { "Limits of latitude and longitude stay in minutes of arc where the cases of their requirement \
                    have several sites: there a minute has several lengths." }
            }
            p.hint { "The bound is that of Clopper and Pearson on the probability that an independent draw passes in \
                all of its checks, one-sided" (bound_of(report)) ". Where nothing is asked of the draws together, every \
                check has to pass. " (POLICY) }
        }
        @if let Some(joint) = &report.statistics.joint { p { "All requirements together: " (joint.in_words()) "." } }
        @if !report.status.not_by_test.is_empty() {
            p { "Not verified by runs: " (report.status.not_by_test.join(", ")) "." }
        }
        @for doubt in &report.status.doubts { p { "Requirements may be missing: " (doubt) } }
        @for note in &report.notes { p.hint { (note) } }
        @if let Some(remark) = report.units.remark() { p.hint { (remark) } }
        @if !all.is_empty() && report.combinations.len() > 1 { (by_combination(report)) }
    }
}

/// Unit in which the limit of a requirement is shown; `None` if its cases have several sites, and the limit
/// has another length at each.
fn unit_of(report: &CampaignReport<'_>, r: &RequirementFigures) -> Option<PageUnit> {
    let measure = r.measure.as_deref().unwrap_or("");
    if !is_of_place(measure) {
        return Some(shown(measure, report.units.shown()));
    }
    let checks = |place: &usize| {
        let case = report.rows.case(*place);
        case.is_some_and(|case| requirement::checks(report.plan, &case.scenario, &r.id))
    };
    let cases = (0..report.rows.len()).filter(checks);
    report.units.at_all(cases).map(|units| shown(measure, &units))
}

/// Renders the requirements, the worst first.
fn table(report: &CampaignReport<'_>, all: &[RequirementFigures]) -> Markup {
    // In its own unit a limit is the same everywhere.
    let own = |r: &RequirementFigures| PageUnit {
        factor: 1.0,
        name: r.measure.as_deref().map_or("", unit).into(),
    };
    let mut worst_first: Vec<&RequirementFigures> = all.iter().collect();
    worst_first.sort_by_key(|r| std::cmp::Reverse(r.verdict));
    html! {
        div.wide tabindex="0" role="region" aria-label="Requirements" {
            table {
                thead { tr {
                    th { "Requirement" } th { "Has to hold" } th.n { "Checks" } th.n { "Draws" } th.n { "Bound" }
                    th.n { "Asked" } th.n { "More draws" } th.n { "Least margin" } th.n { "Verdict" }
                } }
                tbody { @for r in worst_first {
                    @let unit = unit_of(report, r).unwrap_or_else(|| own(r));
                    tr {
                    td { strong { (r.id) }
                        @if let Some(text) = &r.text { div.reason { (text) } }
                        @if let Some(clause) = &r.clause { div.reason { (clause) } } }
                    td {
                        @if let Some(measure) = &r.measure {
                            span.mono { (measure) } " " (sign(r.comparison.unwrap_or(""))) " "
                            (r.limit.map_or_else(String::new, |limit| number::plain(unit.of(limit), 6)))
                            " " (unit.name)
                            @if r.secant_latitude { " × sec φ" }
                        }
                        div.reason { (r.reason) }
                        @if r.asked.is_none() { @if let Some(claim) = &r.claim { div.reason { (claim) } } }
                    }
                    td.n { (checks(r.counts)) }
                    td.n { (draws(r.draws)) }
                    td.n { (share(r.lower_bound)) div.reason { "at " (percent(r.confidence)) } }
                    td.n { (r.asked.map_or_else(|| "every check".to_owned(), |asked| percent(asked.pass))) }
                    td.n { (needed(r, report.statistics.looks.is_open())) }
                    td.n {
                        @match &r.nearest {
                            Some(nearest) => {
                                (number::significant(unit.of(nearest.margin), 3)) " " (unit.name)
                                div.reason.mono { (nearest.case) }
                            }
                            None => "–",
                        }
                    }
                    td.n { (badge(r.verdict)) }
                    }
                } }
            }
        }
    }
}

fn sign(sign: &str) -> &str {
    match sign {
        "<=" => "≤",
        ">=" => "≥",
        other => other,
    }
}

/// Renders `84 of 90 pass`, and the verdicts of the others.
fn checks(counts: VerdictCounts) -> Markup {
    let VerdictCounts { pass, inconclusive, fail, error, missing } = counts;
    let all = pass + inconclusive + fail + error + missing;
    let others =
        [(fail, "fail"), (error, "error"), (inconclusive, "inconclusive"), (missing, "not run")];
    html! {
        @if all == 0 { "none" } @else { (pass) " of " (all) " pass" }
        @for (count, name) in others { @if count > 0 { div.reason { (count) " " (name) } } }
    }
}

/// Renders `84 of 84 pass`, and the number without a result.
fn draws(draws: DrawCounts) -> Markup {
    html! {
        (draws.passed) " of " (draws.all()) " pass"
        @if draws.unknown > 0 { div.reason { (draws.unknown) " came to nothing" } }
        @if draws.open > 0 { div.reason { (draws.open) " open" } }
    }
}

/// Renders a probability, always rounded down: a bound must not look better than it is.
fn share(bound: Option<f64>) -> String {
    let down = |p: f64| libm::floor(p * 1e4) / 1e2;
    bound.map_or_else(|| "–".to_owned(), |p| format!("{} %", number::fixed(down(p), 2)))
}

/// Says how the bound holds for the looks of the campaign.
fn bound_of(report: &CampaignReport<'_>) -> &'static str {
    match report.plan.look_way(report.statistics.looks.claim_cases) {
        LookWay::Once => "",
        LookWay::Planned(_) | LookWay::Stop(_) => {
            ", with a part of the error for each look; the verdict is that of the exact boundary where looks are planned"
        }
        LookWay::Open => {
            ", or, where a probability is asked, the open one, which holds whenever it is looked at"
        }
    }
}

fn needed(r: &RequirementFigures, is_open: bool) -> Markup {
    let text = |needed: Needed| match needed {
        Needed::Runs(runs) => runs.to_string(),
        Needed::CannotBeMet => "cannot be met".to_owned(),
    };
    html! {
        @match (r.needed_if_all_pass, r.needed_at_rate) {
            (None, _) => "–",
            (Some(all), rate) => {
                (text(all))
                @if all != Needed::Runs(0) {
                    div.reason { "if all pass" @if !is_open { ", in a new plan" } }
                }
                @if let Some(rate) = rate.filter(|rate| *rate != all) {
                    div.reason { (text(rate)) " at this rate" }
                }
            }
        }
    }
}

/// Renders requirements by combination. The draws of a combination are its cases; over all
/// combinations they are the replicates.
fn by_combination(report: &CampaignReport<'_>) -> Markup {
    let all = &report.statistics.requirements;
    let class = |part: &CombinationChecks| match part.counts {
        VerdictCounts { fail: 0, error: 0, inconclusive: 0, missing: 0, .. } => "n",
        _ => "n over",
    };
    html! {
        h3 { "By combination" }
        p.hint { "The cases of a replicate have the same instrument, noise and faults in every combination. Within \
            one combination they are independent draws, and the bound is of that combination alone; over all of them a draw \
            passes if it does in every combination, and the number of draws is that of the replicates." }
        div.wide tabindex="0" role="region" aria-label="Requirements by combination" {
            table {
                thead { tr {
                    th { "Combination" }
                    @for r in all { th.n { (r.id) " passed" } th.n { "bound" } }
                } }
                tbody { @for (place, combination) in report.combinations.iter().enumerate() { tr {
                    td { (combination.name()) }
                    @for r in all {
                        @match r.combinations.get(place) {
                            Some(part) if total(part.counts) > 0 => {
                                td class=(class(part)) { (part.counts.pass) " of " (total(part.counts)) }
                                td.n { (share(part.lower_bound)) }
                            }
                            _ => { td.n { "–" } td.n { "–" } }
                        }
                    }
                } } }
            }
        }
    }
}

fn total(counts: VerdictCounts) -> u64 {
    let VerdictCounts { pass, inconclusive, fail, error, missing } = counts;
    pass + inconclusive + fail + error + missing
}

/// Renders the verdict of a check in a case; `None` if it hasn't run.
pub(super) fn check(verdict: Option<Verdict>) -> Markup {
    html! { @match verdict { Some(verdict) => (badge(verdict)), None => span.soft { "not run" } } }
}
