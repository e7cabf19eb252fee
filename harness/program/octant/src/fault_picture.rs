//! Draws the effect of a fault: the quantity that it changes most, with and without the fault, and
//! the difference. One self-contained SVG that adapts to light and dark.

use maud::{Markup, PreEscaped, html};
use octant_base::number;
use octant_faults::catalogue::{Acts, Family, FaultKind};
use octant_report::chart::{multiples_of, nice_ticks, round, span, thinned};
use octant_run::side_by_side::{SideBySide, Step};
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS, GIMBAL_LSB_RAD};
use octant_sample::{Aiding, Epoch, Reference};

const DEG: f64 = std::f64::consts::PI / 180.0;
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

/// One quantity of a step; NaN where the step doesn't have it.
struct Quantity {
    name: &'static str,
    /// Value of a step of the source by its number from 1, SI.
    of: fn(&Step, &View) -> f64,
    /// Unit, in SI, from the largest first.
    units: &'static [(&'static str, f64)],
    /// Resolution, SI: a smaller difference counts as zero.
    resolution: f64,
}

/// References of the quantities.
struct View {
    period_s: f64,
    /// Number of the step.
    number: u64,
    /// Position of the reference at the start: positions are shown as offsets from it.
    origin: Option<[f64; 3]>,
}

const RATES: &[(&str, f64)] = &[("°/s", DEG), ("°/h", DEG / 3600.0)];
const ACCELERATIONS: &[(&str, f64)] = &[("m/s²", 1.0), ("mg", 9.80665e-3), ("µg", 9.80665e-6)];
const ANGLES: &[(&str, f64)] = &[("°", DEG), ("″", DEG / 3600.0)];
const TIMES: &[(&str, f64)] = &[("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)];
const VELOCITIES: &[(&str, f64)] = &[("m/s", 1.0), ("mm/s", 1e-3), ("µm/s", 1e-6)];
const LENGTHS: &[(&str, f64)] = &[("m", 1.0), ("mm", 1e-3)];
const COUNT: &[(&str, f64)] = &[("", 1.0)];

fn last(step: &Step) -> Option<&Epoch> {
    step.delivered.last()
}

fn rate(step: &Step, view: &View, axis: usize) -> f64 {
    last(step).map_or(f64::NAN, |e| {
        f64::from(e.sample.delta_theta[axis]) * DELTA_THETA_LSB_RAD / view.period_s
    })
}

fn force(step: &Step, view: &View, axis: usize) -> f64 {
    last(step).map_or(f64::NAN, |e| {
        f64::from(e.sample.delta_velocity[axis]) * DELTA_VELOCITY_LSB_MPS / view.period_s
    })
}

fn aiding(step: &Step) -> Option<&Aiding> {
    step.delivered.iter().rev().find_map(|e| e.aiding.as_ref())
}

fn velocity(step: &Step, axis: usize) -> f64 {
    match aiding(step).map(|a| a.reference) {
        Some(Reference::Velocity(v)) => v[axis],
        _ => f64::NAN,
    }
}

fn position(step: &Step, view: &View, axis: usize) -> f64 {
    // A spherical Earth is enough for a picture.
    const RADIUS_M: f64 = 6_371_000.0;
    match (aiding(step).map(|a| a.reference), view.origin) {
        (Some(Reference::Position { latitude_rad, longitude_rad, height_m }), Some(o)) => {
            match axis {
                0 => (latitude_rad - o[0]) * RADIUS_M,
                1 => (longitude_rad - o[1]) * RADIUS_M * libm::cos(o[0]),
                _ => o[2] - height_m,
            }
        }
        _ => f64::NAN,
    }
}

fn stamp_error(ns: u64, view: &View) -> f64 {
    // In whole nanoseconds: a correct stamp gives zero to the last bit.
    let right_ns = view.number as f64 * (view.period_s * 1e9).round();
    (ns as f64 - right_ns) * 1e-9
}

macro_rules! quantity {
    ($name:literal, $of:expr, $units:expr, $resolution:expr) => {
        Quantity { name: $name, of: $of, units: $units, resolution: $resolution }
    };
}

const RATE: f64 = DELTA_THETA_LSB_RAD / 0.005;
const FORCE: f64 = DELTA_VELOCITY_LSB_MPS / 0.005;

static CHANNELS: [Quantity; 6] = [
    quantity!("gyro x", |s, v| rate(s, v, 0), RATES, RATE),
    quantity!("gyro y", |s, v| rate(s, v, 1), RATES, RATE),
    quantity!("gyro z", |s, v| rate(s, v, 2), RATES, RATE),
    quantity!("accelerometer x", |s, v| force(s, v, 0), ACCELERATIONS, FORCE),
    quantity!("accelerometer y", |s, v| force(s, v, 1), ACCELERATIONS, FORCE),
    quantity!("accelerometer z", |s, v| force(s, v, 2), ACCELERATIONS, FORCE),
];
static ENCODERS: [Quantity; 2] = [
    quantity!(
        "encoder, azimuth",
        |s, _| last(s).map_or(f64::NAN, |e| e.sample.gimbal.azimuth_rad()),
        ANGLES,
        GIMBAL_LSB_RAD
    ),
    quantity!(
        "encoder, roll",
        |s, _| last(s).map_or(f64::NAN, |e| e.sample.gimbal.roll_rad()),
        ANGLES,
        GIMBAL_LSB_RAD
    ),
];
static COMMANDS: [Quantity; 2] = [
    quantity!("set point, azimuth", |s, _| s.command.target.azimuth_rad(), ANGLES, GIMBAL_LSB_RAD),
    quantity!("set point, roll", |s, _| s.command.target.roll_rad(), ANGLES, GIMBAL_LSB_RAD),
];
static STAMPS: [Quantity; 2] = [
    quantity!(
        "stamp of the sample, less its time",
        |s, v| last(s).map_or(f64::NAN, |e| stamp_error(e.sample.device_time.ns, v)),
        TIMES,
        1e-9
    ),
    quantity!(
        "number of the sample, less that of its step",
        |s, v| last(s).map_or(f64::NAN, |e| e.sample.sequence as f64 - v.number as f64),
        COUNT,
        1.0
    ),
];
static STATUS: [Quantity; 1] = [quantity!(
    "status of the sample",
    |s, _| last(s).map_or(f64::NAN, |e| f64::from(e.sample.status.bits())),
    COUNT,
    1.0
)];
static REFERENCE: [Quantity; 7] = [
    quantity!("reference velocity, north", |s, _| velocity(s, 0), VELOCITIES, 1e-12),
    quantity!("reference velocity, east", |s, _| velocity(s, 1), VELOCITIES, 1e-12),
    quantity!("reference velocity, down", |s, _| velocity(s, 2), VELOCITIES, 1e-12),
    quantity!("reference position, north", |s, v| position(s, v, 0), LENGTHS, 1e-6),
    quantity!("reference position, east", |s, v| position(s, v, 1), LENGTHS, 1e-6),
    quantity!("reference position, down", |s, v| position(s, v, 2), LENGTHS, 1e-6),
    quantity!(
        "stamp of the reference, less its time",
        |s, v| aiding(s).map_or(f64::NAN, |a| stamp_error(a.device_time.ns, v)),
        TIMES,
        1e-9
    ),
];
static ANSWERS: [Quantity; 4] = [
    quantity!(
        "position of the procedure, as the core says",
        |s, _| s.output.map_or(f64::NAN, |o| f64::from(o.stop) + 1.0),
        COUNT,
        1.0
    ),
    quantity!(
        "velocity north, as the core says",
        |s, _| s.output.map_or(f64::NAN, |o| o.navigation.velocity_mps[0]),
        VELOCITIES,
        1e-9
    ),
    quantity!(
        "velocity east, as the core says",
        |s, _| s.output.map_or(f64::NAN, |o| o.navigation.velocity_mps[1]),
        VELOCITIES,
        1e-9
    ),
    quantity!(
        "velocity down, as the core says",
        |s, _| s.output.map_or(f64::NAN, |o| o.navigation.velocity_mps[2]),
        VELOCITIES,
        1e-9
    ),
];

/// Part of the run that is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
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
    fn of(quantity: &'static Quantity, runs: &SideBySide, view: &Frame) -> Self {
        let one = |steps: &[Step]| {
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
    window: Window,
    period_s: f64,
    origin: Option<[f64; 3]>,
}

/// Draws the effect of a kind of fault; `None` if nothing differs.
#[must_use]
pub(crate) fn picture(
    kind: &FaultKind,
    runs: &SideBySide,
    window: Window,
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
fn delivery(kind: &FaultKind, runs: &SideBySide, frame: &Frame) -> Markup {
    let (mut numbers, mut counts) = ([Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
    for (side, steps) in [&runs.clean, &runs.faulted].into_iter().enumerate() {
        for number in frame.window.from..=frame.window.to {
            let t = (number as f64 - frame.window.onset as f64) * frame.period_s;
            let Some(step) = steps.get(number as usize - 1) else { continue };
            for epoch in &step.delivered {
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
