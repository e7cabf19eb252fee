//! Errors of attitude and velocity over the navigation, and the track of the position error.

use super::chart::{Band, Chart, Line, Role, nice_ticks, round, span};
use super::data::ReportData;
use maud::{Markup, html};
use octant_base::number;
use octant_score::floor::FloorPoint;

/// Names of the columns of the series, as the scores have them, with their titles.
pub(super) const COLUMNS: [(&str, &str); 5] = [
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
            let series = |of: &octant_score::run_series::SolutionSeries| -> Vec<[f64; 2]> {
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
            chart.bands.extend(random_walk(data, name));
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
                by their true angles. Velocity is over ground."
                @if COLUMNS.iter().any(|(name, _)| random_walk(data, name).is_some()) {
                    " The band is, as for the position, what the noise of the sensors leaves with exact parameters \
                    and exact initial attitude: 1σ of a level case. The core tells no covariance while it navigates."
                }
            }
            div.plots { @for chart in &charts { (chart) } }
        }
    }
}

/// Band of an error by the random walk of the sensors alone; `None` without one in the summary.
fn random_walk(data: &ReportData, name: &str) -> Option<Band> {
    let floor = data.summary.reference.as_ref()?.random_walk.as_ref()?;
    let unit = data.units.of(name);
    let point = |point: &FloorPoint| {
        let sigma = unit.of(point.solution?.of(name)?);
        Some([point.hours, -sigma, sigma])
    };
    let points: Vec<[f64; 3]> = floor.sigma.iter().filter_map(point).collect();
    (points.len() > 1).then(|| Band {
        label: "±1σ of random walk alone".to_owned(),
        role: Role::Reference,
        points,
    })
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
    // The origin belongs to the track.
    let extent = |column: usize| -> [f64; 2] {
        let values = tracks.iter().flat_map(|(_, points)| points.iter().map(move |p| p[column]));
        span(values.filter(|value| value.is_finite()).chain([0.0])).unwrap_or_default()
    };
    let (east, north) = (extent(1), extent(2));
    let largest = (east[1] - east[0]).max(north[1] - north[0]);
    if largest <= 0.0 {
        return html! {};
    }
    let reach = 0.54 * largest;
    let around = |range: [f64; 2]| {
        let middle = 0.5 * (range[0] + range[1]);
        [middle - reach, middle + reach]
    };
    let (east, north) = (around(east), around(north));
    let scale = (EDGE - 2.0 * MARGIN) / (2.0 * reach);
    let x = |value: f64| round(MARGIN + (value - east[0]) * scale);
    let y = |value: f64| round(EDGE - MARGIN - (value - north[0]) * scale);
    let step = nice_ticks(east, 4, None);
    let step = step.get(1).map(|second| second - step[0]);
    let decimals = step.map_or(0, |step| number::decimals_for(step, 1));
    html! {
        h3 { "Ground track of the position error" }
        p.hint { "Computed minus true position on the ground. Dots are whole hours; the ring is where it began." }
        div.track {
            svg viewBox={ "0 0 " (EDGE) " " (EDGE) } role="img" aria-label="Ground track of the position error" {
                @for tick in nice_ticks(north, 4, step) {
                    path class=(if tick == 0.0 { "grid zero" } else { "grid" }) d={ "M" (MARGIN) " " (y(tick)) "H" (EDGE - MARGIN) } {}
                    text class="tick y" x=(MARGIN - 6.0) y=(y(tick) + 3.8) { (number::fixed(tick, decimals)) }
                }
                @for tick in nice_ticks(east, 4, step) {
                    path class=(if tick == 0.0 { "grid zero" } else { "grid" }) d={ "M" (x(tick)) " " (MARGIN) "V" (EDGE - MARGIN) } {}
                    text class="tick x" x=(x(tick)) y=(EDGE - MARGIN + 17.0) { (number::fixed(tick, decimals)) }
                }
                text class="tick xlabel" x=(EDGE - MARGIN) y=(EDGE - 6.0) { "east, nmi" }
                text class="note start" x=(MARGIN) y="26" { "north, nmi" }
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
