//! Frame of every page: one file, no network access.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use octant_requirements::Verdict;

/// Renders a whole page. The script shows chart values under the pointer; without it no content is
/// missing.
pub fn page(title: &str, body: &Markup) -> String {
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

/// Renders a verdict as a small label: colour, word and sign, so that none is needed alone.
pub fn badge(verdict: Verdict) -> Markup {
    let sign = match verdict {
        Verdict::None => "–",
        Verdict::Pass => "✓",
        Verdict::Inconclusive => "?",
        Verdict::Fail => "✕",
        Verdict::Error => "!",
    };
    html! { span class={ "badge " (verdict.name()) } { span.sign { (sign) } " " (verdict.name()) } }
}
