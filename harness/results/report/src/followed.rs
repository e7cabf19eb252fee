//! Whether the navigation followed its samples.

use super::page::badge;
use maud::{Markup, html};
use octant_base::number;
use octant_score::summary::{Followed, FollowedScore, KnownNoise, Summary};
use octant_verdict::Verdict;

/// Renders the tests of the methods; empty without a navigation.
pub(super) fn followed(summary: &Summary) -> Markup {
    let baseline = summary.baseline.iter();
    let baseline = baseline.filter_map(|b| Some((b.label.as_str(), b.followed.as_ref()?)));
    let primary = summary.followed.iter().map(|score| (summary.method.as_str(), score));
    let all: Vec<(&str, &FollowedScore)> = primary.chain(baseline).collect();
    html! {
        @if !all.is_empty() {
            p.hint { "A unit that integrates its samples has their noise in its errors. What its errors did against the \
                error dynamics is regressed on the known noise: the slope is 1 for such a unit, and 0 for one that \
                answers otherwise." }
            table {
                thead { tr {
                    th { "Method" } th { "Quantity" } th { "Noise" } th.n { "Slope" } th.n { "σ" }
                    th.n { "Windows" } th.n { "Length, s" } th.n { "Lag, s" } th.n { "Rest / noise" } th.n { "" }
                } }
                tbody { @for (label, score) in &all { (rows(label, score)) } }
            }
            @for (label, score) in &all {
                @if let Some(reason) = &score.reason {
                    p.hint { (label) ": " (score.verdict.name()) ": " (reason) }
                }
            }
        }
    }
}

fn rows(label: &str, score: &FollowedScore) -> Markup {
    let channels = [("attitude", score.attitude), ("velocity", score.velocity)];
    let noise = match score.known {
        Some(KnownNoise::Simulated) => "of the simulated instrument",
        Some(KnownNoise::Dither) => "dither",
        None => "unknown",
    };
    html! {
        @for (name, channel) in channels {
            @if let Some(channel) = channel {
                tr {
                    td { (label) }
                    td { (name) }
                    td { (noise) }
                    td.n { (number::fixed(channel.slope, 3)) }
                    td.n { (number::fixed(channel.sigma, 3)) }
                    td.n { (channel.windows) }
                    td.n { (number::plain(channel.window_s, 3)) }
                    td.n { (number::plain(channel.lag_s, 3)) }
                    td.n { (number::significant(channel.residual, 2)) }
                    td.n { (badge(verdict(channel.verdict))) }
                }
            }
        }
    }
}

/// Verdict of a run with this result alone.
const fn verdict(followed: Followed) -> Verdict {
    match followed {
        Followed::Followed => Verdict::Pass,
        Followed::NotFollowed => Verdict::Inconclusive,
        Followed::NotTested => Verdict::None,
    }
}
