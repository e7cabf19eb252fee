//! Conditions of triggers, such as `"nis above 25"`: a signal, a side, and a value.

use super::quantity::{self, UnitDimension, explain};
use octant_base::names::suggestion;
use octant_faults::trigger::{Signal, ThresholdSide};
use octant_sample::Health;

/// Example of a condition, for messages.
pub(crate) const EXAMPLE: &str = "nis above 25";

/// Names of signals, with the dimension of their values; `None`: a plain number.
const SIGNALS: [(&str, Signal, Option<UnitDimension>); 11] = [
    ("nis", Signal::Nis, None),
    ("velocity north", Signal::Velocity(0), Some(UnitDimension::VELOCITY)),
    ("velocity east", Signal::Velocity(1), Some(UnitDimension::VELOCITY)),
    ("velocity down", Signal::Velocity(2), Some(UnitDimension::VELOCITY)),
    ("latitude error", Signal::LatitudeError, Some(UnitDimension::ANGLE)),
    ("longitude error", Signal::LongitudeError, Some(UnitDimension::ANGLE)),
    ("true azimuth", Signal::TrueGimbal(0), Some(UnitDimension::ANGLE)),
    ("true roll", Signal::TrueGimbal(1), Some(UnitDimension::ANGLE)),
    ("true velocity north", Signal::TrueVelocity(0), Some(UnitDimension::VELOCITY)),
    ("true velocity east", Signal::TrueVelocity(1), Some(UnitDimension::VELOCITY)),
    ("true velocity down", Signal::TrueVelocity(2), Some(UnitDimension::VELOCITY)),
];

/// Parses a condition. The error is a fragment that fits after "found X, ".
pub(crate) fn parse(text: &str) -> Result<(Signal, ThresholdSide, f64), String> {
    let text = text.trim();
    if let Some(flag) = text.strip_prefix("health") {
        return Ok((Signal::Health(health(flag.trim())?), ThresholdSide::Above, 0.5));
    }
    let split = [(" above ", ThresholdSide::Above), (" below ", ThresholdSide::Below)]
        .into_iter()
        .find_map(|(word, side)| text.split_once(word).map(|(a, b)| (a, side, b)));
    let Some((name, side, value)) = split else {
        return Err(format!(
            "expected a signal, above or below, and a value, such as {EXAMPLE:?}, or a report of \
             the core such as \"health gap\""
        ));
    };
    let (name, value) = (name.trim(), value.trim());
    let Some((_, signal, dimension)) = SIGNALS.iter().find(|(known, ..)| *known == name) else {
        let names = SIGNALS.iter().map(|(name, ..)| *name);
        return Err(format!(
            "with the unknown signal {name:?}, {}",
            suggestion(name, names, "signals")
        ));
    };
    let value = match dimension {
        None => value.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
            format!("with {value:?} for {name}, expected a plain number such as in {EXAMPLE:?}")
        })?,
        Some(dimension) => {
            let expected = format!("{} such as \"{}\"", dimension.name, dimension.example);
            let quantity = quantity::parse(value)
                .map_err(|e| format!("with {value:?}, {}; expected {expected}", explain(&e)))?;
            if !quantity.is(*dimension) {
                return Err(format!("with {value:?} for {name}, expected {expected}"));
            }
            quantity.si
        }
    };
    Ok((*signal, side, value))
}

/// Health flag of the core, by its name.
fn health(name: &str) -> Result<Health, String> {
    let names: Vec<(String, Health)> = Health::all()
        .iter_names()
        .map(|(name, flag)| (name.to_lowercase().replace('_', "-"), flag))
        .chain([("any".to_owned(), Health::all())])
        .collect();
    let found = names.iter().find(|(known, _)| known == name);
    found.map(|(_, flag)| *flag).ok_or_else(|| {
        let known = names.iter().map(|(name, _)| name.as_str());
        format!("with the unknown report {name:?}, {}", suggestion(name, known, "reports"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_earth::units::ARCMIN;

    #[test]
    fn conditions_have_a_signal_a_side_and_a_value_in_its_unit() {
        assert_eq!(parse(EXAMPLE), Ok((Signal::Nis, ThresholdSide::Above, 25.0)));
        assert_eq!(
            parse("latitude error above 2 arcmin"),
            Ok((Signal::LatitudeError, ThresholdSide::Above, 2.0 * ARCMIN))
        );
        assert_eq!(
            parse("true velocity east below -0.1 m/s"),
            Ok((Signal::TrueVelocity(1), ThresholdSide::Below, -0.1))
        );
        assert_eq!(
            parse("health innovation-rejected"),
            Ok((Signal::Health(Health::INNOVATION_REJECTED), ThresholdSide::Above, 0.5))
        );
        for (text, expected) in [
            ("nis", "above or below"),
            ("lattitude error above 1 deg", "did you mean \"latitude error\"?"),
            ("nis above 25 m/s", "a plain number"),
            ("velocity north above 3", "without unit"),
            ("velocity north above 3 deg", "expected a velocity"),
            ("health gab", "did you mean \"gap\"?"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
