//! History of a run: drift, NIS and lateness over run time.

use super::style::SOFT;
use crate::series::Series;
use crate::state::RunState;
use octant_base::number::{decimals_for, fixed};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::text::{Line, Span};
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType, Paragraph};

/// A curve with its name.
type Curve<'a> = (&'static str, &'a Series, Color, GraphType);

pub(super) fn draw(frame: &mut Frame<'_>, area: Rect, state: &RunState) {
    let drift = [
        ("latitude", &state.latitude, Color::Cyan, GraphType::Line),
        ("longitude", &state.longitude, Color::Magenta, GraphType::Line),
    ];
    let nis = [("NIS", &state.nis_series, Color::Green, GraphType::Scatter)];
    let late = [("late", &state.lateness, Color::Yellow, GraphType::Line)];
    let hours = state.time_ns as f64 / 3.6e12;
    let paced = state.about.by_clock || state.pace.is_some();
    let parts = if paced { 3 } else { 2 };
    let areas = Layout::vertical(vec![Constraint::Ratio(1, parts); parts as usize]).split(area);
    draw_curves(frame, areas[0], " Latitude and longitude error, arcmin ", hours, &drift);
    draw_curves(frame, areas[1], " NIS (expected 3) ", hours, &nis);
    if paced {
        draw_curves(frame, areas[2], " Largest lateness of each second, µs ", hours, &late);
    }
}

fn draw_curves(frame: &mut Frame<'_>, area: Rect, title: &str, hours: f64, curves: &[Curve<'_>]) {
    let block = Block::bordered().title(title);
    let points = || curves.iter().flat_map(|(_, series, ..)| series.points());
    if points().nth(1).is_none() {
        let nothing = Line::styled("nothing to draw yet", SOFT);
        frame.render_widget(Paragraph::new(nothing).block(block), area);
        return;
    }
    let bounds = |of: fn(&(f64, f64)) -> f64| {
        let values = points().map(of);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let axis = |bounds: [f64; 2], scale: f64, unit: &str| {
        let decimals = decimals_for((bounds[1] - bounds[0]) * scale, 3);
        let labels = [bounds[0], (bounds[0] + bounds[1]) / 2.0, bounds[1]];
        let label = |value: f64| Span::raw(fixed(value * scale, decimals) + unit);
        Axis::default().style(SOFT).bounds(bounds).labels(labels.map(label))
    };
    let (scale, unit) = match hours {
        ..0.05 => (3600.0, " s"),
        ..3.0 => (60.0, " min"),
        _ => (1.0, " h"),
    };
    // From the start of the run, so that the time axes of the curves agree.
    let x = [0.0, hours.max(f64::MIN_POSITIVE)];
    let y = bounds(|point| point.1);
    // A flat line has no height of its own.
    let y = if y[1] > y[0] { y } else { [y[0] - 1.0, y[1] + 1.0] };
    let datasets = curves.iter().map(|(name, series, color, graph)| {
        Dataset::default()
            .name(*name)
            .marker(Marker::Braille)
            .graph_type(*graph)
            .style(Style::new().fg(*color))
            .data(series.points())
    });
    let chart = Chart::new(datasets.collect())
        .block(block)
        .x_axis(axis(x, scale, unit))
        .y_axis(axis(y, 1.0, ""))
        .hidden_legend_constraints((Constraint::Ratio(1, 2), Constraint::Ratio(3, 4)));
    frame.render_widget(chart, area);
}
