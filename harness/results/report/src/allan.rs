//! Allan deviation of the sensors at rest, with the noise terms that describe it.

use super::chart::{Band, Chart, Line, Role};
use maud::{Markup, html};
use octant_base::number;
use octant_score::summary::{AxisAllan, NoiseTermScore, SensorAllan, Summary};

/// Terms in the order of their slopes, with their titles.
const TERMS: [(&str, &str); 5] = [
    ("quantization", "Quantization Q"),
    ("random_walk", "Random walk N"),
    ("bias_instability", "Bias instability B"),
    ("rate_random_walk", "Rate random walk K"),
    ("rate_ramp", "Rate ramp R"),
];
/// Deviance per degree of freedom above which the terms don't describe a curve.
const MISFIT_MAX: f64 = 3.0;
/// Points of a fitted curve in an octave.
const STEPS: u32 = 4;

/// Renders the section; empty for a run without a stretch at rest.
pub(super) fn allan(summary: &Summary) -> Markup {
    let Some(allan) = &summary.allan_deviation else { return html! {} };
    let sensors = [("Gyro", &allan.gyro, true), ("Accelerometer", &allan.accelerometer, false)];
    let all = || sensors.iter().flat_map(|(_, sensor, _)| sensor.axes());
    let fitted = all().any(|(_, axis)| axis.misfit.is_some());
    let truth = all().any(|(_, axis)| axis.terms.values().any(|term| term.r#true.is_some()));
    html! {
        p.hint {
            "Allan deviation of the samples as the source delivered them, before faults: "
            (number::counted(allan.stretches, "stretch", "stretches")) " with the gimbals at rest, "
            (time(allan.at_rest_s)) " together, the longest " (time(allan.longest_s))
            ". Differences are taken within a stretch, so that Earth's rate, gravity and biases cancel."
            @if !allan.base_moves { " Band: interval of 95 %." }
            @if fitted { " Dotted: sum of the fitted terms." }
            @if fitted && truth { " Grey: the same terms of the scenario's instrument." }
        }
        @if allan.base_moves {
            p { "The base may move. The deviation then shows its motion together with the noise of the sensors: it isn't \
                that of the instrument, and no terms are fitted." }
        }
        @for (name, sensor, is_gyro) in sensors {
            div.multiples {
                @for (axis_name, axis) in sensor.axes() {
                    @let title = format!("{name} {axis_name}, {}", sensor.unit);
                    (chart(&title, axis, (is_gyro, allan.base_moves)))
                }
            }
        }
        @if fitted {
            h3 { "Noise terms" }
            p.hint { "Coefficients of IEEE Std 952 with their intervals of 95 %. A term whose interval reaches zero isn't \
                resolved: its upper bound of 95 % is given."
                (misfits(&sensors))
            }
            @for (name, sensor, _) in sensors { (table(name, sensor, truth)) }
        }
    }
}

/// Formats a length of time with three digits.
fn time(time_s: f64) -> String {
    let (value, unit) = if time_s < 3600.0 { (time_s, "s") } else { (time_s / 3600.0, "h") };
    format!("{} {unit}", number::plain(value, 3))
}

/// Names the axes whose curve isn't that of the terms.
fn misfits(sensors: &[(&str, &SensorAllan, bool)]) -> Markup {
    let poor: Vec<String> = sensors
        .iter()
        .flat_map(|(name, sensor, _)| sensor.axes().map(|(axis, of)| (name, axis, of.misfit)))
        .filter_map(|(name, axis, misfit)| {
            let misfit = misfit.filter(|misfit| *misfit > MISFIT_MAX)?;
            let name = name.to_lowercase();
            Some(format!("{name} {axis} (misfit {})", number::significant(misfit, 2)))
        })
        .collect();
    html! {
        @if !poor.is_empty() {
            " The terms don't describe the curve of " (poor.join(", ")) ": about 1 is expected. Other errors are in it, \
            such as vibration, temperature or a correlated bias."
        }
    }
}

/// Draws an axis. The interval is that of noise; a motion has none.
fn chart(title: &str, axis: &AxisAllan, (is_gyro, moves): (bool, bool)) -> Markup {
    let mut chart = Chart::new(title, "averaging time, s", title);
    (chart.width, chart.height) = (360.0, 230.0);
    (chart.hours, chart.decades, chart.logarithmic) = (false, true, true);
    (chart.legend, chart.dots) = (false, true);
    let place = libm::log10;
    let rows = || axis.series.iter().filter(|row| row[1] > 0.0);
    if !moves {
        chart.bands.push(Band {
            label: "interval of 95 %".to_owned(),
            role: Role::Primary,
            points: rows().map(|[tau_s, _, low, high, _]| [place(*tau_s), *low, *high]).collect(),
        });
    }
    let curve = |coefficient: fn(&NoiseTermScore) -> Option<f64>| -> Vec<[f64; 2]> {
        let (Some(first), Some(last)) = (rows().next(), rows().next_back()) else {
            return Vec::new();
        };
        let steps = (libm::log2(last[0] / first[0]) * f64::from(STEPS)) as u32;
        let at = |step: u32| {
            let tau_s = first[0] * libm::exp2(f64::from(step) / f64::from(STEPS));
            Some([place(tau_s), axis.of_terms(tau_s, coefficient, is_gyro)?])
        };
        (0..=steps).filter_map(at).collect()
    };
    for (label, role, points) in [
        ("scenario's instrument", Role::Reference, curve(|term| term.r#true)),
        ("sum of the terms", Role::Second, curve(|term| term.estimate)),
        ("Allan deviation", Role::Primary, rows().map(|row| [place(row[0]), row[1]]).collect()),
    ] {
        if !points.is_empty() {
            chart.lines.push(Line { label: label.to_owned(), role, points });
        }
    }
    chart.render()
}

/// Renders the terms of a triad.
fn table(name: &str, sensor: &SensorAllan, truth: bool) -> Markup {
    let axes = sensor.axes();
    let digits = |value: f64| number::significant(value, 3);
    let rows = TERMS.iter().filter_map(|(term, title)| {
        let scores = axes.map(|(_, axis)| axis.terms.get(*term));
        let some = scores.iter().flatten().next()?;
        Some((title, some.unit.clone(), some.r#true, scores))
    });
    html! {
        table {
            thead { tr {
                th { (name) }
                @if truth { th.n { "Scenario" } }
                @for (axis, _) in axes { th.n { (axis) } }
            } }
            tbody { @for (title, unit, scenario, scores) in rows { tr {
                td { (title) " " span.soft { (unit) } }
                @if truth { td.n { (scenario.map_or_else(|| "–".to_owned(), digits)) } }
                @for score in scores { td.n { @if let Some(score) = score { (cell(score)) } @else { "–" } } }
            } } }
        }
    }
}

fn cell(score: &NoiseTermScore) -> Markup {
    let digits = |value: f64| number::significant(value, 3);
    html! {
        @if let Some(estimate) = score.estimate {
            (digits(estimate)) br; span.soft { (digits(score.low)) " – " (digits(score.high)) }
        } @else {
            span.soft { "below " (digits(score.high)) }
        }
    }
}
