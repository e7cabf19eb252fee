//! Errors of attitude and velocity over the navigation, and the track of the position error.

use super::chart::{Chart, Line, Role, nice_ticks, round};
use super::data::ReportData;
use maud::{Markup, html};
use octant_base::number;

/// Names of the columns of the series, as the scores have them, with their titles.
const COLUMNS: [(&str, &str); 5] = [
    ("heading", "Heading error"),
    ("pitch", "Pitch error"),
    ("roll", "Roll error"),
    ("north", "Velocity error north"),
    ("east", "Velocity error east"),
];

/// Renders one plot for each error that is known; empty if none is.
pub(super) fn errors(data: &ReportData) -> Markup {
    let charts: Vec<Markup> = COLUMNS
        .iter()
        .enumerate()
        .filter_map(|(column, (name, title))| {
            let unit = data.units.of(name);
            let series = |of: &super::series::SolutionSeries| -> Vec<[f64; 2]> {
                of.points(column).into_iter().map(|p| [p[0], unit.of(p[1])]).collect()
            };
            let points = series(&data.solution);
            if points.len() < 2 {
                return None;
            }
            let mut chart =
                Chart::new(title, "hours of navigation", &format!("{title}, {}", unit.name));
            chart.height = 190.0;
            chart.run_offset_h = data.navigation_start_h;
            if let Some(baseline) = &data.summary.baseline {
                let points = series(&data.baseline_solution);
                if points.len() >= 2 {
                    let label = baseline.label.clone();
                    chart.lines.push(Line { label, role: Role::Baseline, points });
                }
            }
            let label = data.summary.method.clone();
            chart.lines.push(Line { label, role: Role::Primary, points });
            chart.levels.push((0.0, String::new()));
            Some(chart.render())
        })
        .collect();
    html! {
        @if !charts.is_empty() {
            h3 { "Attitude and velocity" }
            p.hint { "Errors are computed minus true. Attitude is that of the case: the gimbals are turned back \
                by their true angles. Velocity is over ground." }
            div.plots { @for chart in &charts { (chart) } }
        }
    }
}

/// Edge of the square drawing, px.
const EDGE: f64 = 420.0;
/// Space around it, px.
const MARGIN: f64 = 46.0;

/// Renders the position error on the ground: north over east, with equal scales.
pub(super) fn track(data: &ReportData) -> Markup {
    let Some(latitude_rad) = data.latitude_rad else { return html! {} };
    let shrink = libm::cos(latitude_rad);
    let of = |rows: &[[f64; 3]]| -> Vec<[f64; 3]> {
        // A minute of latitude is a nautical mile, within half a per cent.
        rows.iter()
            .map(|[hours, latitude, longitude]| [*hours, longitude * shrink, *latitude])
            .collect()
    };
    let mut tracks = Vec::new();
    if let Some(n) = data.summary.baseline.as_ref().and_then(|b| b.navigation.as_ref()) {
        tracks.push(("baseline", of(&n.series_hours)));
    }
    if let Some(n) = &data.summary.navigation {
        tracks.push(("primary", of(&n.series_hours)));
    }
    let largest = tracks
        .iter()
        .flat_map(|(_, points)| points.iter().flat_map(|p| [p[1].abs(), p[2].abs()]))
        .filter(|value| value.is_finite())
        .fold(0.0, f64::max);
    if largest <= 0.0 {
        return html! {};
    }
    let reach = 1.08 * largest;
    let scale = (EDGE - 2.0 * MARGIN) / (2.0 * reach);
    let x = |east: f64| round(EDGE / 2.0 + east * scale);
    let y = |north: f64| round(EDGE / 2.0 - north * scale);
    let ticks = nice_ticks([-reach, reach], 4, None);
    let decimals = ticks.get(1).map_or(0, |second| number::decimals_for(second - ticks[0], 1));
    html! {
        h3 { "Ground track of the position error" }
        p.hint { "Computed minus true position on the ground. Dots are whole hours; the ring is where it began." }
        div.track {
            svg viewBox={ "0 0 " (EDGE) " " (EDGE) } role="img" aria-label="Ground track of the position error" {
                @for tick in &ticks {
                    path class=(if *tick == 0.0 { "grid zero" } else { "grid" }) d={ "M" (x(-reach)) " " (y(*tick)) "H" (x(reach)) } {}
                    path class=(if *tick == 0.0 { "grid zero" } else { "grid" }) d={ "M" (x(*tick)) " " (y(-reach)) "V" (y(reach)) } {}
                    text class="tick y" x=(x(-reach) - 6.0) y=(y(*tick) + 3.8) { (number::fixed(*tick, decimals)) }
                    text class="tick x" x=(x(*tick)) y=(y(-reach) + 17.0) { (number::fixed(*tick, decimals)) }
                }
                text class="tick xlabel" x=(x(reach)) y=(EDGE - 6.0) { "east, nmi" }
                text class="note start" x=(x(-reach)) y="26" { "north, nmi" }
                @for (role, points) in &tracks {
                    path class={ "line " (role) } d=(path(points, &x, &y)) {}
                    @for p in hourly(points) { circle class={ "dot " (role) } cx=(x(p[1])) cy=(y(p[2])) r="2.2" {} }
                }
                circle.origin cx=(x(0.0)) cy=(y(0.0)) r="5" {}
            }
        }
    }
}

fn path(points: &[[f64; 3]], x: &dyn Fn(f64) -> f64, y: &dyn Fn(f64) -> f64) -> String {
    let mut path = String::new();
    let mut last = [f64::NAN; 2];
    for p in points.iter().filter(|p| p[1].is_finite() && p[2].is_finite()) {
        let now = [x(p[1]), y(p[2])];
        if now == last {
            continue;
        }
        path.push_str(if path.is_empty() { "M" } else { "L" });
        path.push_str(&format!("{} {}", now[0], now[1]));
        last = now;
    }
    path
}

/// Points nearest after each whole hour; of a long navigation every third, sixth or twelfth hour.
fn hourly(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let end = points.last().map_or(0.0, |p| p[0]);
    let step =
        [1.0, 3.0, 6.0, 12.0, 24.0].into_iter().find(|step| end / step <= 30.0).unwrap_or(48.0);
    let mut next = step;
    let mut found = Vec::new();
    for p in points {
        if p[0] >= next {
            found.push(*p);
            next = (libm::floor(p[0] / step) + 1.0) * step;
        }
    }
    found
}
