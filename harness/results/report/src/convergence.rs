//! Parameters over the calibration: σ and error of each group, error of each parameter with ±σ.

use super::chart::{Band, Chart, Line, Role};
use super::data::ReportData;
use super::parameters::title;
use maud::{Markup, html};
use octant_sample::Parameters;
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_score::points::ParameterPoint;

/// Renders the convergence; empty for fewer than two points.
pub(super) fn convergence(data: &ReportData) -> Markup {
    if data.convergence.len() < 2 {
        return html! {};
    }
    html! {
        h3 { "Convergence" }
        p.hint { "Band: smallest to largest σ of the group. "
            @if data.truth.is_some() { "Line: rms of the group's true errors. " }
            "Of a consistent filter the line lies about the band." }
        div.multiples { @for group in ParameterGroup::ALL { (panel(data, group)) } }
        @if let Some(truth) = &data.truth {
            h3 { "Error of every parameter" }
            p.hint { "Estimate minus true value, with ±σ of the filter as the band. Each scale is that of the \
                second half of the calibration." }
            div.multiples.small { @for group in ParameterGroup::ALL { (errors(data, truth, group)) } }
        }
    }
}

fn panel(data: &ReportData, group: ParameterGroup) -> Markup {
    let unit = group.si_per_unit();
    let sigmas = |p: &ParameterPoint| {
        p.sigma[group.range()].iter().map(|s| s / unit).filter(|s| *s > 0.0).collect::<Vec<_>>()
    };
    if data.convergence.iter().all(|p| sigmas(p).is_empty()) {
        return html! {};
    }
    let name = title(group);
    let mut chart = Chart::new(name, "h", &format!("{name}, {}", group.unit()));
    (chart.width, chart.height) = (360.0, 210.0);
    chart.run_offset_h = Some(0.0);
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
}

/// Draws the error of each parameter of a group that is estimated.
fn errors(data: &ReportData, truth: &Parameters, group: ParameterGroup) -> Markup {
    let estimated = |i: &usize| data.convergence.iter().any(|p| p.sigma[*i] > 0.0);
    let indices: Vec<usize> = group.range().filter(estimated).collect();
    html! {
        @for i in indices { (parameter(data, truth, group, i)) }
    }
}

fn parameter(data: &ReportData, truth: &Parameters, group: ParameterGroup, i: usize) -> Markup {
    let unit = group.si_per_unit();
    let truth = truth.to_array()[i];
    let error = |p: &ParameterPoint| (p.estimate.to_array()[i] - truth) / unit;
    let sigma = |p: &ParameterPoint| p.sigma[i] / unit;
    let mut chart = Chart::new(NAMES[i], "h", &format!("{}, {}", NAMES[i], group.unit()));
    (chart.width, chart.height) = (300.0, 150.0);
    chart.run_offset_h = Some(0.0);
    chart.legend = false;
    // The prior is thousands of times the result: the second half sets the scale.
    let later = &data.convergence[data.convergence.len() / 2..];
    let reach = later.iter().map(|p| error(p).abs().max(1.5 * sigma(p))).filter(|r| r.is_finite());
    let reach = 1.25 * reach.fold(0.0, f64::max);
    if reach > 0.0 {
        chart.y_range = Some([-reach, reach]);
    }
    chart.bands.push(Band {
        label: "±σ".to_owned(),
        role: Role::Primary,
        points: data.convergence.iter().map(|p| [p.hours, -sigma(p), sigma(p)]).collect(),
    });
    chart.lines.push(Line {
        label: "error".to_owned(),
        role: Role::Primary,
        points: data.convergence.iter().map(|p| [p.hours, error(p)]).collect(),
    });
    chart.render()
}
