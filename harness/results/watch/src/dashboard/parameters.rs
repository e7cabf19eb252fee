//! Values of the thirty parameters with their σ.

use super::style::{ALERT, SOFT};
use crate::plain;
use crate::state::RunState;
use octant_base::number::{decimals_for, fixed};
use octant_sample::Parameters;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::parameters::{NAMES, ParameterGroup};
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::Style;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Block, Paragraph};

/// Error, in σ, beyond which a parameter is marked.
const BEYOND_SIGMA: f64 = 3.0;

/// Width from which a group has its name, its values and its unit on one line, with the borders.
const FULL_WIDTH: usize = 100;

pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, state: &RunState) {
    let block = Block::bordered();
    let Some((ns, estimate)) = &state.parameters else {
        let line = Line::styled("none yet", SOFT);
        frame.render_widget(Paragraph::new(line).block(block.title(" Parameters ")), area);
        return;
    };
    let mut title = format!(" Parameters ±1σ, of {} ", plain::time(*ns));
    if let Some(truth) = &state.about.truth {
        title += &format!("· {} ", beyond(estimate, truth));
    }
    let full = usize::from(area.width) >= FULL_WIDTH;
    if !full {
        // The worst has the lower border for itself.
        let (of_time, worst) = title.split_once("· ").unwrap_or((title.as_str(), ""));
        let bottom = if worst.is_empty() { String::new() } else { format!(" {worst}") };
        let block = block.title(of_time.to_owned()).title_bottom(bottom);
        let lines = small(estimate, state.about.truth.as_ref());
        frame.render_widget(Paragraph::new(lines).block(block), area);
        return;
    }
    let mut lines = Vec::new();
    for group in ParameterGroup::ALL {
        let indices: Vec<usize> = group.range().collect();
        for (k, three) in indices.chunks(3).enumerate() {
            let name = if k == 0 { name(group) } else { "" };
            let mut line = Line::styled(format!("{name:14}"), SOFT);
            for i in three {
                line.extend(one(*i, group, estimate, state.about.truth.as_ref()));
            }
            line.push_span(Span::styled(if k == 0 { unit(group) } else { "" }, SOFT));
            lines.push(line);
        }
    }
    frame.render_widget(Paragraph::new(lines).block(block.title(title)), area);
}

/// Lists the parameters in seventy-eight columns, each group under its name and unit.
fn small(estimate: &ParameterEstimate, truth: Option<&Parameters>) -> Vec<Line<'static>> {
    let mut lines = Vec::new();
    for group in ParameterGroup::ALL {
        lines.push(Line::styled(
            format!("{}, {}", group.name().replace('_', " "), unit(group)),
            SOFT,
        ));
        let indices: Vec<usize> = group.range().collect();
        for three in indices.chunks(3) {
            let mut line = Line::raw("  ");
            for i in three {
                line.extend(one(*i, group, estimate, truth));
            }
            lines.push(line);
        }
    }
    lines
}

/// Renders axis, value and σ in twenty-five columns.
fn one(
    i: usize,
    group: ParameterGroup,
    estimate: &ParameterEstimate,
    truth: Option<&Parameters>,
) -> [Span<'static>; 3] {
    let unit = group.si_per_unit();
    let sigma = estimate.sigma[i];
    let value = estimate.parameters.to_array()[i];
    let axis = NAMES[i].rsplit('_').next().unwrap_or_default();
    let axis = Span::styled(format!("{axis:>3} "), SOFT);
    if !(sigma > 0.0) {
        let text = format!("{:>9}", fixed(value / unit, 4));
        return [axis, Span::raw(text), Span::styled(format!("{:>11} ", "not est."), SOFT)];
    }
    let decimals = decimals_for(sigma / unit, 2).min(6);
    let off = truth.map_or(0.0, |truth| (value - truth.to_array()[i]) / sigma);
    let style = if off.abs() > BEYOND_SIGMA { ALERT } else { Style::new() };
    [
        axis,
        Span::styled(format!("{:>9}", fixed(value / unit, decimals)), style),
        Span::styled(format!(" ±{:<9} ", fixed(sigma / unit, decimals)), SOFT),
    ]
}

/// Compares the estimates with the truth in the scenario.
fn beyond(estimate: &ParameterEstimate, truth: &Parameters) -> String {
    let errors = estimate.parameters.to_array();
    let truth = truth.to_array();
    let worst = (0..errors.len())
        .filter(|i| estimate.sigma[*i] > 0.0)
        .map(|i| ((errors[i] - truth[i]).abs() / estimate.sigma[i], i))
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match worst {
        Some((off, i)) => format!("{} is {} σ off, the worst", NAMES[i], fixed(off, 1)),
        None => "none is estimated".to_owned(),
    }
}

/// Returns the unit, as customary in the field.
const fn unit(group: ParameterGroup) -> &'static str {
    match group {
        ParameterGroup::AccelBias => "µg",
        other => other.unit(),
    }
}

const fn name(group: ParameterGroup) -> &'static str {
    match group {
        ParameterGroup::GyroBias => "gyro bias",
        ParameterGroup::GyroScale => "gyro scale",
        ParameterGroup::GyroMisalignment => "gyro misal.",
        ParameterGroup::GDependent => "g-dependent",
        ParameterGroup::AccelBias => "accel. bias",
        ParameterGroup::AccelScale => "accel. scale",
        ParameterGroup::AccelMisalignment => "accel. misal.",
    }
}
