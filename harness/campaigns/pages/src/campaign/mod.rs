//! `report.html` of a campaign: for the reader who assesses it, and the one who writes the
//! dispositions.
//!
//! The page is one file without network access, and no content depends on a script. Hosts, persons and times on it are
//! those of the stored results and of the journal: the same folder, program and key give the same bytes.

mod certificate;
mod convergence;
mod drift;
mod effects;
mod elements;
mod findings;
mod journal;
mod matrix;
mod origin;
mod prediction;
mod requirements;
mod sensitivity;

use elements::{SECTIONS, heading, short};
use maud::{Markup, html};
use octant_base::number;
use octant_campaign::report::{CampaignReport, again};
use octant_report::inputs::input;
use octant_report::page::{badge, page};
use octant_verdict::Verdict;

/// Renders the report as one HTML file. `beside` tells that it is in the folder of the campaign:
/// then each case has the command that shows its result.
#[must_use]
pub fn render(report: &CampaignReport<'_>, beside: bool) -> String {
    let verdict = report.statistics.verdict;
    let beside = beside.then_some(report.name.as_str());
    let body = html! {
        a.skip href="#requirements" { "To the requirements" }
        (certificate::first_page(report))
        (header(report))
        (contents())
        (figures(report))
        (requirements::section(report))
        (drift::table(report))
        (drift::envelopes(report))
        (effects::section(report))
        (prediction::section(report))
        (convergence::section(report))
        (sensitivity::section(report))
        (findings::section(report, beside))
        (findings::discrepancies(report, beside))
        (matrix::section(report, beside))
        (journal::section(report))
        (provenance(report))
    };
    page(&format!("{}: {}", report.plan.title, verdict.name()), &body)
}

fn contents() -> Markup {
    html! {
        nav.contents aria-label="Sections" {
            @for (anchor, name) in SECTIONS { a href={ "#" (anchor) } { (name) } " " }
        }
    }
}

fn header(report: &CampaignReport<'_>) -> Markup {
    let statistics = &report.statistics;
    html! {
        header {
            div.top {
                div {
                    div.eyebrow { "Campaign" }
                    h1 { (report.plan.title) }
                    p.lead { (what_was_done(report)) }
                }
                (badge(statistics.verdict))
            }
            ul.reasons { @for reason in report.reasons() { li { (reason) } } }
            dl.facts {
                div { dt { "Plan" } dd.mono { (short(&report.plan.id)) } }
                div { dt { "Results, BLAKE3" } dd.mono { (short(&statistics.results_blake3)) } }
                @for verdict in Verdict::ALL {
                    @if let Some(count) = statistics.verdicts.get(verdict.name()) {
                        div { dt { "Cases: " (verdict.name()) } dd { (count) } }
                    }
                }
                div { dt { "Open discrepancies" } dd { (report.open()) } }
                div { dt { "Self-test" } dd {
                    @match &report.selftest {
                        Some(test) => {
                            (test.verdict.name())
                            @if let Some(at) = &test.at { ", " (at) }
                        }
                        None => "none in the folder",
                    }
                } }
            }
        }
    }
}

/// Summarises the cases and their results.
fn what_was_done(report: &CampaignReport<'_>) -> String {
    let statistics = &report.statistics;
    let run = statistics.cases - statistics.open;
    let count =
        |count: usize, name: &str| format!("{count} {name}{}", if count == 1 { "" } else { "s" });
    let mut text = format!(
        "{} of {} have run, of {} in {}.",
        run,
        count(statistics.cases, "case"),
        count(report.plan.scenarios.len(), "scenario"),
        count(report.combinations.len(), "combination"),
    );
    if statistics.cases < report.plan.cases.len() {
        text += &format!(" {} were planned.", report.plan.cases.len());
    }
    if let Some(stopped) = &report.status.stopped {
        text += &format!(" {stopped}.");
    }
    text
}

fn figures(report: &CampaignReport<'_>) -> Markup {
    let statistics = &report.statistics;
    let all = statistics.requirements.len();
    let shown = statistics.requirements.iter().filter(|r| r.verdict == Verdict::Pass).count();
    let worst =
        |f: &dyn Fn(&octant_campaign::report::figures::CombinationFigures) -> Option<f64>| {
            statistics.combinations.iter().filter_map(f).max_by(f64::total_cmp)
        };
    let r95 = worst(&|figures| Some(figures.at_end?.r95.value));
    let rate = worst(&|figures| Some(figures.rate_nmi_per_h?.rate95.value));
    let discrepancies = statistics.discrepancies.len();
    let unit = report.units.shown().radial();
    let figure = |name: &str, value: String, unit: &str, other: String| {
        html! {
            div.figure {
                div.name { (name) }
                div.value { (value) @if !unit.is_empty() { span.unit { (unit) } } }
                @if !other.is_empty() { div.hint { (other) } }
            }
        }
    };
    html! {
        div.figures {
            (figure("Requirements shown", format!("{shown} of {all}"), "", String::new()))
            (figure("Cases run", format!("{} of {}", statistics.cases - statistics.open, statistics.cases), "", String::new()))
            @if let Some(r95) = r95 {
                (figure("R95, the worst combination", number::significant(unit.of(r95), 3), unit.name, String::new()))
            }
            @if let Some(rate) = rate {
                (figure("Drift, 95 %, the worst", number::significant(unit.of(rate), 3), &format!("{}/h", unit.name), String::new()))
            }
            (figure("Discrepancies", discrepancies.to_string(), "", format!("{} without a disposition", report.open())))
        }
    }
}

fn provenance(report: &CampaignReport<'_>) -> Markup {
    let file = &report.plan.campaign;
    // The folder of a bundle may be anywhere, and be gone after this.
    let campaign = match (&report.plan.bundled, file.file_name()) {
        (Some(_), Some(name)) => format!("{}, from a bundle", name.to_string_lossy()),
        _ => file.display().to_string(),
    };
    html! {
        (heading("provenance"))
        (origin::table(report))
        table {
            tbody {
                tr { td { "campaign" } td.mono { (campaign) } }
                @for scenario in &report.plan.scenarios {
                    tr { td { "scenario " (scenario.id) ", BLAKE3" } td.mono { (scenario.blake3) } }
                }
                @for (table, hash) in &report.tables {
                    tr { td { (table) ", BLAKE3" } td.mono { (hash) } }
                }
                @if let Some(test) = &report.selftest {
                    tr { td { "self-test" } td.mono {
                        (test.verdict.name())
                        @if let Some(sha256) = &test.program_sha256 { ", of the program with SHA-256 " (sha256) }
                    } }
                }
            }
        }
        @for account in &report.statistics.inputs { (input(account)) }
        @if report.tables.is_empty() {
            p.hint { "The tables have not been merged: octant campaign merge makes cases.parquet, \
                checks.parquet and drift.parquet." }
        }
        p.hint { "The hash of every file of the folder, and who made this page when, stand in manifest.json: octant \
            verify holds them against it. The numbers of this page are in statistics.json" @if !report.units.are_default() { " (in arcmin, nmi and m/s)" } ", every check in \
            junit.xml." }
        p.hint { "The same campaign again; the results have to come to the same hash:" }
        code.rerun { (again(report)) }
    }
}
