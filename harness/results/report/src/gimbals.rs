//! Gimbal angles by phase of the run.

use super::chart::{Chart, Line, Role};
use super::data::ReportData;
use super::marks::phases;
use maud::{Markup, html};
use octant_base::number;
use octant_score::points::GimbalPoint;

/// Number of moves that one drawing tells apart.
const MOVES_MAX: usize = 60;
/// Number of moves drawn of a phase with more.
const MOVES_SHOWN: usize = 32;

/// Renders the gimbals of each phase; empty for fewer than two points.
pub(super) fn gimbals(data: &ReportData) -> Markup {
    if data.gimbals.len() < 2 {
        return html! {};
    }
    let cut = data
        .navigation_start_h
        .map_or(data.gimbals.len(), |start| data.gimbals.partition_point(|p| p.hours < start));
    let (before, after) = data.gimbals.split_at(cut);
    let title =
        if data.summary.calibration.is_some() { "Calibration" } else { "Before navigation" };
    html! {
        (phase(if after.is_empty() { "Run" } else { title }, before))
        (phase("Navigation", after))
    }
}

fn phase(title: &str, points: &[GimbalPoint]) -> Markup {
    if points.len() < 2 {
        return html! {};
    }
    let (moves, _) = phases(points, &[]);
    let (from, to) = (points[0].hours, points[points.len() - 1].hours);
    let moving_h: f64 = moves.iter().map(|(start, end, _)| end - start).sum();
    let still = 100.0 * (1.0 - moving_h / (to - from).max(f64::MIN_POSITIVE));
    // A phase of many moves is all alike: its beginning shows them.
    let shown_to = if moves.len() > MOVES_MAX { moves[MOVES_SHOWN].0 } else { to };
    let shown: Vec<&GimbalPoint> = points.iter().filter(|p| p.hours <= shown_to).collect();
    html! {
        h3 { (title) }
        p.hint {
            (number::counted(moves.len() as u64, "move", "moves")) " in "
            (number::plain(to - from, 4)) " h; the gimbals stood still " (number::fixed(still, 1)) " % of the time."
            @if shown_to < to { " The first " (MOVES_SHOWN) " moves are drawn." }
        }
        (chart(&shown))
    }
}

fn chart(points: &[&GimbalPoint]) -> Markup {
    let mut chart = Chart::new("Gimbal angles", "hours of the run", "Gimbal angles, deg");
    chart.height = 200.0;
    chart.run_offset_h = Some(0.0);
    let angle = |f: &dyn Fn(&GimbalPoint) -> f64| {
        points.iter().map(|p| [p.hours, f(p)]).collect::<Vec<_>>()
    };
    chart.y_step = {
        let all = points.iter().flat_map(|p| [p.azimuth_deg, p.roll_deg]);
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
    chart.render()
}
