//! Correlation matrix of the parameters at the end of the calibration.

use super::chart::round;
use super::data::ReportData;
use maud::{Markup, html};
use octant_base::number;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};

/// Side of a cell, px.
const CELL: f64 = 14.0;
/// Space for the names, px.
const NAMES_PX: f64 = 130.0;
/// Correlations below aren't drawn.
const LEAST: f64 = 0.02;
/// Number of pairs listed.
const LISTED: usize = 8;

/// Correlation of two parameters by their places.
type Pair = (usize, usize, f64);

/// Renders the matrix with its strongest pairs; empty without a covariance.
pub(super) fn correlation(data: &ReportData) -> Markup {
    let Some(covariance) = &data.covariance else { return html! {} };
    let estimated: Vec<usize> = (0..PARAMETER_COUNT)
        .filter(|&i| covariance[i][i] > 0.0 && covariance[i][i].is_finite())
        .collect();
    if estimated.len() < 2 {
        return html! {};
    }
    let mut pairs: Vec<Pair> = Vec::new();
    for (row, &i) in estimated.iter().enumerate() {
        for (column, &j) in estimated[..row].iter().enumerate() {
            let r = covariance[i][j] / libm::sqrt(covariance[i][i] * covariance[j][j]);
            if r.is_finite() && r.abs() >= LEAST {
                pairs.push((row, column, r.clamp(-1.0, 1.0)));
            }
        }
    }
    let edge = NAMES_PX + CELL * estimated.len() as f64;
    let at = |place: usize| round(NAMES_PX + CELL * place as f64);
    let name = |place: usize| NAMES[estimated[place]];
    let mut strongest = pairs.clone();
    strongest.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
    strongest.truncate(LISTED);
    html! {
        h3 { "Correlation of the parameters" }
        p.hint { "From the covariance at the end of the calibration. Blue is positive, orange is negative, full colour is \
            ±1; pairs below " (LEAST) " are left out." }
        div.correlation {
            svg viewBox={ "0 0 " (edge) " " (edge) } role="img" aria-label="Correlation of the parameters" {
                @for place in 0..estimated.len() {
                    text class="tick y" x=(NAMES_PX - 5.0) y=(at(place) + 10.5) { (name(place)) }
                    text class="tick start" transform={ "translate(" (at(place) + 10.5) " " (NAMES_PX - 5.0) ") rotate(-90)" } { (name(place)) }
                    rect.diagonal x=(at(place)) y=(at(place)) width=(CELL - 1.0) height=(CELL - 1.0) {}
                }
                @for (row, column, r) in &pairs {
                    rect class=(if *r > 0.0 { "positive" } else { "negative" }) x=(at(*column)) y=(at(*row))
                        width=(CELL - 1.0) height=(CELL - 1.0) fill-opacity=(number::fixed(r.abs(), 2)) {
                        title { (name(*row)) ", " (name(*column)) ": " (number::fixed(*r, 2)) }
                    }
                }
            }
            @if !strongest.is_empty() {
                table {
                    thead { tr { th { "Strongest pairs" } th.n { "Correlation" } } }
                    tbody { @for (row, column, r) in &strongest {
                        tr { td.mono { (name(*column)) ", " (name(*row)) } td.n { (number::fixed(*r, 2)) } }
                    } }
                }
            }
        }
    }
}
