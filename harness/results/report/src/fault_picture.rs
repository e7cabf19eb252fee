//! Draws the effect of a fault: the quantity that it changes most, with and without the fault, and
//! the difference. One self-contained SVG that adapts to light and dark.

mod quantities;

use super::chart::{multiples_of, nice_ticks, round, span, thinned};
use maud::{Markup, PreEscaped, html};
use octant_base::number;
use octant_faults::catalogue::{Acts, Family, FaultKind};
use octant_sample::Reference;
pub use quantities::PictureStep;
use quantities::{
    ANSWERS, CHANNELS, COMMANDS, ENCODERS, Quantity, REFERENCE, STAMPS, STATUS, View, aiding,
};

const WIDTH: f64 = 760.0;
const LEFT: f64 = 78.0;
const RIGHT: f64 = 744.0;
/// Top and bottom of the two panels, px.
const UPPER: [f64; 2] = [66.0, 246.0];
const LOWER: [f64; 2] = [300.0, 400.0];
const HEIGHT: f64 = 446.0;
/// Largest number of points that are drawn as dots: so few are so far apart that a line would hide
/// the gaps between them, such as data once a second.
const DOTS_MAX: usize = 80;

/// Both runs, step by step from the start.
#[derive(Clone, Debug)]
pub struct PictureRuns<'a> {
    /// Steps without the fault.
    pub clean: Vec<PictureStep<'a>>,
    /// Steps with the fault.
    pub faulted: Vec<PictureStep<'a>>,
}

/// Part of the run that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PictureWindow {
    /// First step, from 1.
    pub from: u64,
    /// Step of the fault's onset.
    pub onset: u64,
    /// Last step.
    pub to: u64,
}

/// One quantity over the window, without and with the fault.
struct Series {
    quantity: &'static Quantity,
    clean: Vec<[f64; 2]>,
    faulted: Vec<[f64; 2]>,
}

impl Series {
    fn of(quantity: &'static Quantity, runs: &PictureRuns<'_>, view: &Frame) -> Self {
        let one = |steps: &[PictureStep<'_>]| {
            (view.window.from..=view.window.to)
                .map(|number| {
                    let t = (number as f64 - view.window.onset as f64) * view.period_s;
                    let of = View { period_s: view.period_s, number, origin: view.origin };
                    let step = steps.get(number as usize - 1);
                    [t, step.map_or(f64::NAN, |step| (quantity.of)(step, &of))]
                })
                .collect()
        };
        Self { quantity, clean: one(&runs.clean), faulted: one(&runs.faulted) }
    }

    fn difference(&self) -> Vec<[f64; 2]> {
        self.clean.iter().zip(&self.faulted).map(|(c, f)| [c[0], f[1] - c[1]]).collect()
    }

    /// Measures how far the two series part, in units of the quantity's scatter from step to step.
    fn parts(&self) -> f64 {
        let finite = |points: &[[f64; 2]]| -> Vec<f64> {
            points.iter().map(|p| p[1]).filter(|y| y.is_finite()).collect()
        };
        let clean = finite(&self.clean);
        let square: f64 = clean.windows(2).map(|w| (w[1] - w[0]).powi(2)).sum();
        let scatter = (square / clean.len().max(2) as f64).sqrt();
        let largest = finite(&self.difference()).into_iter().fold(0.0, |a: f64, d| a.max(d.abs()));
        let gone =
            self.clean.iter().zip(&self.faulted).any(|(c, f)| c[1].is_finite() != f[1].is_finite());
        let parts = largest / (scatter + self.quantity.resolution);
        if gone && parts < 1.0 { 1.0 } else { parts }
    }
}

struct Frame {
    window: PictureWindow,
    period_s: f64,
    origin: Option<[f64; 3]>,
}

/// Draws the effect of a kind of fault; `None` if nothing differs.
#[must_use]
pub fn picture(
    kind: &FaultKind,
    runs: &PictureRuns<'_>,
    window: PictureWindow,
    period_s: f64,
) -> Option<String> {
    let origin = runs.clean.iter().find_map(|step| match aiding(step)?.reference {
        Reference::Position { latitude_rad, longitude_rad, height_m } => {
            Some([latitude_rad, longitude_rad, height_m])
        }
        Reference::Velocity(_) => None,
    });
    let frame = Frame { window, period_s, origin };
    if kind.acts == Acts::Delivery {
        return Some(delivery(kind, runs, &frame).into_string());
    }
    let groups: &[&[Quantity]] = match (kind.acts, kind.family) {
        (Acts::Command, _) => &[&COMMANDS],
        (Acts::Unit, _) => &[&ANSWERS[..1], &ANSWERS[1..]],
        (Acts::Plant, Family::Turntable) => &[&ENCODERS, &CHANNELS],
        (Acts::Plant, _) => &[&CHANNELS],
        _ => &[&STAMPS, &REFERENCE, &ENCODERS, &CHANNELS, &STATUS],
    };
    let shown = groups.iter().find_map(|group| {
        group
            .iter()
            .map(|quantity| Series::of(quantity, runs, &frame))
            .map(|series| (series.parts(), series))
            .filter(|(parts, _)| *parts > 0.0)
            // The first of equals.
            .reduce(|most, next| if next.0 > most.0 { next } else { most })
            .map(|(_, series)| series)
    })?;
    Some(two_panels(kind, &shown).into_string())
}

/// Draws the numbers of the samples that arrive, and their count.
fn delivery(kind: &FaultKind, runs: &PictureRuns<'_>, frame: &Frame) -> Markup {
    let (mut numbers, mut counts) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for (side, steps) in [&runs.clean, &runs.faulted].into_iter().enumerate() {
        for number in frame.window.from..=frame.window.to {
            let t = (number as f64 - frame.window.onset as f64) * frame.period_s;
            let Some(step) = steps.get(number as usize - 1) else { continue };
            for epoch in step.delivered {
                let relative = epoch.sample.sequence as f64 - frame.window.onset as f64;
                numbers[side].push([t, relative]);
            }
            counts[side].push([t, step.delivered.len() as f64]);
        }
    }
    let upper = Panel {
        label: "numbers of the samples that arrive, from the onset on".to_owned(),
        place: UPPER,
        lines: vec![("clean", &numbers[0]), ("faulted", &numbers[1])],
        dots: true,
    };
    let lower = Panel {
        label: "samples in a step".to_owned(),
        place: LOWER,
        lines: vec![("clean", &counts[0]), ("faulted", &counts[1])],
        dots: true,
    };
    svg(kind, &[upper, lower])
}

fn two_panels(kind: &FaultKind, series: &Series) -> Markup {
    let difference = series.difference();
    let all: Vec<[f64; 2]> = series.clean.iter().chain(&series.faulted).copied().collect();
    let (unit, si) = unit(series.quantity, &all);
    let (difference_unit, difference_si) = unit_of_difference(series.quantity, &difference);
    let scaled = |points: &[[f64; 2]], si: f64| -> Vec<[f64; 2]> {
        points.iter().map(|p| [p[0], p[1] / si]).collect()
    };
    let (clean, faulted) = (scaled(&series.clean, si), scaled(&series.faulted, si));
    let difference = scaled(&difference, difference_si);
    let named = |name: &str, unit: &str| {
        if unit.is_empty() { name.to_owned() } else { format!("{name}, {unit}") }
    };
    let finite = clean.iter().filter(|p| p[1].is_finite()).count();
    let dots = finite <= DOTS_MAX;
    let upper = Panel {
        label: named(series.quantity.name, unit),
        place: UPPER,
        lines: vec![("clean", &clean), ("faulted", &faulted)],
        dots,
    };
    let lower = Panel {
        label: named("with the fault less without", difference_unit),
        place: LOWER,
        lines: vec![("difference", &difference)],
        dots,
    };
    svg(kind, &[upper, lower])
}

/// Chooses the largest unit in which the values reach a tenth.
fn unit(quantity: &Quantity, points: &[[f64; 2]]) -> (&'static str, f64) {
    let largest = points.iter().map(|p| p[1].abs()).filter(|y| y.is_finite()).fold(0.0, f64::max);
    let smallest = quantity.units.last().copied().unwrap_or(("", 1.0));
    // A tenth of a unit reads as well as a hundred of the next smaller one.
    quantity.units.iter().copied().find(|(_, si)| largest >= 0.1 * si).unwrap_or(smallest)
}

fn unit_of_difference(quantity: &Quantity, points: &[[f64; 2]]) -> (&'static str, f64) {
    unit(quantity, points)
}

/// One panel.
struct Panel<'a> {
    label: String,
    /// Top and bottom, px.
    place: [f64; 2],
    lines: Vec<(&'static str, &'a Vec<[f64; 2]>)>,
    dots: bool,
}

impl Panel<'_> {
    fn markup(&self) -> Markup {
        let points = || self.lines.iter().flat_map(|(_, points)| points.iter());
        let finite = || points().map(|p| p[1]).filter(|y| y.is_finite());
        let x = span(points().map(|p| p[0])).unwrap_or([0.0, 1.0]);
        let y = span(finite()).unwrap_or([0.0, 1.0]);
        let room = if y[1] > y[0] { 0.06 * (y[1] - y[0]) } else { 0.5 * y[0].abs().max(1.0) };
        let y = [y[0] - room, y[1] + room];
        let [top, bottom] = self.place;
        let px = |at: f64| LEFT + (at - x[0]) / (x[1] - x[0]) * (RIGHT - LEFT);
        let py = |at: f64| bottom - (at - y[0]) / (y[1] - y[0]) * (bottom - top);
        let count = ((bottom - top) / 30.0) as u32;
        let y_ticks = nice_ticks(y, count, None);
        let x_ticks = nice_ticks(x, 8, None);
        let decimals = |ticks: &[f64]| match ticks {
            [a, b, ..] => decimals(b - a),
            _ => 0,
        };
        let (x_decimals, y_decimals) = (decimals(&x_ticks), decimals(&y_ticks));
        html! {
            text class="label" x=(LEFT) y=(top - 8.0) { (self.label) }
            @for tick in &y_ticks {
                @let at = round(py(*tick));
                path class="grid" d={ "M" (LEFT) " " (at) "H" (RIGHT) } {}
                text class="tick y" x=(LEFT - 7.0) y=(at + 4.0) { (number::fixed(*tick, y_decimals)) }
            }
            @if (x[0]..=x[1]).contains(&0.0) {
                path class="onset" d={ "M" (round(px(0.0))) " " (top) "V" (bottom) } {}
            }
            path class="axis" d={ "M" (LEFT) " " (bottom) "H" (RIGHT) } {}
            @for tick in &x_ticks {
                @let at = round(px(*tick));
                path class="axis" d={ "M" (at) " " (bottom) "v4" } {}
                text class="tick x" x=(at) y=(bottom + 17.0) { (number::fixed(*tick, x_decimals)) }
            }
            @for (class, points) in &self.lines {
                @if self.dots {
                    @for [a, b] in points.iter().filter(|p| p[1].is_finite()) {
                        circle class=(class) cx=(round(px(*a))) cy=(round(py(*b)))
                            r=(if *class == "clean" { "4" } else { "2.2" }) {}
                    }
                } @else {
                    path class=(class) d=(path(&thinned(points, (RIGHT - LEFT) as usize), px, py)) {}
                }
            }
        }
    }
}

/// Returns the number of decimals that distinguish multiples of a step.
fn decimals(step: f64) -> usize {
    (0..9).find(|d| multiples_of(step, libm::pow(10.0, -f64::from(*d)))).unwrap_or(9) as usize
}

fn path(points: &[[f64; 2]], px: impl Fn(f64) -> f64, py: impl Fn(f64) -> f64) -> String {
    let mut out = String::new();
    let mut pen_down = false;
    for [x, y] in points {
        if y.is_finite() {
            out.push(if pen_down { 'L' } else { 'M' });
            out += &format!("{} {}", round(px(*x)), round(py(*y)));
        }
        pen_down = y.is_finite();
    }
    out
}

/// Colours of the reports.
const STYLE: &str = "\
svg{font:12px Inter,'Segoe UI','Helvetica Neue','Liberation Sans',Arial,sans-serif}\
.paper{fill:#fff}text{fill:#5b6470}.label{fill:#1b1f24;font-weight:600}\
.title{fill:#1b1f24;font-size:14px;font-weight:600}\
.y{text-anchor:end}.x{text-anchor:middle}.end{text-anchor:end}path{fill:none}\
.grid{stroke:#eceff2}.axis{stroke:#5b6470}.onset{stroke:#7a8490;stroke-dasharray:4 3}\
path.clean{stroke:#c4500a;stroke-width:2.2}path.faulted,path.difference{stroke:#0065a3;stroke-width:1.3}\
circle.clean{fill:#fff;stroke:#c4500a;stroke-width:1.4}circle.faulted,circle.difference{fill:#0065a3}\
@media(prefers-color-scheme:dark){.paper{fill:#14181d}text{fill:#9aa4af}\
.label,.title{fill:#e4e8ec}.grid{stroke:#232930}.axis{stroke:#9aa4af}\
path.clean{stroke:#f0a04b}path.faulted,path.difference{stroke:#5cb8ee}\
circle.clean{fill:#14181d;stroke:#f0a04b}circle.faulted,circle.difference{fill:#5cb8ee}}";

fn svg(kind: &FaultKind, panels: &[Panel<'_>]) -> Markup {
    let dots = panels.first().is_some_and(|panel| panel.dots);
    html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox={ "0 0 " (WIDTH) " " (HEIGHT) }
            width=(WIDTH) height=(HEIGHT) role="img" aria-label={ (kind.name) ": " (kind.summary) } {
            style { (PreEscaped(STYLE)) }
            rect class="paper" width=(WIDTH) height=(HEIGHT) {}
            text class="title" x="14" y="24" { (kind.name) }
            (key(RIGHT - 196.0, "clean", "without the fault", dots))
            (key(RIGHT - 76.0, "faulted", "with it", dots))
            @for panel in panels { (panel.markup()) }
            text class="end" x=(RIGHT) y=(HEIGHT - 10.0) { "seconds from the onset" }
        }
    }
}

fn key(x: f64, class: &str, label: &str, dots: bool) -> Markup {
    html! {
        @if dots {
            circle class=(class) cx=(x) cy="20" r=(if class == "clean" { "4" } else { "2.2" }) {}
        } @else {
            path class=(class) d={ "M" (x - 10.0) " 20h20" } {}
        }
        text x=(x + 16.0) y="24" { (label) }
    }
}
