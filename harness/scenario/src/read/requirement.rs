//! Limits on results.

use super::Reader;
use crate::Requirement;
use crate::document::Value;
use crate::error::Problem;
use crate::quantity::{self, Quantity};
use octant_base::names::suggestion;
use octant_requirements::Comparison;
use octant_requirements::decision::{Decision, Rule, Uncertainty};
use octant_requirements::equipment::{Day, Equipment};
use octant_requirements::verdict::LimitCheck;
use octant_requirements::{measures, signed};
use octant_sample::parameters::{Group, NAMES};

/// Units that the names of measures end in, with the unit's own spelling.
const SUFFIXES: [(&str, &str); 9] = [
    ("_arcmin", "arcmin"),
    ("_arcsec", "arcsec"),
    ("_nmi", "nmi"),
    ("_deg", "deg"),
    ("_mps", "m/s"),
    ("_rad", "rad"),
    ("_hours", "h"),
    ("_s", "s"),
    ("_m", "m"),
];

pub(super) fn read(root: &Reader<'_>) -> Result<Vec<Requirement>, Problem> {
    let mut all: Vec<Requirement> = Vec::new();
    for table in root.tables("requirements") {
        let id = table.text("id")?.to_owned();
        if id.trim().is_empty() {
            return Err(table.problem("id", "found an empty text, expected an identifier"));
        }
        if all.iter().any(|other| other.check.id == id) {
            return Err(
                table.problem("id", format!("found {id:?} a second time, expected unique ids"))
            );
        }
        let measure = table.text("measure")?;
        let bare = path_of(measure).map_err(|message| table.problem("measure", message))?;
        let (limit, limit_text) = limit(&table, bare)?;
        all.push(Requirement {
            check: LimitCheck {
                id,
                measure: measure.to_owned(),
                comparison: match table.text("comparison")? {
                    "<" => Comparison::Below,
                    ">=" => Comparison::AtLeast,
                    ">" => Comparison::Above,
                    _ => Comparison::AtMost,
                },
                limit,
            },
            text: table.text("text")?.to_owned(),
            limit_text,
            clause: table.optional_text("clause").map(str::to_owned),
        });
    }
    for (table, requirement) in root.tables("requirements").into_iter().zip(&all) {
        let side = |requirement: &Requirement| requirement.check.comparison;
        let both = all.iter().map(|other| (other.check.measure.as_str(), side(other)));
        let this = (requirement.check.measure.as_str(), side(requirement));
        if let Some(message) = signed::one_sided(this, both) {
            return Err(table.problem("measure", message));
        }
    }
    Ok(all)
}

/// The decision rule.
pub(super) fn decision(table: &Reader<'_>) -> Result<Decision, Problem> {
    let rule = table.optional_text("rule").map(|rule| match rule {
        "simple-acceptance" => Rule::SimpleAcceptance,
        _ => Rule::GuardBand,
    });
    let mut uncertainties: Vec<Uncertainty> = Vec::new();
    for stated in table.tables("uncertainties") {
        let measure = stated.text("measure")?;
        let bare = path_of(measure).map_err(|message| stated.problem("measure", message))?;
        if uncertainties.iter().any(|other| other.measure == bare) {
            let message = format!("found {bare:?} a second time, expected one uncertainty of each");
            return Err(stated.problem("measure", message));
        }
        let (uncertainty, _) = limit_at(&stated, "uncertainty", bare)?;
        if !(uncertainty >= 0.0 && uncertainty.is_finite()) {
            let message = format!("found {uncertainty}, expected a number from 0 on");
            return Err(stated.problem("uncertainty", message));
        }
        uncertainties.push(Uncertainty { measure: bare.to_owned(), uncertainty });
    }
    Ok(Decision { rule, position_m: table.optional_si("position"), uncertainties })
}

/// Equipment of the bench.
pub(super) fn equipment(root: &Reader<'_>) -> Result<Vec<Equipment>, Problem> {
    let mut all: Vec<Equipment> = Vec::new();
    for table in root.tables("equipment") {
        let filled = |key: &str| {
            let text = table.text(key)?;
            if text.trim().is_empty() {
                return Err(table.problem(key, "found an empty text, expected one that names it"));
            }
            Ok(text.to_owned())
        };
        let expires = Day::parse(table.text("expires")?)
            .map_err(|message| table.problem("expires", message))?;
        let one = Equipment {
            name: filled("name")?,
            serial: table.optional_text("serial").map(str::to_owned),
            certificate: filled("certificate")?,
            expires,
        };
        if all.iter().any(|other| other.name == one.name && other.serial == one.serial) {
            let message = format!("found {:?} a second time, expected each piece once", one.name);
            return Err(table.problem("name", message));
        }
        all.push(one);
    }
    Ok(all)
}

fn limit(table: &Reader<'_>, measure: &str) -> Result<(f64, String), Problem> {
    limit_at(table, "limit", measure)
}

fn limit_at(table: &Reader<'_>, key: &str, measure: &str) -> Result<(f64, String), Problem> {
    let Some(Value::Text(text)) = table.node(key).map(|node| &node.value) else {
        let number = table.number(key)?;
        return Ok((number, number.to_string()));
    };
    let number = limit_of(measure, text).map_err(|message| table.problem(key, message))?;
    Ok((number, text.to_owned()))
}

/// The path of a measure without the bars that mean its magnitude.
///
/// # Errors
/// In words, if it isn't a path, or no summary has it.
pub fn path_of(measure: &str) -> Result<&str, String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let bare = measure.strip_prefix('|').and_then(|rest| rest.strip_suffix('|'));
    let bare = bare.unwrap_or(measure);
    if bare.split('.').any(|part| part.is_empty() || !part.chars().all(plain)) {
        return Err(format!(
            "found {measure:?}, expected a dotted path such as navigation.longitude_error_arcmin.max"
        ));
    }
    let Err((place, part, keys)) = measures::check(bare) else { return Ok(bare) };
    let found = match part {
        None => format!("{place} is a table, expected a number in it: {}", keys.join(", ")),
        Some(part) if keys.is_empty() => format!("{place} is a number and has no {part:?}"),
        Some(part) => {
            let known = suggestion(&part, keys.iter().copied(), "it has");
            format!("{place} has no {part:?}, {known}")
        }
    };
    Err(format!("found {measure:?}: {found}"))
}

/// A limit that is written as a quantity, in the unit of its measure.
///
/// # Errors
/// In words, if it isn't a quantity, or none of the measure's kind.
pub fn limit_of(measure: &str, text: &str) -> Result<f64, String> {
    let limit =
        quantity::parse(text).map_err(|_| format!("found {text:?}, expected a quantity"))?;
    let Some((unit, one)) = unit_of(measure) else {
        return Err(format!("found {text:?}, expected a plain number: {measure} has no unit"));
    };
    if !limit.same_dimension(one) {
        return Err(format!(
            "found {text:?}, expected a quantity that is comparable with {unit}, the unit of {measure}"
        ));
    }
    // Written in the measure's own unit, the number is the one written.
    let own = text.trim().strip_suffix(&unit).and_then(|n| n.trim().parse().ok());
    Ok(own.unwrap_or(limit.si / one.si))
}

/// The unit of a measure, from its name: of a parameter, or the ending of a part of the path; with
/// `slope_per_day` and `rate_per_h` the unit is per time.
fn unit_of(measure: &str) -> Option<(String, Quantity)> {
    let mut unit: Option<String> = None;
    for part in measure.split('.') {
        if let Some(index) = NAMES.iter().position(|name| *name == part) {
            unit = Some(Group::of(index).unit().to_owned());
        }
        if let Some((_, found)) = SUFFIXES.iter().find(|(suffix, _)| part.ends_with(suffix)) {
            unit = Some((*found).to_owned());
        }
        for (suffix, per) in [("_per_day", "/day"), ("_per_h", "/h")] {
            if part.ends_with(suffix) {
                unit = unit.map(|unit| unit + per);
            }
        }
    }
    let unit = unit?;
    let one = quantity::parse(&format!("1 {unit}")).ok()?;
    Some((unit, one))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measure_names_its_unit() {
        let unit = |measure| unit_of(measure).map(|(unit, _)| unit);
        assert_eq!(unit("navigation.longitude_error_arcmin.max").as_deref(), Some("arcmin"));
        let slope = unit("navigation.latitude_error_arcmin.slope_per_day");
        assert_eq!(slope.as_deref(), Some("arcmin/day"));
        assert_eq!(unit("navigation.radial_error_nmi.rate_per_h").as_deref(), Some("nmi/h"));
        assert_eq!(unit("calibration.parameters.g_zz.sigma").as_deref(), Some("deg/h/g"));
        assert_eq!(unit("calibration.nis_mean"), None);
    }
}
