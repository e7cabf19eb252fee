//! Accounts of what came in from outside.

use maud::{Markup, html};
use octant_account::{Account, AccountEntry, Weight};
use octant_score::summary::Summary;

/// Renders the section; empty for a run without anything from outside.
pub(super) fn inputs(summary: &Summary) -> Markup {
    html! { @for account in &summary.inputs { (input(account)) } }
}

/// Renders an account: its headline, and a table of its entries.
#[must_use]
pub fn input(account: &Account) -> Markup {
    let entries: Vec<(&str, &AccountEntry)> = account.entries().collect();
    html! {
        p { (account.headline()) "." }
        @if let Some(clock) = account.clocked() { p.hint { "Clock: " (clock) "." } }
        @if !entries.is_empty() {
            table {
                thead { tr {
                    th { "" } th.n { "Number" } th { "Kind" } th { "The first" } th { "Effect on the verdict" }
                } }
                tbody {
                    @for (heading, entry) in entries {
                        tr {
                            td { (heading) }
                            td.n { @if entry.is_fact { "–" } @else { (entry.count) } }
                            td { (entry.kind) @if let Some(remedy) = &entry.remedy { "; " (remedy) } }
                            td { (entry.first.as_deref().unwrap_or("–")) }
                            td { (match entry.weight {
                                Weight::Doubt => "inconclusive",
                                Weight::Told => "none",
                            }) }
                        }
                    }
                }
            }
        }
    }
}
