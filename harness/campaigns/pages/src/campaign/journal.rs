//! Looks at the results, and the journal of the campaign.

use super::elements::heading;
use maud::{Markup, html};
use octant_campaign::report::CampaignReport;

/// Maximum number of entries that are shown.
const SHOWN: usize = 200;

/// Renders the seed, the looks, and every entry of the journal.
pub(super) fn section(report: &CampaignReport<'_>) -> Markup {
    let statistics = &report.statistics;
    let entries = &report.journal;
    html! {
        (heading("journal"))
        p { (first_upper(&statistics.seed)) ". " (first_upper(&statistics.looks.in_words())) "." }
        @if entries.is_empty() {
            p.empty { "The folder has no journal: nobody knows how often the results were looked at." }
        } @else {
            div.wide tabindex="0" role="region" aria-label="Journal" {
                table {
                    thead { tr { th { "Time, UTC" } th { "What" } th { "By" } th { "Program, SHA-256" } } }
                    tbody { @for entry in entries.iter().take(SHOWN) { tr {
                        td.mono { (entry.at) }
                        td { (entry.event.in_words()) }
                        td { (entry.by.operator.as_deref().unwrap_or("not known")) " on " (entry.by.host) }
                        td.mono { (entry.by.program_sha256.as_deref().map_or("not known", super::elements::short)) }
                    } } }
                }
            }
            @if entries.len() > SHOWN { p.hint { (entries.len() - SHOWN) " more are in campaign.journal." } }
            p.hint { "Other folders, and other seeds that were tried in them, can't be seen from here." }
        }
    }
}

fn first_upper(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string());
    first.unwrap_or_default() + letters.as_str()
}
