//! Line charts as inline SVG. Colours are classes of the page's style sheet, so that a chart adapts
//! to light, dark and print; without the style sheet only the colour is lost.

use maud::{Markup, html};
use octant_base::number;

/// Meaning of a line or band: the style sheet assigns colour and dash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChartRole {
    /// The method under test.
    Primary,
    /// Method of comparison.
    Baseline,
    /// A second quantity of the same method.
    Second,
    /// Expected value.
    Reference,
}

impl ChartRole {
    const fn class(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Baseline => "baseline",
            Self::Second => "second",
            Self::Reference => "reference",
        }
    }
}

/// A line.
#[derive(Clone, Debug)]
pub struct ChartLine {
    /// Name in the legend.
    pub label: String,
    /// Meaning, which sets colour and dash.
    pub role: ChartRole,
    /// Points in order of x; NaN breaks the line.
    pub points: Vec<[f64; 2]>,
}

/// An area between two lines.
#[derive(Clone, Debug)]
pub struct Band {
    /// Name in the legend.
    pub label: String,
    /// Meaning, which sets colour and dash.
    pub role: ChartRole,
    /// x, lower, upper.
    pub points: Vec<[f64; 3]>,
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Title, also as the text alternative.
    pub title: String,
    /// Label below the x axis.
    pub x_label: String,
    /// Label above the y axis, with unit.
    pub y_label: String,
    /// Width of the drawing in px; the page scales it.
    pub width: f64,
    /// Height of the drawing in px.
    pub height: f64,
    /// True if x is in hours, with ticks at 1, 2, 3, 6, 12, 24 h; else x counts.
    pub hours: bool,
    /// True if y is logarithmic: values that aren't positive are left out.
    pub logarithmic: bool,
    /// Limits of y; `None`: chosen from the lines.
    pub y_range: Option<[f64; 2]>,
    /// Ticks of y; `None`: chosen automatically.
    pub y_step: Option<f64>,
    /// Bands, drawn first.
    pub bands: Vec<Band>,
    /// Lines.
    pub lines: Vec<ChartLine>,
    /// Horizontal lines with a label.
    pub levels: Vec<(f64, String)>,
    /// Length of a bracket on the x axis with its label: a reference period.
    pub bracket: Option<(f64, String)>,
    /// True if a legend is shown above.
    pub legend: bool,
    /// True if points of all lines with the same x belong together: dots, joined across the lines.
    pub paired: bool,
}

impl Chart {
    /// Creates an empty chart.
    #[must_use]
    pub fn new(title: &str, x_label: &str, y_label: &str) -> Self {
        Self {
            title: title.to_owned(),
            x_label: x_label.to_owned(),
            y_label: y_label.to_owned(),
            width: 960.0,
            height: 250.0,
            hours: true,
            logarithmic: false,
            y_range: None,
            y_step: None,
            bands: Vec::new(),
            lines: Vec::new(),
            levels: Vec::new(),
            bracket: None,
            legend: true,
            paired: false,
        }
    }

    /// Renders the chart as HTML: legend and SVG. A chart without points says so.
    #[must_use]
    pub fn render(&self) -> Markup {
        let Some(frame) = Frame::of(self) else {
            return html! { p.empty { (self.title) ": no data" } };
        };
        html! {
            div.chart {
                div.caption {
                    span.ylabel { (self.y_label) }
                    @if self.legend { (self.legend_markup()) }
                }
                svg viewBox={ "0 0 " (self.width) " " (self.height) } role="img"
                    aria-label=(self.title)
                    data-x=(format!("{} {} {} {}", frame.x[0], frame.x[1], frame.left, frame.right))
                    data-y=(format!("{} {} {} {}", frame.y[0], frame.y[1], frame.bottom, frame.top))
                    data-log=(self.logarithmic) {
                    (frame.grid(self))
                    @for band in &self.bands {
                        path class={ "band " (band.role.class()) } d=(frame.area(band)) {}
                    }
                    @for (value, label) in &self.levels { (frame.level(*value, label)) }
                    @if self.paired { (frame.pairs(&self.lines)) } @else {
                        @for line in &self.lines {
                            path class={ "line " (line.role.class()) } data-label=(line.label)
                                d=(frame.path(&line.points)) {}
                        }
                    }
                    @if let Some((length, label)) = &self.bracket { (frame.bracket(*length, label)) }
                    line class="cursor" x1="0" x2="0" y1=(frame.top) y2=(frame.bottom) {}
                }
            }
        }
    }

    fn legend_markup(&self) -> Markup {
        // The main line is drawn last, on top, and named first.
        html! {
            span.legend {
                @for line in self.lines.iter().rev() {
                    span.key {
                        svg.swatch viewBox="0 0 24 8" aria-hidden="true" {
                            @if self.paired { circle class={ "dot " (line.role.class()) } cx="12" cy="4" r="4" {} }
                            @else { path class={ "line " (line.role.class()) } d="M1 4H23" {} }
                        }
                        (line.label)
                    }
                }
                @for band in &self.bands {
                    span.key {
                        svg.swatch viewBox="0 0 24 8" aria-hidden="true" {
                            path class={ "band " (band.role.class()) } d="M1 0H23V8H1Z" {}
                        }
                        (band.label)
                    }
                }
            }
        }
    }
}

/// Space for the labels of y, px; longer labels get more.
const LEFT: f64 = 52.0;
/// Width of a digit in the labels, px, with reserve for wide fonts.
const GLYPH: f64 = 7.0;

/// Formats ticks of y with their labels.
fn labelled(ticks: Vec<f64>, logarithmic: bool) -> Vec<(f64, String)> {
    let decimals = ticks.get(1).map_or(0, |second| {
        let step = second - ticks[0];
        number::decimals_for(step, if is_round(step) { 1 } else { 2 })
    });
    let label = |tick: f64| {
        if logarithmic { number::significant(tick, 1) } else { number::fixed(tick, decimals) }
    };
    ticks.into_iter().map(|tick| (tick, label(tick))).collect()
}

/// The drawing area and its scales.
struct Frame {
    x: [f64; 2],
    y: [f64; 2],
    x_ticks: Vec<f64>,
    y_ticks: Vec<(f64, String)>,
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
    logarithmic: bool,
}

impl Frame {
    fn of(chart: &Chart) -> Option<Self> {
        let usable = |y: f64| y.is_finite() && (!chart.logarithmic || y > 0.0);
        let lines = chart.lines.iter().flat_map(|l| l.points.iter().map(|p| (p[0], p[1])));
        let bands = chart
            .bands
            .iter()
            .flat_map(|b| b.points.iter().flat_map(|p| [(p[0], p[1]), (p[0], p[2])]));
        let all: Vec<(f64, f64)> =
            lines.chain(bands).filter(|(x, y)| x.is_finite() && usable(*y)).collect();
        let x = span(all.iter().map(|p| p.0))?;
        let levels = chart.levels.iter().map(|l| l.0).filter(|y| usable(*y));
        let needed = span(all.iter().map(|p| p.1).chain(levels))?;
        let x = if chart.paired { [x[0] - 0.5, x[1] + 0.5] } else { x };
        if x[1] <= x[0] {
            return None;
        }
        let x_ticks = if chart.hours { hour_ticks(x, chart.width / 75.0) } else { whole_ticks(x) };
        let (y, y_ticks) = if chart.logarithmic {
            decades(chart.y_range.unwrap_or(needed))
        } else if let Some(range) = chart.y_range {
            (range, nice_ticks(range, 5, chart.y_step))
        } else {
            let room = if needed[1] > needed[0] { 0.04 * (needed[1] - needed[0]) } else { 1.0 };
            // A bracket needs space above the lines.
            let above = if chart.bracket.is_some() { 3.5 * room } else { room };
            let range = [needed[0] - room, needed[1] + above];
            (range, nice_ticks(range, 5, chart.y_step))
        };
        let y_ticks = labelled(y_ticks, chart.logarithmic);
        let longest = y_ticks.iter().map(|(_, label)| label.chars().count()).max().unwrap_or(0);
        Some(Self {
            x,
            y,
            x_ticks,
            y_ticks,
            left: LEFT.max(GLYPH * longest as f64 + 12.0),
            right: chart.width - 8.0,
            top: 8.0,
            bottom: chart.height - 36.0,
            logarithmic: chart.logarithmic,
        })
    }

    fn px(&self, x: f64) -> f64 {
        self.left + (x - self.x[0]) / (self.x[1] - self.x[0]) * (self.right - self.left)
    }

    fn py(&self, y: f64) -> f64 {
        let part = if self.logarithmic {
            libm::log10(y / self.y[0]) / libm::log10(self.y[1] / self.y[0])
        } else {
            (y - self.y[0]) / (self.y[1] - self.y[0])
        };
        self.bottom - part.clamp(-0.02, 1.02) * (self.bottom - self.top)
    }

    fn grid(&self, chart: &Chart) -> Markup {
        html! {
            @for (tick, label) in &self.y_ticks {
                @let y = round(self.py(*tick));
                path class=(if *tick == 0.0 { "grid zero" } else { "grid" })
                    d={ "M" (self.left) " " (y) "H" (self.right) } {}
                text class="tick y" x=(self.left - 7.0) y=(y + 3.8) { (label) }
            }
            @for tick in &self.x_ticks {
                @let x = round(self.px(*tick));
                path class="mark" d={ "M" (x) " " (self.bottom) "v5" } {}
                text class="tick x" x=(x) y=(self.bottom + 18.0) { (number::plain(*tick, 3)) }
            }
            path class="axis" d={ "M" (self.left) " " (self.bottom) "H" (self.right) } {}
            text class="tick xlabel" x=(self.right) y=(self.bottom + 33.0) { (chart.x_label) }
        }
    }

    fn level(&self, value: f64, label: &str) -> Markup {
        let y = round(self.py(value));
        html! {
            path class="line reference" d={ "M" (self.left) " " (y) "H" (self.right) } {}
            text class="note" x=(self.right - 4.0) y=(y - 5.0) { (label) }
        }
    }

    fn bracket(&self, length: f64, label: &str) -> Markup {
        let (from, to) = (self.left + 10.0, self.left + 10.0 + self.px(length) - self.px(0.0));
        let y = self.top + 6.0;
        if to > self.right {
            return html! {};
        }
        html! {
            path class="bracket" d={ "M" (round(from)) " " (y - 4.0) "v8m0 -4H" (round(to)) "m0 -4v8" } {}
            text class="note start" x=(round(to + 7.0)) y=(y + 4.0) { (label) }
        }
    }

    fn pairs(&self, lines: &[ChartLine]) -> Markup {
        let first = lines.first().map_or(&[][..], |l| &l.points[..]);
        html! {
            @for (i, [x, _]) in first.iter().enumerate() {
                @let of_x = || lines.iter().filter_map(|l| l.points.get(i)).map(|p| p[1]);
                @if let Some([low, high]) = span(of_x()) {
                    path.pair d={ "M" (round(self.px(*x))) " " (round(self.py(low))) "V" (round(self.py(high))) } {}
                }
            }
            @for line in lines { @for [x, y] in &line.points {
                circle class={ "dot " (line.role.class()) } cx=(round(self.px(*x))) cy=(round(self.py(*y))) r="4" {}
            } }
        }
    }

    fn path(&self, points: &[[f64; 2]]) -> String {
        let mut path = String::new();
        let mut pen_down = false;
        for [x, y] in thinned(points, (self.right - self.left) as usize) {
            if !y.is_finite() || (self.logarithmic && y <= 0.0) {
                pen_down = false;
                continue;
            }
            path.push_str(if pen_down { "L" } else { "M" });
            pen_down = true;
            path.push_str(&format!("{} {}", round(self.px(x)), round(self.py(y))));
        }
        path
    }

    fn area(&self, band: &Band) -> String {
        let floor = self.y[0];
        let at = |y: f64| if self.logarithmic { y.max(floor) } else { y };
        let upper = band.points.iter().map(|p| (p[0], p[2]));
        let lower = band.points.iter().rev().map(|p| (p[0], p[1]));
        let mut path = String::new();
        for (i, (x, y)) in upper.chain(lower).filter(|p| p.1.is_finite()).enumerate() {
            path.push_str(if i == 0 { "M" } else { "L" });
            path.push_str(&format!("{} {}", round(self.px(x)), round(self.py(at(y)))));
        }
        path.push('Z');
        path
    }
}

/// Keeps the extremes of every pixel column: at most four points for each.
pub fn thinned(points: &[[f64; 2]], columns: usize) -> Vec<[f64; 2]> {
    if points.len() <= 3 * columns.max(1) {
        return points.to_vec();
    }
    let chunk = points.len().div_ceil(columns.max(1));
    let mut kept = Vec::with_capacity(4 * columns);
    for part in points.chunks(chunk) {
        let mut indices = [0, 0, 0, part.len() - 1];
        for (i, point) in part.iter().enumerate() {
            if point[1] < part[indices[1]][1] {
                indices[1] = i;
            }
            if point[1] > part[indices[2]][1] {
                indices[2] = i;
            }
        }
        indices.sort_unstable();
        let mut last = None;
        for i in indices {
            if last != Some(i) {
                kept.push(part[i]);
                last = Some(i);
            }
        }
    }
    kept
}

/// Rounds to a tenth of a pixel, which is enough and keeps the file small.
pub fn round(px: f64) -> f64 {
    libm::round(px * 10.0) / 10.0
}

/// Returns whether a number is a whole multiple of a step.
pub fn multiples_of(number: f64, step: f64) -> bool {
    let ratio = number / step;
    (ratio - libm::round(ratio)).abs() < 1e-6
}

fn is_round(step: f64) -> bool {
    let mantissa = step / libm::pow(10.0, libm::floor(libm::log10(step) + 1e-9));
    (mantissa - libm::round(mantissa)).abs() < 1e-6
}

/// Smallest and largest of some values; `None` of no values.
pub fn span(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    values.fold(None, |range, v| {
        Some(range.map_or([v, v], |[low, high]: [f64; 2]| [low.min(v), high.max(v)]))
    })
}

/// Chooses multiples of 1, 2 or 5 times a power of ten within the range, about `count` of them.
pub fn nice_ticks(range: [f64; 2], count: u32, step: Option<f64>) -> Vec<f64> {
    let raw = (range[1] - range[0]) / f64::from(count);
    let power = libm::pow(10.0, libm::floor(libm::log10(raw)));
    let nice = [1.0, 2.0, 2.5, 5.0, 10.0].into_iter().find(|m| m * power >= raw).unwrap_or(10.0);
    multiples(range, step.unwrap_or(nice * power))
}

/// Chooses whole numbers as ticks of an axis that counts.
fn whole_ticks(range: [f64; 2]) -> Vec<f64> {
    let raw = (range[1] - range[0]) / 10.0;
    let step = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0]
        .into_iter()
        .find(|step| *step >= raw)
        .unwrap_or(libm::ceil(raw));
    multiples(range, step)
}

/// Chooses ticks of an axis in hours.
fn hour_ticks(range: [f64; 2], count: f64) -> Vec<f64> {
    let raw = (range[1] - range[0]) / count;
    let step = [1.0 / 6.0, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 24.0, 48.0, 96.0]
        .into_iter()
        .find(|step| *step >= raw)
        .unwrap_or(raw);
    multiples(range, step)
}

fn multiples(range: [f64; 2], step: f64) -> Vec<f64> {
    let first = libm::ceil(range[0] / step - 1e-9);
    let count = libm::floor(range[1] / step + 1e-9) - first;
    if !(0.0..=200.0).contains(&count) {
        return Vec::new();
    }
    (0..=count as u32).map(|k| (first + f64::from(k)) * step + 0.0).collect()
}

/// Chooses whole decades around a range, with one tick each.
fn decades(range: [f64; 2]) -> ([f64; 2], Vec<f64>) {
    let low = libm::floor(libm::log10(range[0]) + 1e-9);
    let high = libm::ceil(libm::log10(range[1]) - 1e-9).max(low + 1.0);
    let ticks = (0..=(high - low) as u32).map(|k| libm::pow(10.0, low + f64::from(k))).collect();
    ([libm::pow(10.0, low), libm::pow(10.0, high)], ticks)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(nice_ticks([-0.3, 1.1], 5, None), [0.0, 0.5, 1.0]);
        assert_eq!(
            hour_ticks([0.0, 72.0], 12.0),
            (0..=12).map(|k| 6.0 * f64::from(k)).collect::<Vec<_>>()
        );
        assert_eq!(decades([0.02, 3.0]).0[1], 10.0);
    }

    #[test]
    fn thinning_keeps_a_lone_spike() {
        let mut points: Vec<[f64; 2]> = (0..100_000).map(|k| [f64::from(k), 0.0]).collect();
        points[54_321][1] = 7.0;
        let thin = thinned(&points, 900);
        assert!(thin.len() <= 3600);
        assert!(thin.contains(&[54_321.0, 7.0]));
    }

    #[test]
    fn long_labels_have_room() {
        let mut chart = Chart::new("Small", "h", "y");
        let line = |y: f64| vec![[0.0, 0.0], [1.0, y]];
        for (y, moves) in [(1.0, false), (3.4e-7, true), (-2.2e6, true)] {
            chart.lines =
                vec![ChartLine { label: String::new(), role: ChartRole::Primary, points: line(y) }];
            let frame = Frame::of(&chart).unwrap();
            let longest = frame.y_ticks.iter().map(|tick| tick.1.chars().count()).max().unwrap();
            assert!(frame.left - 7.0 >= 6.5 * longest as f64, "{:?}", frame.y_ticks);
            assert_eq!(frame.left > LEFT, moves, "{:?}", frame.y_ticks);
        }
    }

    #[test]
    fn a_chart_without_points_says_so() {
        let text = Chart::new("Nothing", "h", "y").render().into_string();
        assert!(text.contains("no data"), "{text}");
    }
}
