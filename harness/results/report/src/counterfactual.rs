//! Effects of the faults: the run compared with its twin without them.

use super::chart::{Chart, Line, Role};
use super::data::ReportData;
use maud::{Markup, html};
use octant_base::number;
use octant_sample::parameters::NAMES;
use octant_score::counterfactual::{Counterfactual, DriftDifference, HARMFUL_SHIFT_SIGMA};
use octant_score::summary::CalibrationScore;

/// Maximum number of parameters listed: those that moved most.
const LISTED: usize = 12;

pub(super) fn counterfactual(data: &ReportData) -> Markup {
    let summary = &data.summary;
    let primary = summary
        .counterfactual
        .as_ref()
        .map(|c| (summary.method.as_str(), c, summary.calibration.as_ref()));
    let baseline = summary.baseline.as_ref().and_then(|b| {
        b.counterfactual.as_ref().map(|c| (b.label.as_str(), c, b.calibration.as_ref()))
    });
    if primary.is_none() && baseline.is_none() {
        return html! {};
    }
    let both = primary.is_some() && baseline.is_some();
    html! {
        p.hint { "Every difference to the twin is the faults' doing: the twin met the same instrument and \
            the same noise without them." }
        @for (label, c, calibration) in primary.into_iter().chain(baseline) {
            @if both { h3 { (label) } }
            p { (in_words(c)) }
            (noticed(c))
            (shifts(c, calibration))
            @if let Some(difference) = &c.navigation { (drift(difference, data.navigation_start_h)) }
        }
    }
}

/// Describes the comparison in one paragraph: harm, detection, end.
#[must_use]
pub fn in_words(c: &Counterfactual) -> String {
    let mut text = match (&c.worst_parameter, c.worst_shift_sigma) {
        (Some(name), Some(sigma)) if sigma > 0.0 => {
            let published = c.worst_shift_published_sigma.map_or_else(String::new, |sigma| {
                format!("; in published σ the largest shift is {}", number::significant(sigma, 3))
            });
            format!(
                "The parameter that moved most is {name}, by {} σ of the twin{published}. ",
                number::significant(sigma, 3)
            )
        }
        (Some(_), _) => "No parameter moved. ".to_owned(),
        (None, _) => String::new(),
    };
    if let Some(n) = &c.navigation {
        text += &format!(
            "The navigation departed from the twin's by up to {} nmi, whose own largest radial error is {} nmi. ",
            number::significant(n.radial_max_nmi, 3),
            number::significant(n.twin_radial_max_nmi, 3)
        );
    }
    text += match (c.missed, c.harmful, c.refused) {
        _ if c.unended => {
            "The calibration was begun anew and not ended: it is none of the procedure."
        }
        (true, ..) => "The fault did harm, nothing was noticed, and the calibration was published.",
        (_, _, true) => "The core refused the calibration: nothing wrong was published.",
        (_, true, false) => {
            "The fault did harm; the core noticed that something was wrong and published all the same."
        }
        (_, false, false) => "No significant effect.",
    };
    if c.outputs_differ_after_s.is_none() {
        text += " No output of the core differs from the twin's.";
    }
    if c.false_alarms > 0 {
        text += &format!(" The twin has {} reports that no fault explains.", c.false_alarms);
    }
    text
}

fn noticed(c: &Counterfactual) -> Markup {
    let time = |s: Option<f64>| s.map_or_else(|| "–".to_owned(), |s| number::fixed(s, 3));
    html! {
        table {
            thead { tr {
                th { "Fault" } th.n { "Onset, s" } th style="padding-left:14px" { "Noticed as" }
                th.n { "After, s" } th.n { "Last report, s" } th.n { "Recovered" }
            } }
            tbody { @for fault in &c.faults {
                tr {
                    td { strong { (fault.id) } }
                    td.n { (time(fault.onset_s)) }
                    td style="padding-left:14px" { (fault.noticed_by.as_deref().unwrap_or("not noticed")) }
                    td.n { (time(fault.delay_s)) }
                    td.n { (time(fault.last_report_s)) }
                    td.n { (if fault.recovered { "yes" } else if fault.noticed_by.is_some() { "no" } else { "–" }) }
                }
            } }
        }
    }
}

fn shifts(c: &Counterfactual, calibration: Option<&CalibrationScore>) -> Markup {
    let unit =
        |name: &str| calibration.and_then(|c| c.parameters.get(name)).map_or("", |p| &p.unit);
    let mut moved: Vec<_> =
        NAMES.iter().filter_map(|name| c.parameters.get(*name).map(|s| (*name, s))).collect();
    moved.sort_by(|a, b| b.1.sigma.abs().total_cmp(&a.1.sigma.abs()));
    moved.retain(|(_, shift)| shift.sigma != 0.0);
    if moved.is_empty() {
        return html! {};
    }
    let more = moved.len().saturating_sub(LISTED);
    html! {
        table {
            thead { tr { th { "Parameter" } th.n { "Shift" } th.n { "In σ of the twin" } th.n { "" } } }
            tbody { @for (name, shift) in moved.iter().take(LISTED) {
                tr {
                    td.mono { (name) }
                    td.n { (number::significant(shift.shift, 3)) " " span.soft { (unit(name)) } }
                    td.n { (number::significant(shift.sigma, 3)) }
                    td.n { @if shift.sigma.abs() >= HARMFUL_SHIFT_SIGMA { "harmful" } }
                }
            } }
        }
        @if more > 0 { p.hint { (more) " more moved less; all are in summary.json." } }
    }
}

fn drift(difference: &DriftDifference, navigation_start_h: Option<f64>) -> Markup {
    let mut chart = Chart::new(
        "Difference to the twin",
        "hours of navigation",
        "Navigation, faulted minus twin, arcmin",
    );
    chart.height = 200.0;
    chart.run_offset_h = navigation_start_h;
    for (label, role, column) in [("latitude", Role::Primary, 1), ("longitude", Role::Baseline, 2)]
    {
        chart.lines.push(Line {
            label: label.to_owned(),
            role,
            points: difference.series_hours.iter().map(|p| [p[0], p[column]]).collect(),
        });
    }
    chart.render()
}
