//! Markers of a run for its plots over time: moves, stops, faults, reports of the core.

use super::chart::json_text;
use super::data::{ReportData, StopLabel};
use maud::{Markup, PreEscaped, html};
use octant_score::points::GimbalPoint;
use std::fmt::Write as _;

/// Maximum number of markers of a kind; the script leaves out kinds that a drawing can't tell apart.
const MARKS_MAX: usize = 4000;

/// A marker: start and end in hours of the run, and its label.
pub type TimelineMark = (f64, f64, String);

/// Renders the data block of the markers.
pub(super) fn marks(data: &ReportData) -> Markup {
    let (moves, stops) = phases(&data.gimbals, &data.stops);
    let noticed = data
        .events
        .iter()
        .map(|event| (event.hours, event.hours + event.duration_s / 3600.0, event.name.clone()));
    let kinds = [
        ("moves", moves),
        ("stops", stops),
        ("faults", faults(data)),
        ("noticed", noticed.collect()),
    ];
    let mut json = String::from("{");
    for (i, (kind, marks)) in kinds.iter().enumerate() {
        let comma = if i == 0 { "" } else { "," };
        let _ = write!(json, "{comma}\"{kind}\":[");
        for (k, (start, end, label)) in marks.iter().take(MARKS_MAX).enumerate() {
            let comma = if k == 0 { "" } else { "," };
            // A millionth of an hour is 4 ms.
            let _ = write!(json, "{comma}[{start:.6},{end:.6},{}]", json_text(label));
        }
        json.push(']');
    }
    json.push('}');
    html! { script #marks type="application/json" { (PreEscaped(json)) } }
}

/// Largest distance from a planned angle at which a stop is the planned one, deg.
const SAME_DEG: f64 = 0.1;

/// Divides the run into moves of the gimbals and the stops between them. A stop of the calibration has
/// its label, others their number in the run.
#[must_use]
pub fn phases(
    gimbals: &[GimbalPoint],
    labels: &[StopLabel],
) -> (Vec<TimelineMark>, Vec<TimelineMark>) {
    let (mut moves, mut stops) = (Vec::<TimelineMark>::new(), Vec::<TimelineMark>::new());
    let Some(first) = gimbals.first() else { return (moves, stops) };
    // A unit may count its stops as it likes: the angles tell whether it is at the planned one.
    let label = |points: &[GimbalPoint], number: usize| {
        let planned = points.iter().find_map(|point| {
            let label = labels.get(usize::from(point.stop?))?;
            let off_deg = (point.azimuth_deg - label.azimuth_deg)
                .abs()
                .max((point.roll_deg - label.roll_deg).abs());
            (off_deg < SAME_DEG).then(|| label.text.clone())
        });
        planned.unwrap_or_else(|| number.to_string())
    };
    let (mut since, mut from) = (first.hours, 0);
    for (before, pair) in gimbals.windows(2).enumerate() {
        if pair[0].moving == pair[1].moving {
            continue;
        }
        let at = pair[1].hours;
        if pair[1].moving {
            stops.push((since, at, label(&gimbals[from..=before], stops.len() + 1)));
        } else {
            moves.push((since, at, String::new()));
        }
        (since, from) = (at, before + 1);
    }
    if let Some(last) = gimbals.last().filter(|last| last.hours > since) {
        if last.moving {
            moves.push((since, last.hours, String::new()));
        } else {
            stops.push((since, last.hours, label(&gimbals[from..], stops.len() + 1)));
        }
    }
    (moves, stops)
}

/// Times of the faults: from the twin where there is one, else from the first altered sample.
fn faults(data: &ReportData) -> Vec<TimelineMark> {
    let twin = data.summary.counterfactual.as_ref();
    let mut marks = Vec::new();
    for fault in &data.summary.faults {
        let onset_s = twin
            .and_then(|twin| twin.faults.iter().find(|noticed| noticed.id == fault.id))
            .and_then(|noticed| noticed.onset_s);
        let of_sample = |sample: Option<u64>| {
            Some(sample? as f64 * data.sample_period_s?).filter(|s| s.is_finite())
        };
        let Some(start) = onset_s.or_else(|| of_sample(fault.first_sample)) else { continue };
        let end = of_sample(fault.last_sample).unwrap_or(start).max(start);
        marks.push((start / 3600.0, end / 3600.0, fault.id.clone()));
    }
    marks
}
