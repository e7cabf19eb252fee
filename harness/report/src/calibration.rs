//! Calibration of a run: parameters, their convergence, innovations.

use super::chart::{Band, Chart, ChartLine, ChartRole};
use super::data::{NisPoint, ParameterPoint, ReportData};
use super::parameters;
use maud::{Markup, html};
use octant_base::number;
use octant_sample::parameters::ParameterGroup;

pub(super) fn calibration(data: &ReportData) -> Markup {
    let summary = &data.summary;
    let Some(calibration) = &summary.calibration else { return html! {} };
    let baseline = summary.baseline.as_ref();
    let beyond = octant_score::parameters::beyond(&calibration.parameters, 3.0);
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
    let panel = |group: ParameterGroup| {
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
            role: ChartRole::Primary,
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
            chart.lines.push(ChartLine {
                label: "rms error".to_owned(),
                role: ChartRole::Primary,
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
        div.multiples { @for group in ParameterGroup::ALL { (panel(group)) } }
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
        label: "95 % confidence interval of the mean".to_owned(),
        role: ChartRole::Reference,
        points: ends.iter().map(|&x| [x, (3.0 - half).max(0.0), 3.0 + half]).collect(),
    });
    chart.lines.push(ChartLine {
        label: format!("mean of {size} measurements"),
        role: ChartRole::Primary,
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
