//! Convergence of the estimates with the number of cases.

use super::drift::DRAWN_MAX;
use super::elements::heading;
use maud::{Markup, html};
use octant_campaign::report::CampaignReport;
use octant_report::chart::{Band, Chart, Line, Role};
use octant_statistics::convergence::ConvergenceStep;

pub(super) fn section(report: &CampaignReport<'_>) -> Markup {
    let requirements = || report.statistics.requirements.iter().filter(|r| r.convergence.len() > 1);
    let drifts = || {
        (report.combinations.iter().zip(&report.statistics.combinations))
            .filter(|(_, figures)| figures.convergence_r95.len() > 1)
    };
    let unit = report.units.shown().radial();
    let radial = format!("radial error at the end, {}", unit.name);
    html! {
        (heading("convergence"))
        @if requirements().count() + drifts().count() == 0 {
            p.empty { "There are too few cases to see anything settle." }
        } @else {
            p.hint { "Estimates from the first draws of the plan, with intervals at 95 %, where the draws are enough for one." }
            div.multiples {
                @for r in requirements() {
                    (chart(&r.id, "probability that a draw passes, %", &[("passed", Role::Primary, &r.convergence)], 100.0))
                }
                @for (combination, figures) in drifts().take(DRAWN_MAX) {
                    (chart(&combination.name(), &radial, &[
                        ("CEP50", Role::Primary, &figures.convergence_cep50),
                        ("R95", Role::Baseline, &figures.convergence_r95),
                    ], unit.factor))
                }
            }
        }
    }
}

fn chart(
    of: &str,
    unit: &str,
    estimates: &[(&str, Role, &Vec<ConvergenceStep>)],
    factor: f64,
) -> Markup {
    let mut chart = Chart::new(&format!("{of}: {unit} by number of draws"), "draws", unit);
    (chart.width, chart.height, chart.hours) = (320.0, 190.0, false);
    for (label, role, steps) in estimates {
        let bounded = steps
            .iter()
            .filter(|step| step.estimate.low.is_finite() && step.estimate.high.is_finite());
        chart.bands.push(Band {
            label: format!("{label}, 95 %"),
            role: *role,
            points: bounded
                .map(|s| [s.runs as f64, factor * s.estimate.low, factor * s.estimate.high])
                .collect(),
        });
        chart.lines.push(Line {
            label: (*label).to_owned(),
            role: *role,
            points: steps.iter().map(|s| [s.runs as f64, factor * s.estimate.value]).collect(),
        });
    }
    // A band without points would be drawn empty, and still named in the legend.
    chart.bands.retain(|band| band.points.len() > 1);
    html! { div { div.reason { (of) } (chart.render()) } }
}
