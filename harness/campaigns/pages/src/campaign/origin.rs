//! Origin of a campaign and its page: who made them, when, with which program, and what the evidence rests on: a page that is printed has
//! nothing else beside it.

use maud::{Markup, html};
use octant_base::utc;
use octant_campaign::journal::JournalEvent;
use octant_campaign::report::CampaignReport;
use octant_evidence::build;
use octant_evidence::manifest::program_sha256;

/// Names and values, the same for the same results, program and key.
pub(super) fn entries(report: &CampaignReport<'_>) -> Vec<(String, String)> {
    let statistics = &report.statistics;
    let unknown = || "not known".to_owned();
    let mut all: Vec<(String, String)> = Vec::new();
    let mut add = |name: &str, value: String| all.push((name.to_owned(), value));
    for made in &report.made_by {
        let who = made.maker.as_ref().map_or_else(unknown, |maker| {
            format!(
                "{} on {}, octant {}, SHA-256 {}",
                maker.operator.as_deref().unwrap_or("operator not known"),
                maker.host,
                maker.octant,
                maker.program_sha256.as_deref().unwrap_or("not known")
            )
        });
        add(&format!("{} results by", made.results), who);
    }
    if let [Some(first), Some(last)] = report.run_between {
        add("results stored", format!("{} to {}", utc::seconds(first), utc::seconds(last)));
    }
    let looks = report.journal.iter().rev();
    let look = looks.into_iter().find(|entry| matches!(entry.event, JournalEvent::Look { .. }));
    if let Some(entry) = look {
        let who = entry.by.operator.as_deref().unwrap_or("operator not known");
        add("last look", format!("{}, {who} on {}", entry.at, entry.by.host));
    }
    let made = build::this();
    let commit = if made.git_commit.is_empty() { "not known" } else { made.git_commit };
    let changes = if made.is_git_dirty { ", with local changes" } else { "" };
    add("page made by octant", env!("CARGO_PKG_VERSION").to_owned());
    add("source revision", format!("{commit}{changes}"));
    add("program, SHA-256", program_sha256().unwrap_or_else(unknown));
    add("plan", report.plan.id.clone());
    add("seed", statistics.seed.strip_prefix("seed ").unwrap_or(&statistics.seed).to_owned());
    add("results, BLAKE3", statistics.results_blake3.clone());
    add("signature", report.signature.clone().unwrap_or_else(|| "unsigned".to_owned()));
    all
}

/// Renders the entries as a table.
pub(super) fn table(report: &CampaignReport<'_>) -> Markup {
    html! {
        table.origin {
            tbody { @for (name, value) in entries(report) { tr { td { (name) } td.mono { (value) } } } }
        }
    }
}

/// Renders the entries as a line of a certificate.
pub(super) fn line(report: &CampaignReport<'_>) -> String {
    let entries = entries(report);
    let words: Vec<String> =
        entries.iter().map(|(name, value)| format!("{name}: {value}")).collect();
    words.join("; ")
}
