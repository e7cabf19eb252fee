//! Compares every parameter with truth: a table whose last column is the plot.

use maud::{Markup, html};
use octant_base::number;
use octant_sample::further::{FURTHER_NAMES, FurtherGroup};
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_score::summary::{CalibrationScore, ParameterScore};
use std::collections::BTreeMap;

/// Width of the strip in σ on each side.
const STRIP_SIGMA: f64 = 5.0;

/// Returns the title of a group.
pub(super) fn title(group: ParameterGroup) -> &'static str {
    match group {
        ParameterGroup::GyroBias => "Gyro bias",
        ParameterGroup::GyroScale => "Gyro scale factor",
        ParameterGroup::GyroMisalignment => "Gyro misalignment",
        ParameterGroup::GDependent => "g-dependent gyro bias",
        ParameterGroup::AccelBias => "Accelerometer bias",
        ParameterGroup::AccelScale => "Accelerometer scale factor",
        ParameterGroup::AccelMisalignment => "Accelerometer misalignment",
    }
}

/// Renders the table of all parameters of a method, with the errors of the baseline in the strip.
pub(super) fn table(calibration: &CalibrationScore, baseline: Option<&CalibrationScore>) -> Markup {
    html! {
        table.parameters {
            thead { tr {
                th { "Parameter" }
                th.n { "True" } th.n { "Estimate" } th.n { "Error" } th.n { "σ" } th.n { "Error / σ" }
                th.strip { (scale()) }
            } }
            tbody {
                @for group in ParameterGroup::ALL {
                    (group_rows(group, calibration, baseline))
                }
                @for group in FurtherGroup::ALL {
                    (further_rows(group, calibration, baseline))
                }
            }
        }
    }
}

fn group_rows(
    group: ParameterGroup,
    calibration: &CalibrationScore,
    baseline: Option<&CalibrationScore>,
) -> Markup {
    let heading = heading(title(group), group.unit(), calibration.nees.get(group.name()));
    let names = &NAMES[group.range()];
    rows(&heading, names, &calibration.parameters, baseline.map(|other| &other.parameters))
}

/// Renders the heading of a group: its title and unit, and the mean of its squared normalized errors.
fn heading(title: &str, unit: &str, nees: Option<&f64>) -> Markup {
    html! {
        (title) " " span.soft { (unit) }
        @if let Some(nees) = nees {
            span.soft { " · mean (error/σ)² " (number::fixed(*nees, 2)) }
        }
    }
}

/// Returns the title of a group of further states.
fn further_title(group: FurtherGroup) -> &'static str {
    match group {
        FurtherGroup::AccelLever => "Accelerometer lever arm",
        FurtherGroup::GyroAsymmetry => "Gyro scale factor asymmetry",
        FurtherGroup::AccelAsymmetry => "Accelerometer scale factor asymmetry",
        FurtherGroup::AccelQuadratic => "Accelerometer second order",
        FurtherGroup::GyroGaussMarkov => "Gyro Gauss-Markov bias",
        FurtherGroup::AccelGaussMarkov => "Accelerometer Gauss-Markov bias",
        FurtherGroup::Deflection => "Deflection of the vertical",
        FurtherGroup::GravityAnomaly => "Gravity anomaly",
        FurtherGroup::GyroBiasTemperature => "Gyro bias, temperature",
        FurtherGroup::GyroScaleTemperature => "Gyro scale factor, temperature",
        FurtherGroup::AccelBiasTemperature => "Accelerometer bias, temperature",
        FurtherGroup::AccelScaleTemperature => "Accelerometer scale factor, temperature",
        FurtherGroup::GimbalMounting => "Mounting on the inner gimbal",
        FurtherGroup::GimbalNonOrthogonality => "Gimbal non-orthogonality",
        FurtherGroup::EncoderEccentricity => "Encoder eccentricity",
    }
}

fn further_rows(
    group: FurtherGroup,
    calibration: &CalibrationScore,
    baseline: Option<&CalibrationScore>,
) -> Markup {
    let names = &FURTHER_NAMES[group.range()];
    if names.iter().all(|name| !calibration.further.contains_key(*name)) {
        return html! {};
    }
    let nees = calibration.nees.get(group.name());
    let heading = heading(further_title(group), group.unit(), nees);
    rows(&heading, names, &calibration.further, baseline.map(|other| &other.further))
}

/// Renders the rows of a group.
fn rows(
    heading: &Markup,
    names: &[&str],
    scores: &BTreeMap<String, ParameterScore>,
    baseline: Option<&BTreeMap<String, ParameterScore>>,
) -> Markup {
    let found: Vec<_> = names.iter().filter_map(|n| scores.get(*n)).collect();
    // Two digits of the smallest σ, the same for the whole group, so that the columns line up.
    let smallest = found.iter().filter_map(|s| s.sigma).reduce(f64::min);
    let largest = found.iter().map(|s| s.estimate.abs()).fold(0.0, f64::max);
    let decimals =
        number::decimals_for(smallest.unwrap_or(largest), if smallest.is_some() { 2 } else { 4 });
    html! {
        tr.group { td colspan="7" { (heading) } }
        @for name in names {
            @if let Some(score) = scores.get(*name) {
                (row(name, score, baseline.and_then(|all| all.get(*name)), decimals))
            }
        }
    }
}

fn row(
    name: &str,
    score: &ParameterScore,
    baseline: Option<&ParameterScore>,
    decimals: usize,
) -> Markup {
    let beyond = score.normalized.is_some_and(|n| n.abs() > 3.0);
    html! {
        tr {
            td.mono { (name) }
            td.n { (number::optional(score.r#true, decimals)) }
            td.n { (number::fixed(score.estimate, decimals)) }
            td.n { (number::optional(score.error, decimals)) }
            td.n { @if score.sigma.is_some() { (number::optional(score.sigma, decimals)) } @else { "not estimated" } }
            td class=(if beyond { "n over" } else { "n" }) { (number::optional(score.normalized, 2)) }
            td.strip { (strip(score.normalized, baseline.and_then(|b| b.normalized))) }
        }
    }
}

/// Returns the place of a value in σ on a strip of 200 px, clamped to its ends.
fn place(normalized: f64) -> f64 {
    libm::round((100.0 + 100.0 * normalized.clamp(-STRIP_SIGMA, STRIP_SIGMA) / STRIP_SIGMA) * 10.0)
        / 10.0
}

fn strip(primary: Option<f64>, baseline: Option<f64>) -> Markup {
    let (one, three) = (place(1.0) - place(-1.0), place(3.0) - place(-3.0));
    html! {
        svg viewBox="0 0 200 16" aria-hidden="true" {
            rect.sigma3 x=(place(-3.0)) y="2" width=(three) height="12" {}
            rect.sigma1 x=(place(-1.0)) y="2" width=(one) height="12" {}
            path.centre d="M100 0V16" {}
            @if let Some(n) = baseline { (dot(n, "baseline", 3.2)) }
            @if let Some(n) = primary { (dot(n, "primary", 3.8)) }
        }
    }
}

/// Draws a dot, or a pointer at the end of the strip if the value lies beyond.
fn dot(normalized: f64, role: &str, radius: f64) -> Markup {
    let x = place(normalized);
    html! {
        @if normalized > STRIP_SIGMA {
            path class={ "dot " (role) } d="M193 3L200 8L193 13Z" {}
        } @else if STRIP_SIGMA > -normalized {
            circle class={ "dot " (role) } cx=(x) cy="8" r=(radius) {}
        } @else {
            path class={ "dot " (role) } d="M7 3L0 8L7 13Z" {}
        }
    }
}

fn scale() -> Markup {
    html! {
        svg viewBox="0 0 200 16" aria-hidden="true" {
            @for n in [-3, -1, 0, 1, 3] {
                text class="tick x" x=(place(f64::from(n))) y="13" {
                    @if n == 0 { "0" } @else { (number::fixed(f64::from(n), 0)) "σ" }
                }
            }
        }
    }
}
