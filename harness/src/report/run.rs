//! `report.html`: one run, for the one who has to believe it.

use super::chart::{Band, Chart, Line, Role};
use super::page::{badge, page};
use super::{number, parameters};
use crate::score::reference::Reference;
use crate::score::summary::{Calibration, HeightChannel, Navigation, Summary};
use maud::{Markup, html};
use octant_sample::Parameters;
use octant_sample::parameters::{Group, PARAMETER_COUNT};

/// Everything that the report shows. What isn't there is left out of the page, or said to be
/// missing.
#[derive(Clone, Debug)]
pub struct ReportData {
    /// The summary of the run.
    pub summary: Summary,
    /// What the run was made on, in pairs of name and value: site, motion, instrument.
    pub facts: Vec<(String, String)>,
    /// True parameters, SI, for the convergence of the errors; `None` where nobody knows them.
    pub truth: Option<Parameters>,
    /// How the parameters came about during the calibration; any rate, 100 to 1000 points look best.
    pub convergence: Vec<ParameterPoint>,
    /// Normalized innovation squared of every measurement.
    pub nis: Vec<NisPoint>,
    /// Gimbal angles of the whole run; any rate that shows the moves.
    pub gimbals: Vec<GimbalPoint>,
    /// Health events, in order of time.
    pub events: Vec<HealthEvent>,
    /// Where the numbers come from.
    pub provenance: Provenance,
}

/// Parameters and σ at one time of the calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterPoint {
    /// Hours since the start of the calibration.
    pub hours: f64,
    /// Estimates.
    pub estimate: Parameters,
    /// 1σ, SI, in the order of [`octant_sample::parameters::NAMES`].
    pub sigma: [f64; PARAMETER_COUNT],
}

/// Normalized innovation squared of one measurement of three axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NisPoint {
    /// Hours since the start of the calibration.
    pub hours: f64,
    /// NIS.
    pub nis: f64,
}

/// Gimbal angles at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GimbalPoint {
    /// Hours since the start of the run.
    pub hours: f64,
    /// Inner gimbal, deg.
    pub azimuth_deg: f64,
    /// Outer gimbal, deg.
    pub roll_deg: f64,
    /// The gimbals are on their way.
    pub moving: bool,
}

/// Something that the core reported.
#[derive(Clone, Debug, PartialEq)]
pub struct HealthEvent {
    /// Hours since the start of the run.
    pub hours: f64,
    /// How long its cause held, s.
    pub duration_s: f64,
    /// Name of the event.
    pub name: String,
    /// What it means here.
    pub detail: String,
}

/// Where the numbers come from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Pairs of name and value: versions, hashes, host.
    pub entries: Vec<(String, String)>,
    /// The command that makes the run again.
    pub rerun: String,
}

/// The report as one HTML file.
#[must_use]
pub fn render(data: &ReportData) -> String {
    let summary = &data.summary;
    let body = html! {
        (header(data))
        (figures(summary))
        (requirements(summary))
        (drift(summary))
        (calibration(data))
        (gimbals(data))
        (events(data))
        (provenance(data))
    };
    page(&format!("{}: {}", summary.scenario, summary.verdict.name()), &body)
}

fn header(data: &ReportData) -> Markup {
    let summary = &data.summary;
    html! {
        header {
            div.top {
                div {
                    div.eyebrow { "Self-calibration run" }
                    h1 { (summary.scenario) }
                    p.lead { (what_was_done(summary)) }
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

/// Two sentences: what was done, and what came of it.
#[must_use]
pub fn what_was_done(summary: &Summary) -> String {
    let first = match (&summary.calibration, &summary.navigation) {
        (Some(c), Some(n)) => format!(
            "The instrument was calibrated for {} h through the {} positions and then navigated \
             free inertial for {} h with the height {}.",
            number::plain(c.duration_h, 4),
            c.positions,
            number::plain(n.duration_h, 4),
            height(n.height),
        ),
        (Some(c), None) => format!(
            "The instrument was calibrated for {} h through the {} positions.",
            number::plain(c.duration_h, 4),
            c.positions
        ),
        (None, Some(n)) => format!(
            "The instrument navigated free inertial for {} h with the height {}, without a \
             calibration before it.",
            number::plain(n.duration_h, 4),
            height(n.height),
        ),
        (None, None) => "The run gave neither a calibration nor a navigation.".to_owned(),
    };
    let second = match (&summary.navigation, &summary.calibration) {
        (Some(n), _) => format!(
            " Its largest errors were {}′ in latitude and {}′ in longitude{}.",
            number::significant(n.latitude_error_arcmin.max, 3),
            number::significant(n.longitude_error_arcmin.max, 3),
            summary.baseline.as_ref().and_then(|b| b.navigation.as_ref().map(|m| (b, m))).map_or(
                String::new(),
                |(b, m)| format!(
                    ", against {}′ and {}′ for {} on the same instrument with the same noise",
                    number::significant(m.latitude_error_arcmin.max, 3),
                    number::significant(m.longitude_error_arcmin.max, 3),
                    b.label
                )
            )
        ),
        (None, Some(Calibration { worst_normalized_error: Some(worst), .. })) => {
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

fn figures(summary: &Summary) -> Markup {
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
                (figure("Latitude error, largest", "arcmin", n.latitude_error_arcmin.max, 3,
                    other_navigation.map(|o| o.latitude_error_arcmin.max)))
                (figure("Longitude error, largest", "arcmin", n.longitude_error_arcmin.max, 3,
                    other_navigation.map(|o| o.longitude_error_arcmin.max)))
                (figure("Radial error rate", "nmi/h", n.radial_error_nmi.rate_per_h, 2,
                    other_navigation.map(|o| o.radial_error_nmi.rate_per_h)))
            }
            @if let Some(c) = &summary.calibration {
                @if let Some(nis) = c.nis_mean {
                    (figure("Mean NIS, 3 expected", "", nis, 3, other_calibration.and_then(|o| o.nis_mean)))
                }
                @if let Some(worst) = c.worst_normalized_error {
                    (figure("Worst parameter error", "σ", worst, 2,
                        other_calibration.and_then(|o| o.worst_normalized_error)))
                }
            }
        }
    }
}

fn requirements(summary: &Summary) -> Markup {
    html! {
        h2 { "Requirements" }
        @if summary.requirements.is_empty() {
            p.empty { "No requirement was checked: the run shows what happened, and asks nothing of it." }
        } @else {
            table {
                thead { tr {
                    th { "Requirement" } th { "Measure" } th.n { "Limit" } th.n { "Value" }
                    th.n { "Margin" } th.n { "Verdict" }
                } }
                tbody {
                    @for r in &summary.requirements {
                        tr {
                            td { strong { (r.id) } }
                            td { span.mono { (r.measure) }
                                @if let Some(reason) = &r.reason { div.reason { (reason) } } }
                            td.n { (sign(r.comparison.sign())) " " (number::plain(r.limit, 4)) }
                            td.n { (r.value.map_or_else(|| "–".to_owned(), |v| number::significant(v, 4))) }
                            td.n { (r.margin.map_or_else(|| "–".to_owned(), |v| number::significant(v, 3))) }
                            td.n { (badge(r.verdict)) }
                        }
                    }
                }
            }
        }
    }
}

fn sign(sign: &str) -> &str {
    match sign {
        "<=" => "≤",
        ">=" => "≥",
        other => other,
    }
}

/// The navigations of a summary with their names.
fn navigations(summary: &Summary) -> Vec<(&str, Role, &Navigation)> {
    let mut all = Vec::new();
    if let Some(n) = &summary.navigation {
        all.push((summary.method.as_str(), Role::Primary, n));
    }
    if let Some(baseline) = &summary.baseline
        && let Some(n) = &baseline.navigation
    {
        all.push((baseline.label.as_str(), Role::Baseline, n));
    }
    all
}

fn drift(summary: &Summary) -> Markup {
    let all = navigations(summary);
    if all.is_empty() {
        return html! {};
    }
    let chart = |name: &str, column: usize| {
        let title = format!("{name} error");
        let mut chart = Chart::new(&title, "hours of navigation", &format!("{title}, arcmin"));
        if let Some(r) = &summary.reference {
            if let Some(floor) = &r.random_walk {
                let points = floor.sigma.iter().map(|p| {
                    let s = if column == 1 { p.latitude_arcmin } else { p.longitude_arcmin };
                    [p.hours, -s, s]
                });
                chart.bands.push(Band {
                    label: "±1σ of random walk alone".to_owned(),
                    role: Role::Reference,
                    points: points.collect(),
                });
            }
            if column == 1 {
                let minutes = number::fixed(r.schuler_period_min, 1);
                chart.bracket =
                    Some((r.schuler_period_min / 60.0, format!("Schuler period {minutes} min")));
            }
        }
        // The method under test is drawn last, on top.
        for (label, role, n) in all.iter().rev() {
            chart.lines.push(Line {
                label: (*label).to_owned(),
                role: *role,
                points: n.series_hours.iter().map(|p| [p[0], p[column]]).collect(),
            });
        }
        chart.render()
    };
    html! {
        h2 { "Navigation" }
        p.hint { "Errors are navigation minus truth. The band is what the noise of the sensors would \
            leave with exact parameters and exact initial attitude: on average no calibration gets below it." }
        (chart("Latitude", 1))
        (chart("Longitude", 2))
        (drift_table(summary, &all))
    }
}

/// One row of the drift table: what, unit, value of each method, reference, what the reference is.
struct DriftRow<'a> {
    name: &'a str,
    values: Vec<Option<f64>>,
    reference: Option<f64>,
    about: &'a str,
}

fn drift_table(summary: &Summary, all: &[(&str, Role, &Navigation)]) -> Markup {
    let reference = summary.reference.as_ref();
    let floor = reference.and_then(|r| r.random_walk.as_ref());
    let walk = "random walk alone, expected";
    let row = |name, value: &dyn Fn(&Navigation) -> Option<f64>, reference, about| DriftRow {
        name,
        values: all.iter().map(|(_, _, n)| value(n)).collect(),
        reference,
        about,
    };
    let rows = [
        row("Latitude error, largest, arcmin", &|n| Some(n.latitude_error_arcmin.max), None, ""),
        row(
            "Latitude error, rms, arcmin",
            &|n| Some(n.latitude_error_arcmin.rms),
            floor.map(|f| f.latitude_rms_arcmin),
            walk,
        ),
        row(
            "Latitude error, final, arcmin",
            &|n| Some(n.latitude_error_arcmin.r#final),
            floor.map(|f| f.latitude_final_arcmin),
            "1σ of random walk alone",
        ),
        row(
            "Latitude slope, arcmin/day",
            &|n| n.latitude_error_arcmin.slope_per_day,
            Some(0.0),
            "no constant drift moves latitude for long",
        ),
        row("Longitude error, largest, arcmin", &|n| Some(n.longitude_error_arcmin.max), None, ""),
        row(
            "Longitude error, rms, arcmin",
            &|n| Some(n.longitude_error_arcmin.rms),
            floor.map(|f| f.longitude_rms_arcmin),
            walk,
        ),
        row(
            "Longitude error, final, arcmin",
            &|n| Some(n.longitude_error_arcmin.r#final),
            floor.map(|f| f.longitude_final_arcmin),
            "1σ of random walk alone",
        ),
        row(
            "Longitude slope, arcmin/day",
            &|n| n.longitude_error_arcmin.slope_per_day,
            reference.and_then(|r| r.residual_g_zz).map(|d| d.longitude_arcmin_per_day),
            "from the error of the estimated g_zz",
        ),
        row("Radial error, largest, nmi", &|n| Some(n.radial_error_nmi.max), None, ""),
        row(
            "Radial error, time-RMS, nmi",
            &|n| Some(n.radial_error_nmi.rms),
            floor.map(|f| f.radial_rms_nmi),
            walk,
        ),
        row("Radial error rate, nmi/h", &|n| Some(n.radial_error_nmi.rate_per_h), None, ""),
    ];
    html! {
        h3 { "Drift scores beside what physics says" }
        table {
            thead { tr {
                th { "Score" }
                @for (label, role, _) in all {
                    th.n { span class=(if *role == Role::Primary { "primary-text" } else { "baseline-text" }) { (label) } }
                }
                th.n { "Reference" } th style="padding-left:14px" { "The reference is" }
            } }
            tbody {
                @for row in &rows {
                    tr {
                        td { (row.name) }
                        @for value in &row.values { td.n { (number::optional(*value, 3)) } }
                        td.n { (number::optional(row.reference, 3)) }
                        td.reason style="padding-left:14px" { @if row.reference.is_some() { (row.about) } }
                    }
                }
            }
        }
        @if let Some(window) = all[0].2.slope_window.as_ref() {
            p.hint { "Slopes are by regression together with the Schuler oscillation"
                @if window.of == "sidereal days" { " and the daily one" }
                ", over " (window.periods) " " (window.of) " (" (number::fixed(window.hours, 2)) " h). "
                "Rate: regression of radial error on time through the origin." }
        }
        @if let Some(r) = reference { (closed_forms(r)) }
    }
}

fn closed_forms(r: &Reference) -> Markup {
    let drift = |label: &str, d: Option<crate::score::reference::VerticalDrift>| {
        html! { @if let Some(d) = d {
            tr {
                td { (label) }
                td.n { (number::significant(d.g_zz_deg_per_h_per_g, 3)) }
                td.n { (number::fixed(d.longitude_arcmin_per_day, 3)) }
                td.n { (number::fixed(d.latitude_bound_arcmin, 3)) }
            }
        } }
    };
    html! {
        table {
            thead { tr {
                th { "What a vertical drift from g_zz does at this site" } th.n { "g_zz, deg/h/g" }
                th.n { "longitude, arcmin/day" } th.n { "latitude at most, arcmin" }
            } }
            tbody {
                (drift("5e-4 deg/h/g, not compensated", Some(r.table_g_zz)))
                (drift("true g_zz of this run, not compensated", r.true_g_zz))
                (drift("left by this method", r.residual_g_zz))
                (drift("left by the baseline", r.baseline_residual_g_zz))
            }
        }
    }
}

fn calibration(data: &ReportData) -> Markup {
    let summary = &data.summary;
    let Some(calibration) = &summary.calibration else { return html! {} };
    let baseline = summary.baseline.as_ref();
    let beyond = crate::score::parameters::beyond(&calibration.parameters, 3.0);
    html! {
        h2 { "Calibrated parameters" }
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
        (parameters::table(calibration, baseline.and_then(|b| b.calibration.as_ref())))
        (convergence(data))
        (nis(data))
    }
}

fn convergence(data: &ReportData) -> Markup {
    if data.convergence.len() < 2 {
        return html! {};
    }
    let panel = |group: Group| {
        let unit = group.si_per_unit();
        let sigmas = |p: &ParameterPoint| {
            p.sigma[group.range()].iter().map(|s| s / unit).filter(|s| *s > 0.0).collect::<Vec<_>>()
        };
        if data.convergence.iter().all(|p| sigmas(p).is_empty()) {
            return html! {};
        }
        let name = parameters::title(group);
        let mut chart = Chart::new(name, "h", &format!("{name}, {}", group.unit()));
        (chart.width, chart.height) = (360.0, 210.0);
        chart.legend = false;
        chart.logarithmic = true;
        chart.bands.push(Band {
            label: "σ".to_owned(),
            role: Role::Primary,
            points: data
                .convergence
                .iter()
                .filter_map(|p| {
                    let s = sigmas(p);
                    let low = s.iter().copied().reduce(f64::min)?;
                    Some([p.hours, low, s.into_iter().fold(low, f64::max)])
                })
                .collect(),
        });
        if let Some(truth) = data.truth {
            let truth = truth.to_array();
            let error = |p: &ParameterPoint| {
                let e = p.estimate.to_array();
                let sum: f64 = group.range().map(|i| (e[i] - truth[i]) * (e[i] - truth[i])).sum();
                libm::sqrt(sum / group.range().len() as f64) / unit
            };
            chart.lines.push(Line {
                label: "rms error".to_owned(),
                role: Role::Primary,
                points: data.convergence.iter().map(|p| [p.hours, error(p)]).collect(),
            });
        }
        chart.render()
    };
    html! {
        h3 { "Convergence" }
        p.hint { "Band: smallest to largest σ of the group. "
            @if data.truth.is_some() { "Line: rms of the group's true errors. " }
            "Of a consistent filter the line lies about the band." }
        div.multiples { @for group in Group::ALL { (panel(group)) } }
    }
}

/// 2.5th and 97.5th percentile of χ² with three degrees of freedom.
const CHI_SQUARED_3: [f64; 2] = [0.2158, 9.3484];

fn nis(data: &ReportData) -> Markup {
    let finite: Vec<NisPoint> = data.nis.iter().copied().filter(|p| p.nis.is_finite()).collect();
    if finite.len() < 2 {
        return html! {};
    }
    let size = finite.len().div_ceil(240);
    let means: Vec<[f64; 2]> = finite
        .chunks(size)
        .filter(|c| 2 * c.len() > size)
        .map(|c| {
            let n = c.len() as f64;
            [c.iter().map(|p| p.hours).sum::<f64>() / n, c.iter().map(|p| p.nis).sum::<f64>() / n]
        })
        .collect();
    // The mean of n values of χ²₃ has variance 6/n.
    let half = 1.96 * libm::sqrt(6.0 / size as f64);
    let ends = [means.first().map_or(0.0, |p| p[0]), means.last().map_or(1.0, |p| p[0])];
    let mut chart = Chart::new("NIS", "hours of calibration", "Mean NIS, three axes");
    chart.height = 190.0;
    let highest = means.iter().map(|p| p[1]).fold(3.0 + half, f64::max);
    chart.y_range = Some([0.0, (1.1 * highest).max(6.0)]);
    chart.bands.push(Band {
        label: "95 % of means that are right".to_owned(),
        role: Role::Reference,
        points: ends.iter().map(|&x| [x, (3.0 - half).max(0.0), 3.0 + half]).collect(),
    });
    chart.lines.push(Line {
        label: format!("mean of {size} measurements"),
        role: Role::Primary,
        points: means,
    });
    chart.levels.push((3.0, String::new()));
    let [low, high] = CHI_SQUARED_3;
    let inside = finite.iter().filter(|p| (low..=high).contains(&p.nis)).count();
    html! {
        h3 { "Innovations" }
        p.hint { (number::fixed(100.0 * inside as f64 / finite.len() as f64, 1)) " % of "
            (finite.len()) " values lie in the 95 % interval of single ones, 0.22 to 9.35; the mean should be 3." }
        (chart.render())
    }
}

fn gimbals(data: &ReportData) -> Markup {
    if data.gimbals.len() < 2 {
        return html! {};
    }
    let mut chart = Chart::new("Gimbal angles", "hours of the run", "Gimbal angles, deg");
    chart.height = 200.0;
    let angle = |f: &dyn Fn(&GimbalPoint) -> f64| {
        data.gimbals.iter().map(|p| [p.hours, f(p)]).collect::<Vec<_>>()
    };
    chart.y_step = {
        let all = data.gimbals.iter().flat_map(|p| [p.azimuth_deg, p.roll_deg]);
        let (low, high) = all.fold((0.0f64, 0.0f64), |(l, h), a| (l.min(a), h.max(a)));
        Some(if high - low > 500.0 { 180.0 } else { 90.0 })
    };
    chart.lines.push(Line {
        label: "azimuth (inner)".to_owned(),
        role: Role::Primary,
        points: angle(&|p| p.azimuth_deg),
    });
    chart.lines.push(Line {
        label: "roll (outer)".to_owned(),
        role: Role::Second,
        points: angle(&|p| p.roll_deg),
    });
    let steps = || data.gimbals.windows(2);
    let moves = steps().filter(|w| !w[0].moving && w[1].moving).count();
    let moving_h: f64 = steps().filter(|w| w[1].moving).map(|w| w[1].hours - w[0].hours).sum();
    let still =
        1.0 - moving_h / (data.gimbals[data.gimbals.len() - 1].hours - data.gimbals[0].hours);
    html! {
        h2 { "Gimbals" }
        p.hint { (moves) " moves; the gimbals stood still "
            (number::fixed(100.0 * still, 1))
            " % of the time shown." }
        (chart.render())
    }
}

fn events(data: &ReportData) -> Markup {
    const SHOWN: usize = 40;
    html! {
        h2 { "Health" }
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
        h2 { "Provenance" }
        table {
            tbody {
                tr { td { "octant" } td.mono { (summary.octant) } }
                tr { td { "stream hash" } td.mono { (summary.stream_hash) } }
                @if let Some(b) = &summary.baseline {
                    tr { td { "stream hash, " (b.label) } td.mono { (b.stream_hash) } }
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
