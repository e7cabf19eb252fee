//! Elements that several sections of the page have: headings, links, estimates.

use maud::{Markup, html};
use octant_base::display::ShownUnit;
use octant_base::number;
use octant_evidence::manifest::shell_line;
use octant_statistics::sample::ConfidenceInterval;

/// Sections of the page: anchor and heading.
pub(super) const SECTIONS: [(&str, &str); 12] = [
    ("requirements", "Requirements"),
    ("drift", "Drift"),
    ("envelopes", "Errors over time"),
    ("effects", "Effects of faults"),
    ("prediction", "Predicted and simulated"),
    ("convergence", "Convergence"),
    ("sensitivity", "Sensitivity"),
    ("findings", "Cases to look at"),
    ("discrepancies", "Discrepancies"),
    ("trace", "Trace"),
    ("journal", "Looks and journal"),
    ("provenance", "Provenance"),
];

/// Renders a heading with an anchor.
pub(super) fn heading(anchor: &str) -> Markup {
    let name = SECTIONS.iter().find(|(id, _)| *id == anchor).map_or(anchor, |(_, name)| name);
    html! { h2 id=(anchor) { (name) } }
}

/// Returns the first digits of a hash.
pub(super) fn short(hash: &str) -> &str {
    hash.get(..16).unwrap_or(hash)
}

/// Renders a case, with the command that shows its result if the page is in the folder of its campaign:
/// `beside` is the name of that folder.
pub(super) fn case_link(case: &str, beside: Option<&str>) -> Markup {
    html! {
        @if let Some(folder) = beside {
            @let words = ["octant", "campaign", "result", folder, case].map(str::to_owned);
            span.mono title=(shell_line(&words)) { (case) }
        } @else {
            span.mono { (case) }
        }
    }
}

/// Renders an estimate with its interval, in another unit.
pub(super) fn with_bounds_in(interval: &ConfidenceInterval, unit: ShownUnit) -> Markup {
    let ConfidenceInterval { value, low, high } = *interval;
    let [value, low, high] = [value, low, high].map(|value| unit.of(value));
    with_bounds(&ConfidenceInterval { value, low, high })
}

/// Renders an estimate with its interval.
pub(super) fn with_bounds(interval: &ConfidenceInterval) -> Markup {
    let end = |value: f64| {
        if value.is_finite() { number::significant(value, 3) } else { "∞".to_owned() }
    };
    let low = if interval.low.is_finite() {
        number::significant(interval.low, 3)
    } else {
        "0".to_owned()
    };
    if !interval.value.is_finite() {
        // The estimate falls on a case whose value is beyond every number.
        return html! { "not defined" div.reason { "from " (low) } };
    }
    html! {
        (number::significant(interval.value, 3))
        div.reason { (low) " to " (end(interval.high)) }
    }
}
