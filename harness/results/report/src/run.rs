//! `report.html` of one run, for the reader who assesses it.

pub use super::data::{ReportData, ReportProvenance, StopLabel};

use super::allan::allan;
use super::calibration::calibration;
use super::certificate;
use super::counterfactual::counterfactual;
use super::drift::drift;
use super::followed::followed;
use super::gimbals::gimbals;
use super::heading::heading;
use super::inputs::inputs;
use super::marks::marks;
use super::pacing::pacing;
use super::page::{Section, badge, page, sections};
use super::requirements::requirements;
use super::scores::alignment;
use maud::{Markup, html};
use octant_base::display::{DisplayUnits, ShownUnit};
use octant_base::number;
use octant_evidence::discrepancy;
use octant_score::summary::{CalibrationScore, HeightChannel, NavigationScore, Summary};
use octant_score::work::duration;
use octant_verdict::Verdict;
use octant_verdict::measures::unasked;

/// Renders the report as one HTML file.
#[must_use]
pub fn render(data: &ReportData) -> String {
    let summary = &data.summary;
    let all = [
        Section::new(
            "requirements",
            "Requirements",
            html! { (requirements(data)) (lacking(summary)) (planned_and_done(summary)) },
        ),
        Section::new("inputs", "Inputs", inputs(summary)),
        Section::new("faults", "Faults", faults(summary)),
        Section::new("effects", "What the faults did", counterfactual(data)),
        Section::new("heading", "Heading test", heading(summary)),
        Section::new("navigation", "Navigation", drift(data)),
        Section::new("followed", "Whether it followed its samples", followed(summary)),
        Section::new("alignment", "Alignment", alignment(summary, &data.units)),
        Section::new("calibration", "Calibrated parameters", calibration(data)),
        Section::new("noise", "Noise at rest", allan(summary)),
        Section::new("gimbals", "Gimbals", gimbals(data)),
        Section::new("health", "Health", events(data)),
        Section::new("pacing", "Against the clock", pacing(summary)),
        Section::new("discrepancies", "Discrepancies", discrepancies(data)),
        Section::new("provenance", "Provenance", provenance(data)),
    ];
    let body = html! {
        @if let Some(certificate) = certificate::of_run(data) { (certificate::page(&certificate)) }
        (header(data))
        (figures(summary, &data.units))
        (sections(&all))
        (marks(data))
    };
    page(&format!("{}: {}", summary.scenario, summary.verdict.name()), &body)
}

fn header(data: &ReportData) -> Markup {
    let summary = &data.summary;
    html! {
        header {
            div.top {
                div {
                    div.eyebrow {
                        @if summary.calibration.is_some() { "Self-calibration run" } @else { "Navigation" }
                    }
                    h1 { (summary.scenario) }
                    p.lead { (what_was_done(summary, &data.units)) }
                }
                (badge(summary.verdict))
            }
            @if !summary.reasons.is_empty() {
                ul.reasons { @for reason in &summary.reasons { li { (reason) } } }
            }
            dl.facts {
                div { dt { "Method" } dd { (summary.method) } }
                @if let Some(baseline) = &summary.baseline {
                    div { dt { "Compared with" } dd { (baseline.label) } }
                }
                div { dt { "Seed" } dd { (summary.seed) } }
                @for (name, value) in &data.facts { div { dt { (name) } dd { (value) } } }
            }
        }
    }
}

/// Renders the discrepancies; empty for a run that passes.
fn discrepancies(data: &ReportData) -> Markup {
    let all = discrepancy::of_run(&data.summary);
    if all.is_empty() && data.dispositions.entries.is_empty() {
        return html! {};
    }
    let hint = "What is said of them stands in a file of its own, beside the run: octant report RUN \
        --dispositions FILE makes it, people fill it in. It changes no verdict.";
    html! {
        (super::discrepancies::table(&all, &data.dispositions, hint, &|_| html! {}))
    }
}

/// Describes the run and its result in two sentences.
#[must_use]
pub fn what_was_done(summary: &Summary, units: &DisplayUnits) -> String {
    let in_unit = |value: f64, unit: ShownUnit| {
        let value = number::significant(unit.of(value), 3);
        if unit.name == "arcmin" { format!("{value}′") } else { format!("{value} {}", unit.name) }
    };
    let (latitude, longitude) = (units.latitude(), units.longitude());
    let first = match (&summary.calibration, &summary.navigation) {
        (Some(c), Some(n)) => format!(
            "The instrument was calibrated for {} h through the {} positions and then navigated \
             free inertial for {} h with the height {}.",
            number::plain(c.duration_h, 4),
            c.positions,
            number::plain(n.duration_h, 4),
            height(n.height),
        ),
        (Some(c), None) if c.refused.is_some() => format!(
            "The calibration through the {} positions was refused after {} h, and published nothing.",
            c.positions,
            number::plain(c.duration_h, 4)
        ),
        (Some(c), None) => format!(
            "The instrument was calibrated for {} h through the {} positions.",
            number::plain(c.duration_h, 4),
            c.positions
        ),
        // A unit that aligned says so. A solution that came from elsewhere has no beginning.
        (None, Some(n)) if summary.alignment.is_none() => {
            format!("A solution of {} h was scored.", number::plain(n.duration_h, 4))
        }
        (None, Some(n)) => format!(
            "The instrument navigated free inertial for {} h with the height {}, without a \
             calibration before it.",
            number::plain(n.duration_h, 4),
            height(n.height),
        ),
        (None, None) => "The run gave neither a calibration nor a navigation.".to_owned(),
    };
    let position = |n: &NavigationScore| {
        let (north, east) = (n.latitude_error_arcmin?, n.longitude_error_arcmin?);
        Some([in_unit(north.max, latitude), in_unit(east.max, longitude)])
    };
    let second = match (&summary.navigation, &summary.calibration) {
        (Some(n), _) => match (position(n), n.heading_error_arcmin) {
            (Some([north, east]), _) => {
                let other = summary.baseline.as_ref().and_then(|b| {
                    let [north, east] = position(b.navigation.as_ref()?)?;
                    Some(format!(
                        ", against {north} and {east} for {} on the same instrument with the same noise",
                        b.label
                    ))
                });
                let other = other.unwrap_or_default();
                format!(
                    " Its largest errors were {north} in latitude and {east} in longitude{other}."
                )
            }
            (None, Some(heading)) => {
                let largest = in_unit(heading.max, units.attitude());
                format!(" Its largest heading error was {largest}.")
            }
            (None, None) => String::new(),
        },
        (
            None,
            Some(CalibrationScore { worst_normalized_error: Some(worst), refused: None, .. }),
        ) => {
            format!(" The worst parameter is {} σ from truth.", number::fixed(*worst, 1))
        }
        _ => String::new(),
    };
    first + &second
}

const fn height(channel: HeightChannel) -> &'static str {
    match channel {
        HeightChannel::Held => "held",
        HeightChannel::Damped => "damped",
        HeightChannel::Free => "free",
    }
}

fn figures(summary: &Summary, units: &DisplayUnits) -> Markup {
    let baseline = summary.baseline.as_ref();
    let label = baseline.map_or("", |b| b.label.as_str());
    let other_navigation = baseline.and_then(|b| b.navigation.as_ref());
    let other_calibration = baseline.and_then(|b| b.calibration.as_ref());
    let figure = |name: &str, unit: &str, value: f64, digits: i32, other: Option<f64>| {
        html! {
            div.figure {
                div.name { (name) }
                div.value { (number::significant(value, digits)) span.unit { (unit) } }
                @if let Some(other) = other {
                    div.other { (label) ": " (number::significant(other, digits)) }
                }
            }
        }
    };
    html! {
        div.figures {
            @if let Some(n) = &summary.navigation {
                @let (latitude, longitude, radial) = (units.latitude(), units.longitude(), units.radial());
                @let rate = format!("{}/h", radial.name);
                @if let Some(score) = n.latitude_error_arcmin {
                    (figure("Latitude error, largest", latitude.name, latitude.of(score.max), 3,
                        other_navigation.and_then(|o| Some(latitude.of(o.latitude_error_arcmin?.max)))))
                }
                @if let Some(score) = n.longitude_error_arcmin {
                    (figure("Longitude error, largest", longitude.name, longitude.of(score.max), 3,
                        other_navigation.and_then(|o| Some(longitude.of(o.longitude_error_arcmin?.max)))))
                }
                @if let Some(score) = n.radial_error_nmi {
                    (figure("Radial error rate", &rate, radial.of(score.rate_per_h), 2,
                        other_navigation.and_then(|o| Some(radial.of(o.radial_error_nmi?.rate_per_h)))))
                }
                @if let Some(heading) = n.heading_error_arcmin {
                    @let unit = units.attitude();
                    (figure("Heading error, largest", unit.name, unit.of(heading.max), 3,
                        other_navigation.and_then(|o| Some(unit.of(o.heading_error_arcmin?.max)))))
                }
            }
            @if let Some(c) = &summary.calibration {
                @if let Some(nis) = c.nis_mean {
                    (figure(&format!("Mean NIS, {} expected", c.nis_expected_words()), "", nis, 3, other_calibration.and_then(|o| o.nis_mean)))
                }
                @if let (Some(worst), None) = (c.worst_normalized_error, &c.refused) {
                    (figure("Worst parameter error", "σ", worst, 2,
                        other_calibration.and_then(|o| o.worst_normalized_error)))
                }
            }
        }
    }
}

/// Names the kinds of requirements that the run's lack; empty for a solution, which states no standard deviations.
fn lacking(summary: &Summary) -> Markup {
    let measures = summary.requirements.iter().map(|requirement| requirement.measure.as_str());
    let kinds = unasked(measures);
    html! {
        @if summary.calibration.is_some() && !kinds.is_empty() {
            p.hint { "The requirements ask less than a unit under test can get wrong:" }
            ul { @for kind in kinds { li.hint { (kind.sentence()) "." } } }
        }
    }
}

/// Renders the planned and the completed work.
fn planned_and_done(summary: &Summary) -> Markup {
    let (Some(planned), Some(done)) = (&summary.planned, &summary.done) else { return html! {} };
    let count = |value: Option<u64>| value.map(|v| v.to_string());
    let time = |value: Option<f64>| value.map(duration);
    let rows = [
        ("Stops of the calibration", count(planned.stops), count(done.stops)),
        ("Calibration", time(planned.calibration_s), time(done.calibration_s)),
        ("References for it", count(planned.references), count(done.references)),
        ("Navigation", time(planned.navigation_s), time(done.navigation_s)),
    ];
    let none = || "–".to_owned();
    html! {
        h3 { "Planned and done" }
        table {
            thead { tr { th { "" } th.n { "Planned" } th.n { "Done" } } }
            tbody {
                @for (what, planned, done) in rows {
                    @if planned.is_some() || done.is_some() {
                        tr {
                            td { (what) }
                            td.n { (planned.unwrap_or_else(none)) }
                            td.n { (done.unwrap_or_else(none)) }
                        }
                    }
                }
            }
        }
    }
}

/// Renders the receipts of the faults; empty if none was injected.
fn faults(summary: &Summary) -> Markup {
    if summary.faults.is_empty() {
        return html! {};
    }
    let number = |value: Option<u64>| value.map_or_else(|| "–".to_owned(), |v| v.to_string());
    let sum = |sum: &Option<String>| sum.clone().unwrap_or_else(|| "–".to_owned());
    let verdict = |fired: bool| if fired { Verdict::Pass } else { Verdict::Inconclusive };
    html! {
        p.hint { "What each fault altered, found by comparing samples before and after it. The \
            checksums (CRC-32) are over the altered samples, as they were and as they became." }
        table {
            thead { tr {
                th { "Fault" } th { "Kind" } th.n { "Firings" } th.n { "First sample" }
                th.n { "Last sample" } th.n { "Altered" } th.n { "Clean" } th.n { "Faulted" }
                th.n { "Fired" }
            } }
            tbody {
                @for f in &summary.faults {
                    tr {
                        td { strong { (f.id) } }
                        td { span.mono { (f.kind) } }
                        td.n { (f.firings) }
                        td.n { (number(f.first_sample)) }
                        td.n { (number(f.last_sample)) }
                        td.n { (f.samples_altered) }
                        td.n { span.mono { (sum(&f.clean_crc32)) } }
                        td.n { span.mono { (sum(&f.faulted_crc32)) } }
                        td.n { (badge(verdict(f.fired))) }
                    }
                }
            }
        }
    }
}

fn events(data: &ReportData) -> Markup {
    const SHOWN: usize = 40;
    html! {
        @if data.events.is_empty() {
            p { "The core reported nothing: no rejected measurement, no recovery, no gap, no stuck sensor." }
        } @else {
            table {
                thead { tr { th.n style="padding-left:0" { "Time, h" } th.n { "Duration, s" }
                    th style="padding-left:14px" { "Event" } th { "Detail" } } }
                tbody { @for event in data.events.iter().take(SHOWN) {
                    tr {
                        td.n { (number::fixed(event.hours, 4)) }
                        td.n { (number::significant(event.duration_s, 3)) }
                        td style="padding-left:14px" { (event.name) }
                        td { (event.detail) }
                    }
                } }
            }
            @if data.events.len() > SHOWN {
                p.hint { (data.events.len() - SHOWN) " more are in the recording." }
            }
        }
    }
}

fn provenance(data: &ReportData) -> Markup {
    let summary = &data.summary;
    html! {
        table {
            tbody {
                tr { td { "octant" } td.mono { (summary.octant) } }
                tr { td { "stream hash" } td.mono { (summary.stream_hash) } }
                @if let Some(b) = &summary.baseline {
                    tr { td { "stream hash, " (b.label) } td.mono { (b.stream_hash) } }
                }
                @if let Some(s) = &summary.altered_streams {
                    tr { td { "source, from sample " (s.first_sample) " on" } td.mono { (s.clean_blake3) } }
                    tr { td { "core's input, from there on" } td.mono { (s.faulted_blake3) } }
                }
                @for (name, value) in &data.provenance.entries { tr { td { (name) } td.mono { (value) } } }
            }
        }
        @if !data.provenance.rerun.is_empty() {
            p.hint { "The same run again:" }
            code.rerun { (data.provenance.rerun) }
        }
    }
}
