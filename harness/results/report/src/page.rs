//! Frame of every page: one file, no network access.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use octant_base::printable::printable;
use octant_verdict::Verdict;
use std::borrow::Cow;

/// Parts of the script, in the order in which they need each other.
const SCRIPT: [&str; 6] = [
    include_str!("script/pyramid.js"),
    include_str!("script/axis.js"),
    include_str!("script/plot.js"),
    include_str!("script/marks.js"),
    include_str!("script/linked.js"),
    include_str!("script/page.js"),
];

/// Parts of the style sheet.
const STYLE: [&str; 3] = [
    include_str!("style/page.css"),
    include_str!("style/plot.css"),
    include_str!("style/narrow.css"),
];

/// Renders a whole page. The script adds zoom, cursor and switches to the charts; without it no content
/// is missing. Text from outside may be anywhere in the body: nothing in the page acts, and XML allows every character.
pub fn page(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (title) }
                style { @for part in STYLE { (PreEscaped(part)) } }
            }
            body {
                main { (body) }
                // Characters of XML are plain text in here, so that tools for XML read the page too.
                script {
                    (PreEscaped("//<![CDATA[\n(() => {\n\"use strict\";\n"))
                    @for part in SCRIPT { (PreEscaped(part)) }
                    (PreEscaped("})();\n//]]>"))
                }
            }
        }
    }
    .into_string();
    match printable(&page) {
        Cow::Borrowed(_) => page,
        Cow::Owned(page) => page,
    }
}

/// A section of a page, with an anchor and an entry in the contents.
#[derive(Debug)]
pub struct Section {
    /// Anchor.
    pub id: &'static str,
    /// Heading.
    pub title: String,
    /// Content; a section without content is left out.
    pub body: Markup,
}

impl Section {
    /// Makes a section.
    #[must_use]
    pub fn new(id: &'static str, title: &str, body: Markup) -> Self {
        Self { id, title: title.to_owned(), body }
    }
}

/// Renders contents and sections; sections without content are left out.
#[must_use]
pub fn sections(all: &[Section]) -> Markup {
    let present = || all.iter().filter(|section| !section.body.0.is_empty());
    html! {
        nav.contents aria-label="Contents" {
            @for section in present() { a href={ "#" (section.id) } { (section.title) } " " }
        }
        @for section in present() {
            section {
                h2 id=(section.id) { (section.title) " " a.anchor href={ "#" (section.id) } aria-label="Link to this section" { "#" } }
                (section.body)
            }
        }
    }
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
