//! Navigation of a run: errors over time, scores beside their analytic references.

use super::chart::{Band, Chart, Line, Role};
use super::data::ReportData;
use super::heading_output;
use super::scores::scores;
use super::solution;
use maud::{Markup, html};
use octant_base::display::{DisplayUnits, ShownUnit};
use octant_base::number;
use octant_score::reference::{AnalyticReference, VerticalDrift};
use octant_score::summary::{NavigationScore, Summary};

/// Lists the navigations of a summary with their names.
fn navigations(summary: &Summary) -> Vec<(&str, Role, &NavigationScore)> {
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

pub(super) fn drift(data: &ReportData) -> Markup {
    let (summary, units) = (&data.summary, &data.units);
    let all = navigations(summary);
    if all.is_empty() {
        return html! {};
    }
    let chart = |name: &str, column: usize| {
        let title = format!("{name} error");
        let unit = if column == 1 { units.latitude() } else { units.longitude() };
        let axis = format!("{title}, {}", unit.name);
        let mut chart = Chart::new(&title, "hours of navigation", &axis);
        chart.run_offset_h = data.navigation_start_h;
        if let Some(r) = &summary.reference {
            if let Some(floor) = &r.random_walk {
                let points = floor.sigma.iter().map(|p| {
                    let s = if column == 1 { p.latitude_arcmin } else { p.longitude_arcmin };
                    [p.hours, -unit.of(s), unit.of(s)]
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
                points: n.series_hours.iter().map(|p| [p[0], unit.of(p[column])]).collect(),
            });
        }
        chart.render()
    };
    html! {
        p.hint {
            "Errors are navigation minus truth."
            @if summary.reference.as_ref().is_some_and(|reference| reference.random_walk.is_some()) {
                " The band is what the noise of the sensors would leave with exact parameters and exact \
                 initial attitude: on average no calibration gets below it."
            }
        }
        h3 { "Position" }
        div.plots {
            (chart("Latitude", 1))
            (chart("Longitude", 2))
        }
        (solution::errors(data))
        (solution::track(data))
        @if let Some(output) = summary.navigation.as_ref().and_then(|n| n.heading_output.as_deref()) {
            (heading_output::section(output))
        }
        (scores(
            &all.iter().map(|(label, _, n)| (*label, *n)).collect::<Vec<_>>(),
            summary.reference.as_ref().and_then(|r| r.random_walk.as_ref()),
            units,
        ))
        (drift_table(summary, &all, units))
    }
}

/// One row of the drift table: quantity, unit, value of each method, reference, description of the
/// reference.
struct DriftRow<'a> {
    name: String,
    values: Vec<Option<f64>>,
    reference: Option<f64>,
    about: &'a str,
}

fn drift_table(
    summary: &Summary,
    all: &[(&str, Role, &NavigationScore)],
    units: &DisplayUnits,
) -> Markup {
    let reference = summary.reference.as_ref();
    let floor = reference.and_then(|r| r.random_walk.as_ref());
    let walk = "random walk alone, expected";
    let (latitude, longitude, radial) = (units.latitude(), units.longitude(), units.radial());
    let row = |name: &str,
               unit: ShownUnit,
               per: &str,
               value: &dyn Fn(&NavigationScore) -> Option<f64>,
               reference: Option<f64>,
               about| DriftRow {
        name: format!("{name}, {}{per}", unit.name),
        values: all.iter().map(|(_, _, n)| value(n).map(|v| unit.of(v))).collect(),
        reference: reference.map(|v| unit.of(v)),
        about,
    };
    let last = "1σ of random walk alone";
    let rows = [
        row(
            "Latitude error, largest",
            latitude,
            "",
            &|n| Some(n.latitude_error_arcmin?.max),
            None,
            "",
        ),
        row(
            "Latitude error, rms",
            latitude,
            "",
            &|n| Some(n.latitude_error_arcmin?.rms),
            floor.map(|f| f.latitude_rms_arcmin),
            walk,
        ),
        row(
            "Latitude error, final",
            latitude,
            "",
            &|n| Some(n.latitude_error_arcmin?.r#final),
            floor.map(|f| f.latitude_final_arcmin),
            last,
        ),
        row(
            "Latitude slope",
            latitude,
            "/day",
            &|n| n.latitude_error_arcmin?.slope_per_day,
            Some(0.0),
            "no constant drift moves latitude for long",
        ),
        row(
            "Longitude error, largest",
            longitude,
            "",
            &|n| Some(n.longitude_error_arcmin?.max),
            None,
            "",
        ),
        row(
            "Longitude error, rms",
            longitude,
            "",
            &|n| Some(n.longitude_error_arcmin?.rms),
            floor.map(|f| f.longitude_rms_arcmin),
            walk,
        ),
        row(
            "Longitude error, final",
            longitude,
            "",
            &|n| Some(n.longitude_error_arcmin?.r#final),
            floor.map(|f| f.longitude_final_arcmin),
            last,
        ),
        row(
            "Longitude slope",
            longitude,
            "/day",
            &|n| n.longitude_error_arcmin?.slope_per_day,
            reference.and_then(|r| r.residual_g_zz).map(|d| d.longitude_arcmin_per_day),
            "from the error of the estimated g_zz",
        ),
        row("Radial error, largest", radial, "", &|n| Some(n.radial_error_nmi?.max), None, ""),
        row(
            "Radial error, time-RMS",
            radial,
            "",
            &|n| Some(n.radial_error_nmi?.rms),
            floor.map(|f| f.radial_rms_nmi),
            walk,
        ),
        row("Radial error rate", radial, "/h", &|n| Some(n.radial_error_nmi?.rate_per_h), None, ""),
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
        @if let Some(r) = reference { (closed_forms(r, units)) }
    }
}

fn closed_forms(r: &AnalyticReference, units: &DisplayUnits) -> Markup {
    let (latitude, longitude) = (units.latitude(), units.longitude());
    let drift = |label: &str, d: Option<VerticalDrift>| {
        html! { @if let Some(d) = d {
            tr {
                td { (label) }
                td.n { (number::significant(d.g_zz_deg_per_h_per_g, 3)) }
                td.n { (number::fixed(longitude.of(d.longitude_arcmin_per_day), 3)) }
                td.n { (number::fixed(latitude.of(d.latitude_bound_arcmin), 3)) }
            }
        } }
    };
    html! {
        table {
            thead { tr {
                th { "What a vertical drift from g_zz does at this site" } th.n { "g_zz, deg/h/g" }
                th.n { "longitude, " (longitude.name) "/day" } th.n { "latitude at most, " (latitude.name) }
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
