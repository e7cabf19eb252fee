//! Scales of a static drawing, and its parts as SVG.

use super::model::{Band, Chart, Line};
use super::ticks::{
    decades, exponents, hour_ticks, is_round, nice_ticks, round, span, thinned, whole_ticks,
};
use maud::{Markup, html};
use octant_base::number;

/// Space for the labels of y, px; longer labels get more.
pub(super) const LEFT: f64 = 52.0;
/// Width of a digit in the labels, px, with reserve for wide fonts.
const GLYPH: f64 = 7.0;

/// Room beside the points of an axis of decades, decades.
const DECADE_ROOM: f64 = 0.08;

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
pub(super) struct Frame {
    pub(super) x: [f64; 2],
    pub(super) y: [f64; 2],
    x_ticks: Vec<(f64, String)>,
    pub(super) y_ticks: Vec<(f64, String)>,
    pub(super) left: f64,
    pub(super) right: f64,
    pub(super) top: f64,
    pub(super) bottom: f64,
    logarithmic: bool,
}

impl Frame {
    pub(super) fn of(chart: &Chart) -> Option<Self> {
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
        // Points at the ends have room for their dots.
        let room =
            if chart.paired { 0.5 } else { f64::from(u8::from(chart.decades)) * DECADE_ROOM };
        let x = [x[0] - room, x[1] + room];
        if x[1] <= x[0] {
            return None;
        }
        let x_ticks: Vec<(f64, String)> = if chart.decades {
            exponents(x).into_iter().map(|e| (e, number::plain(libm::pow(10.0, e), 1))).collect()
        } else {
            let ticks =
                if chart.hours { hour_ticks(x, chart.width / 75.0) } else { whole_ticks(x) };
            ticks.into_iter().map(|tick| (tick, number::plain(tick, 3))).collect()
        };
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

    pub(super) fn grid(&self, chart: &Chart) -> Markup {
        html! {
            @for (tick, label) in &self.y_ticks {
                @let y = round(self.py(*tick));
                path class=(if *tick == 0.0 { "grid zero" } else { "grid" })
                    d={ "M" (self.left) " " (y) "H" (self.right) } {}
                text class="tick y" x=(self.left - 7.0) y=(y + 3.8) { (label) }
            }
            @for (tick, label) in &self.x_ticks {
                @let x = round(self.px(*tick));
                path class="mark" d={ "M" (x) " " (self.bottom) "v5" } {}
                text class="tick x" x=(x) y=(self.bottom + 18.0) { (label) }
            }
            path class="axis" d={ "M" (self.left) " " (self.bottom) "H" (self.right) } {}
            text class="tick xlabel" x=(self.right) y=(self.bottom + 33.0) { (chart.x_label) }
        }
    }

    pub(super) fn level(&self, value: f64, label: &str) -> Markup {
        let y = round(self.py(value));
        html! {
            path class="line reference" d={ "M" (self.left) " " (y) "H" (self.right) } {}
            text class="note" x=(self.right - 4.0) y=(y - 5.0) { (label) }
        }
    }

    pub(super) fn bracket(&self, length: f64, label: &str) -> Markup {
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

    pub(super) fn pairs(&self, lines: &[Line]) -> Markup {
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

    /// Draws a dot at every point of a line.
    pub(super) fn dots(&self, line: &Line) -> Markup {
        html! {
            @for [x, y] in line.points.iter().filter(|p| p[1].is_finite()) {
                circle class={ "dot " (line.role.class()) } cx=(round(self.px(*x))) cy=(round(self.py(*y))) r="3" {}
            }
        }
    }

    pub(super) fn path(&self, points: &[[f64; 2]]) -> String {
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

    pub(super) fn area(&self, band: &Band) -> String {
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
