//! Innovations of a calibration: NIS with its bounds, whiteness, and each axis.

use super::chart::{Band, Chart, Line, Role};
use super::data::ReportData;
use maud::{Markup, html};
use octant_base::number;
use octant_sample::{Innovation, InnovationOf};
use octant_score::points::NisPoint;

/// 2.5th and 97.5th percentile of χ² with three degrees of freedom.
const CHI_SQUARED_3: [f64; 2] = [0.2158, 9.3484];
/// Largest lag of the autocorrelation.
const LAGS: usize = 50;

/// Renders the innovations; empty for fewer than two. `expected`: between which values the mean of a run is expected, where
/// it isn't 3.
pub(super) fn innovations(data: &ReportData, expected: Option<[f64; 2]>) -> Markup {
    let finite: Vec<NisPoint> = data.nis.iter().copied().filter(|p| p.nis.is_finite()).collect();
    if finite.len() < 2 {
        return html! {};
    }
    let [low, high] = CHI_SQUARED_3;
    let inside = finite.iter().filter(|p| (low..=high).contains(&p.nis)).count();
    html! {
        h3 { "Innovations" }
        p.hint { "Normalized innovation squared (NIS) of three axes. Of a consistent filter the mean is 3, and 95 % of \
            single values lie between 0.22 and 9.35. Here "
            (number::fixed(100.0 * inside as f64 / finite.len() as f64, 1)) " % of "
            (finite.len()) " values do." }
        @if let Some([low, high]) = expected {
            p.hint { "This filter considers states whose errors in a run move all innovations of it: they aren't white, and \
                95 % of runs have a mean NIS between " (number::fixed(low, 2)) " and " (number::fixed(high, 2)) ". Over all \
                runs it is 3." }
        }
        div.plots {
            (means(&finite, expected))
            (single(&finite))
            (whiteness(&finite))
        }
        (axes(&finite))
    }
}

/// Draws means of equal numbers of measurements with the bounds of such a mean.
fn means(finite: &[NisPoint], expected: Option<[f64; 2]>) -> Markup {
    let size = finite.len().div_ceil(240);
    let means: Vec<[f64; 2]> = finite
        .chunks(size)
        .filter(|c| 2 * c.len() > size)
        .map(|c| {
            let n = c.len() as f64;
            [c.iter().map(|p| p.hours).sum::<f64>() / n, c.iter().map(|p| p.nis).sum::<f64>() / n]
        })
        .collect();
    // The mean of n values of χ²₃ has variance 6/n.
    let half = 1.96 * libm::sqrt(6.0 / size as f64);
    let [low, high] = expected.map_or([3.0 - half, 3.0 + half], |[low, high]| {
        [low.min(3.0 - half), high.max(3.0 + half)]
    });
    let ends = [means.first().map_or(0.0, |p| p[0]), means.last().map_or(1.0, |p| p[0])];
    let mut chart = Chart::new("Mean NIS", "hours of the run", "Mean NIS, three axes");
    chart.height = 200.0;
    chart.run_offset_h = Some(0.0);
    let highest = means.iter().map(|p| p[1]).fold(high, f64::max);
    chart.y_range = Some([0.0, (1.1 * highest).max(6.0)]);
    chart.bands.push(Band {
        label: "95 % interval of the mean".to_owned(),
        role: Role::Reference,
        points: ends.iter().map(|&x| [x, low.max(0.0), high]).collect(),
    });
    chart.lines.push(Line {
        label: format!("mean of {size} measurements"),
        role: Role::Primary,
        points: means,
    });
    chart.levels.push((3.0, String::new()));
    chart.render()
}

/// Draws every value that was kept with the bounds of a single one.
fn single(finite: &[NisPoint]) -> Markup {
    let mut chart = Chart::new("NIS", "hours of the run", "NIS of single measurements");
    chart.height = 200.0;
    chart.run_offset_h = Some(0.0);
    chart.logarithmic = true;
    // Values near zero are rare and mean little; the scale is for those that are too large.
    let highest = finite.iter().map(|p| p.nis).fold(30.0, f64::max);
    chart.y_range = Some([0.01, highest]);
    let ends = [finite[0].hours, finite[finite.len() - 1].hours];
    chart.bands.push(Band {
        label: "95 % interval of single values".to_owned(),
        role: Role::Reference,
        points: ends.iter().map(|&x| [x, CHI_SQUARED_3[0], CHI_SQUARED_3[1]]).collect(),
    });
    chart.lines.push(Line {
        label: "NIS".to_owned(),
        role: Role::Primary,
        points: finite.iter().map(|p| [p.hours, p.nis]).collect(),
    });
    chart.levels.push((3.0, String::new()));
    chart.render()
}

/// Draws the autocorrelation of the NIS with the bounds of white noise.
fn whiteness(finite: &[NisPoint]) -> Markup {
    let values: Vec<f64> = finite.iter().map(|p| p.nis).collect();
    let Some(correlation) = autocorrelation(&values, LAGS) else { return html! {} };
    let bound = 1.96 / libm::sqrt(values.len() as f64);
    let outside = correlation.iter().filter(|r| r.abs() > bound).count();
    let mut chart = Chart::new(
        "Autocorrelation of the NIS",
        "lag, measurements kept",
        "Autocorrelation of the NIS",
    );
    chart.height = 200.0;
    chart.hours = false;
    chart.dots = true;
    let lag = |k: usize| (k + 1) as f64;
    chart.bands.push(Band {
        label: "95 % interval of white noise".to_owned(),
        role: Role::Reference,
        points: [0, correlation.len() - 1].iter().map(|&k| [lag(k), -bound, bound]).collect(),
    });
    let count = correlation.len();
    chart.lines.push(Line {
        label: format!(
            "{outside} of {count} lags outside, {} expected",
            number::fixed(0.05 * count as f64, 1)
        ),
        role: Role::Primary,
        points: correlation.iter().enumerate().map(|(k, r)| [lag(k), *r]).collect(),
    });
    chart.levels.push((0.0, String::new()));
    chart.render()
}

/// Draws the innovation of each axis in its own standard deviations, with their statistics.
fn axes(finite: &[NisPoint]) -> Markup {
    let known: Vec<(f64, Innovation)> =
        finite.iter().filter_map(|p| p.innovation.map(|i| (p.hours, i))).collect();
    if known.len() < 2 {
        return html! {};
    }
    let of = match known[0].1.of {
        InnovationOf::Velocity => "velocity",
        InnovationOf::Position => "position",
    };
    let normalized = |axis: usize| -> Vec<[f64; 2]> {
        known.iter().map(|(hours, i)| [*hours, i.value[axis] / i.sigma[axis]]).collect()
    };
    let axes = ["north", "east", "down"].map(|name| (name, format!("Innovation of {of} {name}")));
    html! {
        p.hint { "Innovation of each axis, divided by its expected standard deviation. Of a consistent filter the \
            mean is 0, the standard deviation is 1, and 95 % lie within 1.96." }
        table {
            thead { tr { th { "Axis" } th.n { "Mean" } th.n { "Standard deviation" } th.n { "Within 1.96, %" } } }
            tbody {
                @for (axis, (name, _)) in axes.iter().enumerate() {
                    @let [mean, deviation, within] = statistics(&normalized(axis));
                    tr {
                        td { (of) " " (name) }
                        td.n { (number::fixed(mean, 3)) }
                        td.n { (number::fixed(deviation, 3)) }
                        td.n { (number::fixed(100.0 * within, 1)) }
                    }
                }
            }
        }
        div.plots {
            @for (axis, (_, title)) in axes.iter().enumerate() { (axis_chart(title, normalized(axis))) }
        }
    }
}

/// Draws one axis with the bounds of single values.
fn axis_chart(title: &str, points: Vec<[f64; 2]>) -> Markup {
    let mut chart = Chart::new(title, "hours of the run", title);
    chart.height = 160.0;
    chart.run_offset_h = Some(0.0);
    let highest = points.iter().map(|p| p[1].abs()).fold(4.0, f64::max);
    chart.y_range = Some([-1.05 * highest, 1.05 * highest]);
    let ends = [points[0][0], points[points.len() - 1][0]];
    chart.bands.push(Band {
        label: "95 % interval".to_owned(),
        role: Role::Reference,
        points: ends.iter().map(|&x| [x, -1.96, 1.96]).collect(),
    });
    chart.lines.push(Line { label: "innovation / σ".to_owned(), role: Role::Primary, points });
    chart.levels.push((0.0, String::new()));
    chart.render()
}

/// Mean, standard deviation and share within 1.96 of a series.
#[must_use]
pub fn statistics(points: &[[f64; 2]]) -> [f64; 3] {
    let n = points.len() as f64;
    let mean = points.iter().map(|p| p[1]).sum::<f64>() / n;
    let squares: f64 = points.iter().map(|p| (p[1] - mean) * (p[1] - mean)).sum();
    let within = points.iter().filter(|p| p[1].abs() <= 1.96).count() as f64 / n;
    [mean, libm::sqrt(squares / (n - 1.0)), within]
}

/// Sample autocorrelation at lags from 1 on; `None` for series that are too short or don't vary.
#[must_use]
pub fn autocorrelation(values: &[f64], lags: usize) -> Option<Vec<f64>> {
    let lags = lags.min(values.len() / 4);
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    if lags < 2 || variance <= 0.0 {
        return None;
    }
    let at = |lag: usize| -> f64 {
        let products = values.iter().zip(&values[lag..]).map(|(a, b)| (a - mean) * (b - mean));
        products.sum::<f64>() / variance
    };
    Some((1..=lags).map(at).collect())
}
