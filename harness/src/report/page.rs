//! The frame of every page: one file, no network.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use octant_requirements::Verdict;

/// A whole page. The script reads out charts under the pointer; without it nothing is missing.
pub(crate) fn page(title: &str, body: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { (PreEscaped(include_str!("style.css"))) }
            }
            body {
                main { (body) }
                script { (PreEscaped(include_str!("hover.js"))) }
            }
        }
    }
    .into_string()
}

/// A verdict as a small label: colour, word and sign, so that none of them is needed alone.
pub(super) fn badge(verdict: Verdict) -> Markup {
    let sign = match verdict {
        Verdict::None => "–",
        Verdict::Pass => "✓",
        Verdict::Inconclusive => "?",
        Verdict::Fail => "✕",
        Verdict::Error => "!",
    };
    html! { span class={ "badge " (verdict.name()) } { span.sign { (sign) } " " (verdict.name()) } }
}
