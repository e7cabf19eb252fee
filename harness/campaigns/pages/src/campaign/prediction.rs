//! Linear prediction of an ensemble, compared with its cases.

use super::elements::{heading, with_bounds};
use maud::{Markup, html};
use octant_base::number;
use octant_campaign::against::{EnsembleComparison, ErrorRow};
use octant_campaign::report::CampaignReport;

pub(super) fn section(report: &CampaignReport<'_>) -> Markup {
    let prediction = &report.prediction;
    html! {
        (heading("prediction"))
        p.hint { "Mean and covariance of all errors, carried through calibration and navigation in one pass, against the \
            cases that differ by their seed alone. Below each σ of the cases its interval; all intervals of a comparison \
            together hold what is true with 95 %. Where a prediction can stand, runs are saved." }
        @if prediction.compared.is_empty() {
            p.empty { "No ensemble could be compared." }
        }
        @for comparison in &prediction.compared {
            @let units = comparison.place(report.plan).map(|case| report.units.at(case));
            (of(&comparison.shown(&units.unwrap_or_default())))
        }
        @if !prediction.left_out.is_empty() {
            h3 { "Left out" }
            ul { @for line in &prediction.left_out { li { (line) } } }
        }
    }
}

fn of(comparison: &EnsembleComparison) -> Markup {
    let set = comparison.set.join(", ");
    let agreeing = comparison.states.iter().filter(|row| row.agrees).count();
    html! {
        h3 { (comparison.scenario) @if !set.is_empty() { "; " (set) } }
        p { (comparison.method) ", " (comparison.runs) " cases:" }
        ul { @for words in &comparison.words { li { (words) } } }
        (table("Drift", comparison.drift.iter()))
        @if agreeing < comparison.states.len() {
            (table("Parameters that differ", comparison.states.iter().filter(|row| !row.agrees)))
        }
        details {
            summary { "All parameters: " (agreeing) " of " (comparison.states.len()) " within their intervals"
                @if let Some(ratio) = comparison.mean_ratio {
                    ", predicted over simulated σ " (number::fixed(ratio, 3)) " in the mean"
                }
            }
            (table("Parameter", comparison.states.iter()))
        }
        @if !comparison.not_modelled.is_empty() {
            details {
                summary { "What doesn't enter the prediction" }
                ul { @for what in &comparison.not_modelled { li { (what) } } }
            }
        }
    }
}

fn table<'a>(name: &str, rows: impl Iterator<Item = &'a ErrorRow>) -> Markup {
    html! {
        div.wide tabindex="0" role="region" aria-label=(name) {
            table {
                thead { tr {
                    th { (name) } th { "Unit" } th.n { "Mean, predicted" } th.n { "Mean, simulated" }
                    th.n { "σ, predicted" } th.n { "σ, simulated" } th.n { "Ratio" } th { "" }
                } }
                tbody { @for row in rows { tr {
                    td { (row.name) } td { (row.unit) }
                    td.n { (number::significant(row.predicted_mean, 3)) }
                    td.n { (with_bounds(&row.simulated_mean)) }
                    td.n { (number::significant(row.predicted_sigma, 3)) }
                    td.n { (with_bounds(&row.simulated_sigma)) }
                    td.n { @match row.ratio { Some(ratio) => (number::fixed(ratio, 2)), None => "–" } }
                    td { @if row.agrees { "✓ within" } @else { strong { "✕ differs" } } }
                } } }
            }
        }
    }
}
