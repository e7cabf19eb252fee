//! What the comparison of a solution with its reference adds to the verdict: bands by the standard deviations that the
//! reference states, and doubts where the solution is too like its reference.

use super::method::MethodRun;
use octant_base::number::plain;
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::{ARCMIN, NAUTICAL_MILE_M};
use octant_scenario::{Scenario, SourceSpec};
use octant_score::heading_output::{HeadingOutputScore, HeadingPair};
use octant_score::summary::HeadingScore;
use octant_trajectory::Comparison;
use octant_trajectory::comparison::{ComparedHeading, ErrorName, Quantity};
use octant_verdict::decision::{TimeDoubt, UnknownUncertainty};

/// Standard deviations in an expanded uncertainty (95 %).
const EXPANDED: f64 = 1.96;
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

/// Path of a measure below the score of a heading's output; `None`: it is another one.
pub(super) fn output_path(measure: &str) -> Option<&str> {
    measure.trim_matches('|').strip_prefix("navigation.heading_output.")
}

/// Scores the output of the heading; `None` without headings, or with a reference that has none.
pub(super) fn heading_output(comparison: &Comparison) -> Option<HeadingOutputScore> {
    let pair = |heading: &ComparedHeading| HeadingPair {
        t_s: heading.time_ns as f64 * 1e-9,
        output_rad: heading.solution_rad,
        reference_rad: heading.reference_rad,
    };
    let pairs: Vec<HeadingPair> = comparison.headings().iter().map(pair).collect();
    let [digit_rad, doubt_s] = comparison.coarsest_heading();
    HeadingOutputScore::of(&pairs, digit_rad, doubt_s)
}

/// Expanded uncertainty (95 %) of a measure, in its unit, by the standard deviations that the reference states.
pub(super) fn band(comparison: &Comparison, measure: &str, scenario: &Scenario) -> Option<f64> {
    if let Some(path) = output_path(measure) {
        let heading = comparison.band(ErrorName::Heading);
        let largest = heading.of("largest")?;
        // A latency has the uncertainty of its fit, a resolution none.
        return path.ends_with("_deg").then(|| match path {
            "resolution_deg" => 0.0,
            _ => largest.to_degrees(),
        });
    }
    let bare = measure.trim_matches('|').strip_prefix("navigation.")?;
    let (error, units) = error_of(bare, scenario)?;
    let score = bare.rsplit('.').next().unwrap_or(bare);
    let score = if score.contains("_max_") { "max" } else { score };
    let over_time = over_time(score, scenario);
    comparison.band(error).of(score).map(|band| band * units * over_time)
}

/// Expanded uncertainty (95 %) of a measure of a heading test of a solution, in its unit, without that of its last digit;
/// `None`: it is another measure.
///
/// An error against a true heading has the uncertainty of that heading, which has to be stated. A difference of two readings
/// hasn't: the base is the same. In motion the true heading moves while the time of a reading is in doubt.
pub(super) fn of_heading_test(
    comparison: &Comparison,
    heading: &HeadingScore,
    measure: &str,
    scenario: &Scenario,
) -> Option<Result<f64, UnknownUncertainty>> {
    let bare = measure.trim_matches('|');
    bare.strip_prefix("heading.")?;
    let stated = scenario.decision.uncertainties.iter().find(|stated| stated.measure == bare);
    let stated = stated.map(|stated| stated.uncertainty);
    let of_reference = comparison.band(ErrorName::Heading).of("largest").map(f64::to_degrees);
    let is_in_motion = bare.contains("in_motion.") || bare.contains("dynamic_");
    let late_deg = if is_in_motion { comparison.late_rad().to_degrees() } else { 0.0 };
    let known = match bare.rsplit('.').next() {
        Some("settle_point_error_deg") => match (stated, of_reference) {
            (None, None) if heading.knows_truth() => return Some(Err(UnknownUncertainty)),
            (stated, of_reference) => stated.unwrap_or(0.0).max(of_reference.unwrap_or(0.0)),
        },
        // A reference that moves has its error at each of the two times.
        Some("scorsby_error_deg" | "dynamic_amplitude_deg" | "repeatability_deg") => {
            let of_file = of_reference.filter(|_| is_file(scenario)).unwrap_or(0.0);
            stated.unwrap_or(0.0).max(of_file)
        }
        _ => stated.unwrap_or(0.0),
    };
    Some(Ok(libm::hypot(known, late_deg)))
}

/// True if the reference of a solution is a file.
fn is_file(scenario: &Scenario) -> bool {
    matches!(&scenario.source, SourceSpec::Solution(spec) if spec.reference.file().is_some())
}

/// Factor of the uncertainty of a score that is a change with time.
fn over_time(score: &str, scenario: &Scenario) -> f64 {
    let hours =
        scenario.navigation.as_ref().and_then(|plan| plan.duration_s).unwrap_or(3600.0) / 3600.0;
    match score {
        "slope_per_day" => 48.0 / hours,
        "rate_per_h" => 1.5 / hours,
        _ => 1.0,
    }
}

/// Expanded uncertainty (95 %) of a measure, in its unit, by the last digits of solution and reference; 0 where they have all.
pub(super) fn digits(comparison: &Comparison, measure: &str, scenario: &Scenario) -> f64 {
    let bare = measure.trim_matches('|').strip_prefix("navigation.");
    let found = bare.and_then(|bare| {
        let (error, units) = error_of(bare, scenario)?;
        let score = bare.rsplit('.').next().unwrap_or(bare);
        Some(comparison.digits(error)?.of(score)? * units * over_time(score, scenario))
    });
    found.unwrap_or(0.0)
}

/// Text of the standard deviations of the position that the reference states.
pub(super) fn stated(comparison: &Comparison) -> Option<String> {
    let sigma_m = comparison.band(ErrorName::Radial).sigma()?;
    Some(format!(
        "the reference's own standard deviations, of {} m rms, where they leave more open",
        plain(sigma_m, 3)
    ))
}

/// Uncertainty of the times of a solution against its reference.
pub(super) fn timing(scenario: &Scenario, run: &MethodRun) -> Option<TimeDoubt> {
    let SourceSpec::Solution(spec) = &scenario.source else { return None };
    let [speed_mps, acceleration_mps2, turning_radps] = run.observed.drift.moved.rates();
    let uncertainty_s = spec.offset_uncertainty_s;
    let doubt = TimeDoubt { uncertainty_s, speed_mps, acceleration_mps2, turning_radps };
    (uncertainty_s > 0.0).then_some(doubt)
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
    let axes = likeness.axes();
    let as_it_is =
        likeness.differences().filter(|differences| differences.is_too_small(axes, sigma));
    // A delay may take up what is constant on one axis.
    let late = || likeness.after_delay().filter(|left| left.is_too_small(1, sigma));
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
