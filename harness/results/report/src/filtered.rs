//! Errors of attitude and velocity while a filter calibrates, with its own σ.

use super::chart::{Band, Chart, Line, Role};
use super::data::ReportData;
use super::solution::COLUMNS;
use maud::{Markup, html};
use octant_score::run_series::SolutionSeries;

/// Part of the calibration that doesn't set the scale: the filter begins with the σ of its prior.
const BEGINNING: f64 = 0.1;

/// Renders one plot for each quantity of which error or σ is known; empty if none is.
pub(super) fn filtered(data: &ReportData) -> Markup {
    let charts: Vec<Markup> = (0..COLUMNS.len()).filter_map(|column| plot(data, column)).collect();
    let known = !sigma(data).is_empty();
    let truth = !data.calibration_errors.points(0).is_empty();
    html! {
        @if !charts.is_empty() {
            h3 { "Attitude and velocity" }
            p.hint {
                @if truth { "Computed minus true during the calibration. Attitude is that of the case: the gimbals are \
                    turned back by their true angles. " }
                @if known { "Band: ±σ of the filter, from its covariance after a measurement." }
                @else { "The filter's σ isn't known: a core over a wire or in an FMU tells none." }
            }
            div.plots { @for chart in &charts { (chart) } }
        }
    }
}

/// Rows of the filter's σ.
fn sigma(data: &ReportData) -> &[[f64; 6]] {
    data.summary.calibration.as_ref().map_or(&[], |calibration| &calibration.sigma_hours)
}

fn plot(data: &ReportData, column: usize) -> Option<Markup> {
    let (name, title) = COLUMNS[column];
    let unit = data.units.of(name);
    let series = |of: &SolutionSeries| -> Vec<[f64; 2]> {
        of.points(column).into_iter().map(|p| [p[0], unit.of(p[1])]).collect()
    };
    let (errors, sigma) = (series(&data.calibration_errors), sigma(data));
    if errors.len() < 2 && sigma.len() < 2 {
        return None;
    }
    let y_label = format!("{title}, {}", unit.name);
    let title = format!("{title} during the calibration");
    let mut chart = Chart::new(&title, "hours of the run", &y_label);
    chart.height = 190.0;
    chart.run_offset_h = Some(0.0);
    if sigma.len() >= 2 {
        chart.bands.push(Band {
            label: "±σ of the filter".to_owned(),
            role: Role::Primary,
            points: sigma
                .iter()
                .map(|row| (row[0], unit.of(row[column + 1])))
                .map(|(hours, sigma)| [hours, -sigma, sigma])
                .collect(),
        });
    }
    if let Some(baseline) = &data.summary.baseline {
        let points = series(&data.baseline_calibration_errors);
        if points.len() >= 2 {
            let label = baseline.label.clone();
            chart.lines.push(Line { label, role: Role::Baseline, points });
        }
    }
    if errors.len() >= 2 {
        let label = data.summary.method.clone();
        chart.lines.push(Line { label, role: Role::Primary, points: errors });
    }
    chart.y_range = scale(&chart);
    chart.levels.push((0.0, String::new()));
    Some(chart.render())
}

/// Range of y that shows everything but the beginning; `None` where all of it is alike.
#[must_use]
pub fn scale(chart: &Chart) -> Option<[f64; 2]> {
    let lines = || chart.lines.iter().flat_map(|line| line.points.iter().copied());
    let bands = || chart.bands.iter().flat_map(|band| band.points.iter().map(|p| [p[0], p[2]]));
    let all = || lines().chain(bands()).filter(|p| p[1].is_finite());
    let from = all().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let to = all().map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
    let begins = from + BEGINNING * (to - from);
    let reach =
        |least: f64| all().filter(|p| p[0] >= least).map(|p| p[1].abs()).fold(0.0, f64::max);
    let (later, whole) = (reach(begins), reach(from));
    (later > 0.0 && whole > 1.5 * later).then_some([-1.25 * later, 1.25 * later])
}
