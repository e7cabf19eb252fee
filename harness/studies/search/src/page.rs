//! Page of a search.

use crate::earlier::EarlierFound;
use crate::found::{FoundFault, SearchFound, effect_words};
use crate::space::Space;
use crate::trial::Trial;
use maud::{Markup, html};
use octant_base::number::{counted, fixed, significant};
use octant_report::page::page;
use std::collections::BTreeMap;

/// Decades of harm that the picture shows, from this one.
const DECADES: (f64, f64) = (-3.0, 3.0);
const LEFT: f64 = 210.0;
const WIDTH: f64 = 860.0;
const ROW: f64 = 22.0;
const TOP: f64 = 34.0;

/// Renders a search as one HTML file. `rerun` is the command line that repeats it.
#[must_use]
pub fn render(found: &SearchFound, trials: &[Trial], space: &Space, rerun: &str) -> String {
    let body = html! {
        header {
            div.eyebrow { "Search for unnoticed faults" }
            h1 { (found.scenario) }
            p.lead { (counted(found.runs, "run", "runs")) " with faults on the instrument and the noise of one run \
                without, seed " (found.seed) ": " (found.noticed) " noticed, "
                strong { (found.missed) " harmful and unnoticed" } "." }
        }
        @if let Some(minimal) = &found.minimal {
            h2 { "The worst" }
            (fault(minimal))
            p.hint { "Made smaller in " (counted(found.minimal_runs, "run", "runs")) " from: "
                @if let Some(worst) = &found.worst { (worst.words) ", " (effect_words(&worst.effect)) } }
        }
        @if let Some(earlier) = &found.earlier { (after(earlier)) }
        h2 { "Harm of every run" }
        (picture(trials, space))
        p.hint { "One point for each run. Harm 1: a parameter moved by " (fixed(found.harmful_shift_sigma, 0))
            " σ of the run without the fault, or the position by as much as that run's largest error. \
            Filled: nothing was noticed. Hollow: the core reported something or refused its calibration." }
        h2 { "By kind" }
        (kinds(found))
        h2 { "Largest unnoticed shift of each parameter" }
        (largest(found))
        p.hint { "What this search found, with a published calibration and no report. A longer search may find \
            more: none of these numbers is a bound." }
        @if !found.left_out.is_empty() {
            h2 { "Not searched" }
            table { tbody { @for (kind, reason) in &found.left_out { tr { td.mono { (kind) } td { (reason) } } } } }
        }
        h2 { "Provenance" }
        table { tbody {
            tr { td { "octant" } td.mono { (found.octant) } }
            tr { td { "strategy" } td { (found.strategy) ", seed " (found.search_seed) ", " (fixed(100.0 * found.pairs, 0)) " % pairs" } }
            tr { td { "candidates that the scenario can't have" } td { (found.refused) } }
            tr { td { "runs in which a fault altered nothing" } td { (found.not_fired) } }
        } }
        p.hint { "The same search again:" }
        code.rerun { (rerun) }
    };
    page(&format!("{}: search for unnoticed faults", found.scenario), &body)
}

fn after(earlier: &EarlierFound) -> Markup {
    html! {
        h2 { "After an earlier search" }
        table {
            thead { tr { th { "Noticed in the earlier search as" } th.n { "Faults" } th.n { "Run again" }
                th.n { "Noticed otherwise, or not at all" } } }
            tbody { @for screen in &earlier.screens { tr {
                td { (screen.report) } td.n { (screen.faults) } td.n { (screen.again) }
                td.n { @if screen.otherwise > 0 { strong { (screen.otherwise) } } @else { "0" } }
            } } }
        }
        @if earlier.missed > 0 {
            p { "Harmful and unnoticed there: " (earlier.missed) ", run again: " (earlier.missed_again)
                ", harmful and unnoticed now too: " (earlier.still_missed) "." }
        }
        p.hint { "The earlier search had " (counted(earlier.runs, "run", "runs")) ", its journal the BLAKE3 "
            span.mono { (earlier.journal_blake3) } "." }
    }
}

fn fault(fault: &FoundFault) -> Markup {
    html! {
        p { strong { (significant(fault.harm, 3)) " times harmful" } ": " (effect_words(&fault.effect)) "." }
        pre.mono { (fault.toml) }
    }
}

fn kinds(found: &SearchFound) -> Markup {
    html! { table {
        thead { tr { th { "Kind" } th.n { "Runs" } th.n { "Noticed" } th.n { "Worst unnoticed" }
            th style="padding-left:14px" { "Fault" } } }
        tbody { @for kind in &found.kinds { tr {
            td style="white-space:nowrap" { (kind.kinds) } td.n { (kind.runs) } td.n { (kind.noticed) }
            td.n { (kind.worst_harm.map_or_else(|| "–".to_owned(), |harm| significant(harm, 3))) }
            td style="padding-left:14px" { (kind.worst.as_deref().unwrap_or("")) }
        } } }
    } }
}

fn largest(found: &SearchFound) -> Markup {
    html! { table {
        thead { tr { th { "Parameter" } th.n { "Shift, σ" } th style="padding-left:14px" { "Fault" } } }
        tbody { @for (parameter, shift) in &found.largest_unnoticed { tr {
            td.mono { (parameter) } td.n { (significant(shift.sigma, 3)) }
            td style="padding-left:14px" { (shift.fault) }
        } } }
    } }
}

/// Draws the harm of every run in a row for each kind.
fn picture(trials: &[Trial], space: &Space) -> Markup {
    let mut rows: BTreeMap<String, Vec<(f64, bool)>> = BTreeMap::new();
    for trial in trials {
        let Some(effect) = trial.effect().filter(|effect| effect.fired) else { continue };
        let mut names: Vec<&str> =
            trial.candidate.faults.iter().map(|fault| space.forms[fault.form].kind.name).collect();
        names.dedup();
        let name = if names.len() > 1 { "two kinds" } else { names[0] };
        rows.entry(name.to_owned()).or_default().push((effect.harm(), effect.noticed_by.is_none()));
    }
    let height = TOP + ROW * rows.len() as f64 + 26.0;
    let x = |harm: f64| {
        let decade = harm.max(1e-9).log10().clamp(DECADES.0, DECADES.1);
        LEFT + (WIDTH - LEFT - 20.0) * (decade - DECADES.0) / (DECADES.1 - DECADES.0)
    };
    let bottom = height - 22.0;
    html! {
        svg viewBox={ "0 0 " (WIDTH) " " (height) } width=(WIDTH) role="img" aria-label="harm of every run, by kind" {
            @for decade in -3i32..=3 {
                @let at = x(10f64.powi(decade));
                line x1=(at) x2=(at) y1=(TOP - 8.0) y2=(bottom) stroke="currentColor"
                    stroke-opacity=(if decade == 0 { "0.9" } else { "0.15" }) {}
                text class="tick" x=(at) y=(height - 6.0) text-anchor="middle" { (significant(10f64.powi(decade), 1)) }
            }
            text class="tick" x=(x(1.0) + 6.0) y="14" { "harmful →" }
            @for (row, (name, points)) in rows.iter().enumerate() {
                @let y = TOP + ROW * (row as f64 + 0.5);
                text class="tick" x="4" y=(y + 4.0) { (name) }
                @for (harm, unnoticed) in points {
                    circle cx=(fixed(x(*harm), 1)) cy=(fixed(y, 1)) r="3.5" stroke="#c4500a" stroke-width="1"
                        fill=(if *unnoticed { "#c4500a" } else { "none" }) fill-opacity="0.7" {}
                }
            }
        }
    }
}
