//! Units: SI values of a scenario's quantities.

use super::numbers::Found;
use octant_observe::ensemble::state_unit;
use octant_sample::parameters::ParameterGroup;
use octant_scenario::quantity;
use octant_score::alignment::{SolutionPoint, SolutionScore};
use octant_score::attitude::CaseAngles;

/// End of the names of angles.
const REPORTED: &str = " rad as a report has it, deg";

pub(super) fn found() -> Result<Found, String> {
    let mut all = Found::new();
    for known in super::numbers::known("units") {
        let name = known.name;
        let state = name.strip_prefix("unit of state ").and_then(|state| state.parse().ok());
        let value = match name.strip_prefix("unit of ") {
            Some(_) if let Some(state) = state => state_unit(std::hint::black_box(state)).1,
            Some(group) => of_group(group).ok_or_else(|| format!("find the group {group}"))?,
            None if let Some(unit) = name.strip_suffix(" in an FMU") => {
                of_fmu(unit).ok_or_else(|| format!("find the unit of {name}"))?
            }
            None if let Some(unit) = name.strip_suffix(" in a field") => {
                octant_instruments::unit_si(std::hint::black_box(unit))
                    .ok_or_else(|| format!("find the unit of {name}"))?
            }
            None if name.ends_with(REPORTED) => {
                reported(&name).ok_or_else(|| format!("find the angle of {name}"))?
            }
            None => quantity::parse(&name).map_err(|why| format!("parse {name}: {why:?}"))?.si,
        };
        all.insert(name, value);
    }
    Ok(all)
}

/// Computes an angle of a solution as a report has it: `heading of 2.5 rad as …`.
fn reported(name: &str) -> Option<f64> {
    let (angle, at) = name.strip_suffix(REPORTED)?.split_once(" of ")?;
    let at: f64 = std::hint::black_box(at.parse().ok()?);
    let mut attitude = CaseAngles::default();
    match angle {
        "heading" => attitude.heading_rad = at,
        "pitch" => attitude.pitch_rad = at,
        "roll" => attitude.roll_rad = at,
        _ => return None,
    }
    let point = SolutionPoint { attitude: Some(attitude), ..SolutionPoint::default() };
    let score = SolutionScore::of(&point, None);
    match angle {
        "heading" => score.heading_deg,
        "pitch" => score.pitch_deg,
        _ => score.roll_deg,
    }
}

/// Factor of a unit in the description of an FMU, or its zero: `zero of degC`. Of two meanings it is the one without a mass:
/// `g` is a gram too.
fn of_fmu(name: &str) -> Option<f64> {
    let zero = name.strip_prefix("zero of ");
    let known =
        octant_fmu_host::description::units::known(std::hint::black_box(zero.unwrap_or(name)));
    let massless = known.iter().find(|unit| unit.exponents[0] == 0).or(known.first())?;
    Some(if zero.is_some() { massless.offset } else { massless.factor })
}

fn of_group(name: &str) -> Option<f64> {
    let plain = |group: &ParameterGroup| group.name().replace('_', " ") == name.replace('-', " ");
    ParameterGroup::ALL
        .into_iter()
        .find(plain)
        .map(|group| std::hint::black_box(group).si_per_unit())
}
