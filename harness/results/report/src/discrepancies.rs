//! Discrepancies with their dispositions: a section of the pages of runs and campaigns.

use super::page::badge;
use maud::{Markup, html};
use octant_evidence::discrepancy::Discrepancy;
use octant_evidence::disposition::Dispositions;

/// Renders all discrepancies with their dispositions. `hint` tells where the dispositions are,
/// `list` renders cases.
pub fn table(
    all: &[Discrepancy],
    dispositions: &Dispositions,
    hint: &str,
    list: &dyn Fn(&[String]) -> Markup,
) -> Markup {
    let gone = dispositions.gone(all);
    html! {
        @if all.is_empty() {
            p { "There is none." }
        } @else {
            p { (all.len()) " in all, " strong { (dispositions.open(all).count()) " without a disposition" } "." }
            p.hint { (hint) }
            table.discrepancies {
                thead { tr { th { "Discrepancy" } th { "What" } th.n { "Verdict" } th style="padding-left:14px" { "Disposition" } } }
                tbody { @for found in all {
                    @let entry = dispositions.of(&found.id);
                    tr id=(found.id) {
                        td { strong.mono { (found.id) }
                            @if let Some(requirement) = &found.requirement { div.reason { (requirement) } } }
                        td { (found.what)
                            @if !found.cases.is_empty() { (list(&found.cases)) } }
                        td.n { (badge(found.verdict)) }
                        td style="padding-left:14px" {
                            @match entry.filter(|entry| !entry.is_open()) {
                                Some(entry) => {
                                    (entry.disposition.trim())
                                    @if !entry.by.trim().is_empty() { div.reason { (entry.by.trim()) } }
                                }
                                None => strong.over { "open" },
                            }
                        }
                    }
                } }
            }
        }
        @if !gone.is_empty() {
            h3 { "No longer occurring" }
            p.hint { "Entries of the file of which these results show nothing." }
            table {
                thead { tr { th { "Discrepancy" } th { "What it was" } th { "Disposition" } } }
                tbody { @for entry in gone { tr {
                    td { span.mono { (entry.id) } div.reason { "not occurring" } }
                    td { (entry.what) }
                    td { @if entry.is_open() { span.soft { "none" } } @else { (entry.disposition.trim()) }
                        @if !entry.by.trim().is_empty() { div.reason { (entry.by.trim()) } } }
                } } }
            }
        }
    }
}
