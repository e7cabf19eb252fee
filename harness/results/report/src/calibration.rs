//! Calibration of a run: parameters, their convergence, innovations.

use super::convergence::convergence;
use super::correlation::correlation;
use super::data::ReportData;
use super::filtered::filtered;
use super::innovations::innovations;
use super::parameters;
use maud::{Markup, html};
use octant_base::number;

pub(super) fn calibration(data: &ReportData) -> Markup {
    let summary = &data.summary;
    let Some(calibration) = &summary.calibration else { return html! {} };
    let baseline = summary.baseline.as_ref();
    let beyond = octant_score::parameters::beyond(&calibration.parameters, 3.0);
    html! {
        @if let Some(reason) = &calibration.refused {
            p { strong { "Refused: " } (reason) "." }
            @if !calibration.refusal_explained.is_empty() {
                ul { @for line in &calibration.refusal_explained { li { (line) } } }
            }
        }
        p.hint {
            "Estimates by " (calibration.estimator) ". The strip shows the error in units of the claimed σ: "
            "the inner field is ±1σ, the outer one ±3σ, "
            span.primary-text { "●" } " " (summary.method)
            @if let Some(b) = baseline { ", " span.baseline-text { "○" } " " (b.label) }
            ". "
            @if beyond.is_empty() { "No error is beyond 3σ." }
            @else { "Beyond 3σ: " (beyond.join(", ")) "." }
            @if let Some(floor) = summary.reference.as_ref().and_then(|r| r.isotropic_g_sigma_floor_deg_per_h_per_g) {
                " The isotropic part of G is a vertical drift in every attitude: no method of this length sees it better than "
                (number::significant(floor, 2)) " deg/h/g."
            }
        }
        @if let Some(rest) = &calibration.rest {
            @let sentence = rest.sentence();
            p.hint { "With respect to the case at rest: " (sentence) "." }
        }
        @if let Some(axes) = &data.axes_of_source {
            p.hint { "Axes of the source: " (axes) "." }
        }
        (parameters::table(calibration, baseline.and_then(|b| b.calibration.as_ref())))
        (convergence(data))
        (filtered(data))
        (correlation(data))
        (innovations(data, calibration.nis_expected))
    }
}
