//! What the comparison of a solution with its reference adds to the verdict: bands by the standard deviations that the
//! reference states, and doubts where the solution is too like its reference.
//!
//! The differences of a solution that is independent of its reference contain the errors of the reference, of σ on each axis. However
//! these are spread between a constant and a part that changes, both parts can't be small: σ² is their sum. A scatter
//! below [`SCATTER`] σ leaves three quarters of it or more for the constant, and a mean of so many axes is then
//! below [`MEANS`] σ with a probability of 1 %. Errors of a few independent draws lie between, and are less probable still.
//! After the fit of a delay one axis at least is left, and the limit is that of one.

use super::method::MethodRun;
use octant_base::number::plain;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCMIN, NAUTICAL_MILE_M};
use octant_scenario::Scenario;
use octant_trajectory::comparison::{ErrorName, Quantity};
use octant_trajectory::{Comparison, Differences};

/// Standard deviations in an expanded uncertainty (95 %).
const EXPANDED: f64 = 1.96;
/// Largest scatter of differences that is too small, in σ of the reference.
const SCATTER: f64 = 0.5;
/// Largest mean that is too small, in σ, of one axis and of two: sqrt(0.75 q), with the quantile q of 1 % of χ² with as many
/// degrees of freedom, 1.5709e-4 and 0.020101.
const MEANS: [f64; 2] = [0.010_854, 0.122_78];
/// Fewest points that show it.
const POINTS_LEAST: u64 = 30;

/// Error of a measure of the navigation, and units of its scores in one of the error.
fn error_of(bare: &str, scenario: &Scenario) -> Option<(ErrorName, f64)> {
    let earth = Ellipsoid::at(scenario.site.latitude_rad, scenario.site.height_m);
    let across_m = earth.transverse_radius_m * earth.cos_latitude;
    let has = |part: &str| bare.contains(part);
    Some(if has("heading") {
        (ErrorName::Heading, 1.0 / ARCMIN)
    } else if has("pitch") {
        (ErrorName::Pitch, 1.0 / ARCMIN)
    } else if has("roll") {
        (ErrorName::Roll, 1.0 / ARCMIN)
    } else if has("velocity_north") {
        (ErrorName::North, 1.0)
    } else if has("velocity_east") {
        (ErrorName::East, 1.0)
    } else if has("latitude") {
        (ErrorName::Latitude, 1.0 / (ARCMIN * earth.meridian_radius_m))
    } else if has("longitude") {
        (ErrorName::Longitude, 1.0 / (ARCMIN * across_m))
    } else if has("radial") {
        (ErrorName::Radial, 1.0 / NAUTICAL_MILE_M)
    } else {
        return None;
    })
}

/// Expanded uncertainty (95 %) of a measure, in its unit, by the standard deviations that the reference states.
pub(super) fn band(comparison: &Comparison, measure: &str, scenario: &Scenario) -> Option<f64> {
    let bare = measure.trim_matches('|').strip_prefix("navigation.")?;
    let (error, units) = error_of(bare, scenario)?;
    let score = bare.rsplit('.').next().unwrap_or(bare);
    let score = if score.contains("_max_") { "max" } else { score };
    let hours =
        scenario.navigation.as_ref().and_then(|plan| plan.duration_s).unwrap_or(3600.0) / 3600.0;
    let over_time = match score {
        "slope_per_day" => 48.0 / hours,
        "rate_per_h" => 1.5 / hours,
        _ => 1.0,
    };
    comparison.band(error).of(score).map(|band| band * units * over_time)
}

/// Text of the standard deviations of the position that the reference states.
pub(super) fn stated(comparison: &Comparison) -> Option<String> {
    let sigma_m = comparison.band(ErrorName::Radial).sigma()?;
    Some(format!(
        "the reference's own standard deviations, of {} m rms, where they leave more open",
        plain(sigma_m, 3)
    ))
}

/// Standard deviation of the reference's quantity: that which is stated, else that of the file.
fn sigma(scenario: &Scenario, comparison: &Comparison, quantity: Quantity) -> Option<f64> {
    let (names, error, units): (&[&str], _, _) = match quantity {
        Quantity::Position => {
            let stated_m = scenario.decision.position_m;
            let of_file = || comparison.band(ErrorName::Radial).sigma();
            return stated_m.map(|stated_m| stated_m / EXPANDED).or_else(of_file);
        }
        Quantity::Velocity => (&["velocity_north", "velocity_east"], ErrorName::North, 1.0),
        Quantity::Roll => (&["roll"], ErrorName::Roll, ARCMIN),
        Quantity::Pitch => (&["pitch"], ErrorName::Pitch, ARCMIN),
        Quantity::Heading => (&["heading"], ErrorName::Heading, ARCMIN),
    };
    let of_value = |measure: &str| {
        let score = measure.rsplit('.').next().unwrap_or(measure);
        measure.starts_with("navigation.")
            && names.iter().any(|name| measure.contains(name))
            && matches!(score, "max" | "rms" | "final")
    };
    let stated = scenario.decision.uncertainties.iter().filter(|u| of_value(&u.measure));
    let least = stated.map(|u| u.uncertainty * units / EXPANDED).reduce(f64::min);
    least.filter(|sigma| *sigma > 0.0).or_else(|| comparison.band(error).sigma())
}

/// Reasons why a solution is too like its reference to show anything of the instrument.
pub(super) fn too_like(scenario: &Scenario, run: &MethodRun) -> Vec<String> {
    let Some(comparison) = &run.bench.compared else { return Vec::new() };
    Quantity::ALL
        .into_iter()
        .filter_map(|quantity| too_like_in(scenario, comparison, quantity))
        .collect()
}

fn too_like_in(scenario: &Scenario, comparison: &Comparison, quantity: Quantity) -> Option<String> {
    let sigma = sigma(scenario, comparison, quantity)?;
    let likeness = comparison.likeness(quantity);
    if !likeness.varies() || likeness.points() < POINTS_LEAST {
        return None;
    }
    let axes = likeness.axes().clamp(1, MEANS.len());
    let as_it_is = likeness.differences().filter(|differences| is_small(differences, axes, sigma));
    // A delay may take up what is constant on one axis.
    let late = || likeness.after_delay().filter(|left| is_small(left, 1, sigma));
    let found = as_it_is.or_else(late)?;
    let (unit, scale) = match quantity {
        Quantity::Position => ("m", 1.0),
        Quantity::Velocity => ("m/s", 1.0),
        _ => ("arcmin", 1.0 / ARCMIN),
    };
    let number = |value: f64| plain(value * scale, 3);
    let how = match found.delay_s {
        None => String::new(),
        Some(delay_s) if delay_s >= 0.0 => format!(" {} s before", plain(delay_s, 4)),
        Some(delay_s) => format!(" {} s later", plain(-delay_s, 4)),
    };
    Some(format!(
        "the {} of the solution are those of the reference{how}, but for {} {unit} (1 sigma) about a mean of {} {unit}: far \
         below the reference's own uncertainty of {} {unit} (95 %), which errors of an independent reference are with a \
         probability of 1 % at most; expected a reference that has no part in the solution, or its uncertainty as it is",
        quantity.name(),
        number(found.scatter),
        number(found.mean),
        number(EXPANDED * sigma),
    ))
}

/// Returns whether differences on so many axes, one or two, are too small for a reference of this standard deviation.
fn is_small(differences: &Differences, axes: usize, sigma: f64) -> bool {
    differences.scatter < SCATTER * sigma && differences.mean < MEANS[axes - 1] * sigma
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of a normal distribution (splitmix64, Box and Muller).
    fn normals() -> impl Iterator<Item = f64> {
        let mut state = 7_u64;
        let mut uniform = move || {
            state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
        };
        std::iter::from_fn(move || {
            let (radius, angle) = (libm::sqrt(-2.0 * libm::log(1.0 - uniform())), uniform());
            Some(radius * libm::cos(2.0 * std::f64::consts::PI * angle))
        })
    }

    #[test]
    fn independent_references_are_called_too_like_once_in_a_hundred_at_most() {
        // Runs in which the reference has so many independent errors, each for as long as the others; computed by numpy for
        // 200 000 runs: 0.78, 0.58, 0.38, 0.22 and 0.01 % on two axes, 0.88, 0.69, 0.46, 0.36 and 0.06 % on one.
        let mut normal = normals();
        let runs = 20_000;
        let expected = [
            [0.0088, 0.0078],
            [0.0069, 0.0058],
            [0.0046, 0.0038],
            [0.0036, 0.0022],
            [0.0006, 0.0001],
        ];
        for (draws, expected) in [1, 2, 3, 4, 10].into_iter().zip(expected) {
            for (axes, expected) in [1, 2].into_iter().zip(expected) {
                let mut called = 0_u32;
                for _ in 0..runs {
                    let (mut sum, mut square) = ([0.0; 2], 0.0);
                    for _ in 0..draws {
                        for sum in &mut sum[..axes] {
                            let error = normal.next().unwrap();
                            *sum += error;
                            square += error * error;
                        }
                    }
                    let n = f64::from(draws);
                    let mean = libm::hypot(sum[0] / n, sum[1] / n);
                    let scatter = libm::sqrt((square / n - mean * mean).max(0.0) / axes as f64);
                    let differences = Differences { scatter, mean, delay_s: None };
                    called += u32::from(is_small(&differences, axes, 1.0));
                }
                let share = f64::from(called) / f64::from(runs);
                // Four standard deviations of a count.
                let within = 4.0 * libm::sqrt(expected / f64::from(runs));
                assert!((share - expected).abs() < within, "{draws} {axes}: {share}, {expected}");
                assert!(share < 0.01 + within);
            }
        }
    }
}
