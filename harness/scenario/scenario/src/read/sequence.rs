//! Sequence of a calibration: one of the published ones, or stops of the scenario with their name.

use crate::error::{Place, Problem};
use crate::keys::{At, CalibrationKeys, StopKeys};
use octant_calibration::positions;
use octant_calibration::sequence::{Sequence, Stop};
use octant_earth::units::DEG;

/// Name of stops to which the scenario gives none.
const UNNAMED: &str = "own stops";

/// Largest number of characters of a name: a line of a terminal holds it beside a seed.
const NAME_MAX: usize = 60;

/// Reads the sequence of a calibration and its name.
pub(super) fn of(keys: &CalibrationKeys) -> Result<(String, Sequence), Problem> {
    if keys.positions.given && keys.stops.is_some() {
        return Err(keys.stops.problem("found stops beside positions, expected one of them"));
    }
    let positions = &keys.positions;
    if let Some(own) = &*keys.stops {
        let sequence = Sequence::new(&stops(own), keys.passes)
            .map_err(|error| keys.stops.problem(error.to_string()))?;
        let name = name(&keys.name)?.unwrap_or(UNNAMED);
        return Ok((name.to_owned(), sequence));
    }
    let name = positions.as_deref().unwrap_or_default();
    if keys.name.is_some() {
        return Err(keys.name.problem(format!(
            "found without stops: the built-in sequence has its name, {name:?}; expected stops \
             beside it"
        )));
    }
    let stops =
        positions::named(name).ok_or_else(|| positions.problem(format!("found {name:?}")))?;
    let sequence = Sequence::new(&from_degrees(stops), keys.passes)
        .map_err(|error| positions.problem(error.to_string()))?;
    Ok((name.to_owned(), sequence))
}

/// Checks the name that a scenario gives to its stops. No text of a scenario has control characters.
fn name(key: &At<Option<String>>) -> Result<Option<&str>, Problem> {
    let Some(name) = key.as_deref() else { return Ok(None) };
    let length = name.chars().count();
    let expected = format!("expected a text of 1 to {NAME_MAX} characters");
    if name.trim().is_empty() {
        return Err(key.problem(format!("found an empty text, {expected}")));
    }
    if length > NAME_MAX {
        return Err(key.problem(format!("found {length} characters, {expected}")));
    }
    if positions::named(name).is_some() {
        let message = format!("found {name:?}, the name of a built-in sequence; expected another");
        return Err(key.problem(message));
    }
    Ok(Some(name))
}

/// Refuses two methods whose different stops have one name: tables of a run tell methods apart by it.
pub(super) fn check_names(
    first: &CalibrationKeys,
    second: &CalibrationKeys,
) -> Result<(), Problem> {
    let (Some(name), Some(stops_of_first), Some(stops_of_second)) =
        (&*second.name, &*first.stops, &*second.stops)
    else {
        return Ok(());
    };
    if first.name.as_ref() != Some(name) || stops(stops_of_first) == stops(stops_of_second) {
        return Ok(());
    }
    let at = match &first.name.place {
        Place::File { line, column } => format!(" at line {line}, column {column}"),
        Place::Argument(argument) => format!(" of {argument}"),
        Place::Unread | Place::Default => String::new(),
    };
    Err(second.name.problem(format!(
        "found {name:?}, which {}{at} gives to other stops; expected another name",
        first.name.path
    )))
}

/// Makes stops of degrees.
pub(super) fn from_degrees(stops: &[positions::Degrees]) -> Vec<Stop> {
    let stop = |(azimuth_deg, roll_deg, weight): &positions::Degrees| Stop {
        azimuth_rad: azimuth_deg * DEG,
        roll_rad: roll_deg * DEG,
        weight: *weight,
    };
    stops.iter().map(stop).collect()
}

/// Makes stops of the scenario's keys.
pub(super) fn stops(keys: &[StopKeys]) -> Vec<Stop> {
    let stop = |keys: &StopKeys| Stop {
        azimuth_rad: keys.azimuth,
        roll_rad: keys.roll,
        weight: keys.weight,
    };
    keys.iter().map(stop).collect()
}
