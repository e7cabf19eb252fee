//! Limits on results.

use crate::error::Problem;
use crate::keys::{At, DecisionKeys, EquipmentKeys, RequirementKeys};
use crate::model::RequirementSpec;
use crate::quantity::{self, Quantity};
use octant_base::names::suggestion;
use octant_verdict::decision::{Decision, Uncertainty};
use octant_verdict::equipment::{Day, Equipment};
use octant_verdict::measures::PathError;
use octant_verdict::verdict::LimitCheck;
use octant_verdict::{measures, signed};

pub(super) fn read(keys: &[RequirementKeys]) -> Result<Vec<RequirementSpec>, Problem> {
    let mut all: Vec<RequirementSpec> = Vec::new();
    for RequirementKeys { id, text, measure, limit, secant_latitude, comparison, clause, .. } in
        keys
    {
        if id.trim().is_empty() {
            return Err(id.problem("found an empty text, expected an identifier"));
        }
        if all.iter().any(|other| other.check.id == **id) {
            let message = format!("found {:?} a second time, expected unique ids", **id);
            return Err(id.problem(message));
        }
        let bare = path_of(measure).map_err(|error| measure.problem(error.to_string()))?;
        let (limit, limit_text) = self::limit(limit, bare)?;
        if **secant_latitude && let Some(message) = measures::without_secant(bare) {
            return Err(secant_latitude.problem(message));
        }
        all.push(RequirementSpec {
            check: LimitCheck {
                id: id.to_string(),
                measure: measure.to_string(),
                comparison: *comparison,
                limit,
                secant_latitude: **secant_latitude,
            },
            text: text.clone(),
            limit_text,
            clause: clause.clone(),
        });
    }
    for (keys, requirement) in keys.iter().zip(&all) {
        let side = |requirement: &RequirementSpec| requirement.check.comparison;
        let both = all.iter().map(|other| (other.check.measure.as_str(), side(other)));
        let this = (requirement.check.measure.as_str(), side(requirement));
        if let Some(message) = signed::one_sided(this, both) {
            return Err(keys.measure.problem(message));
        }
        if let Some(message) = signed::unbreakable(this, requirement.check.limit) {
            return Err(keys.measure.problem(message));
        }
    }
    Ok(all)
}

/// Reads the decision rule.
pub(super) fn decision(keys: &DecisionKeys) -> Result<Decision, Problem> {
    let mut uncertainties: Vec<Uncertainty> = Vec::new();
    for stated in keys.uncertainties.iter().flatten() {
        let bare =
            path_of(&stated.measure).map_err(|error| stated.measure.problem(error.to_string()))?;
        if uncertainties.iter().any(|other| other.measure == bare) {
            let message = format!("found {bare:?} a second time, expected one uncertainty of each");
            return Err(stated.measure.problem(message));
        }
        let (uncertainty, _) = limit(&stated.uncertainty, bare)?;
        if !(uncertainty >= 0.0 && uncertainty.is_finite()) {
            let message = format!("found {uncertainty}, expected a number from 0 on");
            return Err(stated.uncertainty.problem(message));
        }
        uncertainties.push(Uncertainty { measure: bare.to_owned(), uncertainty });
    }
    Ok(Decision { rule: keys.rule, position_m: keys.position, uncertainties })
}

/// Reads the equipment of the bench.
pub(super) fn equipment(keys: &[EquipmentKeys]) -> Result<Vec<Equipment>, Problem> {
    let mut all: Vec<Equipment> = Vec::new();
    for EquipmentKeys { name, serial, certificate, expires } in keys {
        let filled = |key: &At<String>| {
            if key.trim().is_empty() {
                return Err(key.problem("found an empty text, expected one that names it"));
            }
            Ok(key.to_string())
        };
        let expires = Day::parse(expires).map_err(|error| expires.problem(error.to_string()))?;
        let one = Equipment {
            name: filled(name)?,
            serial: serial.clone(),
            certificate: filled(certificate)?,
            expires,
        };
        if all.iter().any(|other| other.name == one.name && other.serial == one.serial) {
            let message = format!("found {:?} a second time, expected each piece once", one.name);
            return Err(name.problem(message));
        }
        all.push(one);
    }
    Ok(all)
}

/// Limit in the unit of its measure, and as it was written.
fn limit(limit: &At<f64>, measure: &str) -> Result<(f64, String), Problem> {
    if limit.text.is_empty() {
        return Ok((**limit, limit.to_string()));
    }
    let number =
        limit_of(measure, &limit.text).map_err(|error| limit.problem(error.to_string()))?;
    Ok((number, limit.text.clone()))
}

/// Reason why a text is no measure of a run, or no limit of one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MeasureTextError {
    /// The text isn't a path.
    #[error(
        "found {found:?}, expected a dotted path such as navigation.longitude_error_arcmin.max"
    )]
    Form {
        /// The text.
        found: String,
    },
    /// The path ends at a table.
    #[error("found {found:?}: {place} is a table, expected a number in it: {}", .keys.join(", "))]
    Table {
        /// The text.
        found: String,
        /// Path of the table.
        place: String,
        /// Its keys.
        keys: Vec<&'static str>,
    },
    /// The path goes on behind a number.
    #[error("found {found:?}: {place} is a number and has no {part:?}")]
    Number {
        /// The text.
        found: String,
        /// Path of the number.
        place: String,
        /// Part behind it.
        part: String,
    },
    /// A table has no such key.
    #[error(
        "found {found:?}: {place} has no {part:?}, {}",
        suggestion(.part, .keys.iter().copied(), "it has")
    )]
    Key {
        /// The text.
        found: String,
        /// Path of the table.
        place: String,
        /// Unknown key.
        part: String,
        /// Its keys.
        keys: Vec<&'static str>,
    },
    /// The limit isn't a quantity.
    #[error("found {found:?}, expected a quantity")]
    Quantity {
        /// The limit.
        found: String,
    },
    /// The limit has a unit, and the measure has none.
    #[error("found {found:?}, expected a plain number: {measure} has no unit")]
    NoUnit {
        /// The limit.
        found: String,
        /// The measure.
        measure: String,
    },
    /// The limit has another dimension than the measure.
    #[error(
        "found {found:?}, expected a quantity that is comparable with {unit}, the unit of {measure}"
    )]
    Dimension {
        /// The limit.
        found: String,
        /// Unit of the measure.
        unit: String,
        /// The measure.
        measure: String,
    },
}

/// Path of a measure, without the bars for its magnitude.
///
/// # Errors
/// If it isn't a path, or no summary has it.
pub fn path_of(measure: &str) -> Result<&str, MeasureTextError> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let bare = measure.strip_prefix('|').and_then(|rest| rest.strip_suffix('|'));
    let bare = bare.unwrap_or(measure);
    let found = measure.to_owned();
    if bare.split('.').any(|part| part.is_empty() || !part.chars().all(plain)) {
        return Err(MeasureTextError::Form { found });
    }
    let Err(PathError { place, part, keys }) = measures::check(bare) else { return Ok(bare) };
    Err(match part {
        None => MeasureTextError::Table { found, place, keys },
        Some(part) if keys.is_empty() => MeasureTextError::Number { found, place, part },
        Some(part) => MeasureTextError::Key { found, place, part, keys },
    })
}

/// Converts a limit written as a quantity to the unit of its measure.
///
/// # Errors
/// If it isn't a quantity, or has another kind than the measure.
pub fn limit_of(measure: &str, text: &str) -> Result<f64, MeasureTextError> {
    let limit =
        quantity::parse(text).map_err(|_| MeasureTextError::Quantity { found: text.to_owned() })?;
    let Some((unit, one)) = unit_of(measure) else {
        return Err(MeasureTextError::NoUnit {
            found: text.to_owned(),
            measure: measure.to_owned(),
        });
    };
    if !limit.same_dimension(one) {
        return Err(MeasureTextError::Dimension {
            found: text.to_owned(),
            unit: unit.to_owned(),
            measure: measure.to_owned(),
        });
    }
    // In the measure's own unit, the written number is used unchanged.
    let own = text.trim().strip_suffix(unit).and_then(|n| n.trim().parse().ok());
    Ok(own.unwrap_or(limit.si / one.si))
}

/// Unit of a measure, and one of it as a quantity; `None` for counts and ratios.
fn unit_of(measure: &str) -> Option<(&'static str, Quantity)> {
    let unit = measures::unit(measure)?;
    let one = quantity::parse(&format!("1 {unit}")).ok()?;
    Some((unit, one))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measure_names_its_unit() {
        let all = measures::all();
        let unit = |measure| unit_of(measure).map(|(unit, _)| unit);
        assert_eq!(unit("navigation.longitude_error_arcmin.max"), Some("arcmin"));
        assert_eq!(unit("navigation.latitude_error_arcmin.slope_per_day"), Some("arcmin/day"));
        assert_eq!(unit("navigation.radial_error_nmi.rate_per_h"), Some("nmi/h"));
        assert_eq!(unit("calibration.parameters.g_zz.sigma"), Some("deg/h/g"));
        assert_eq!(unit("navigation.velocity_north_error_mps.slope_per_day"), Some("m/s/day"));
        assert_eq!(unit("navigation.velocity_east_error_mps.rms"), Some("m/s"));
        assert_eq!(limit_of("navigation.velocity_east_error_mps.max", "2 kn"), Ok(3704.0 / 3600.0));
        assert_eq!(unit("calibration.solution.roll_arcmin.sigma"), Some("arcmin"));
        assert_eq!(unit("calibration.solution.roll_arcmin.normalized"), None);
        assert_eq!(unit("calibration.nis_mean"), None);
        assert_eq!(unit("counterfactual.parameters.g_zz.shift"), Some("deg/h/g"));
        let lateness = limit_of("pacing.lateness_us.p99", "0.5 ms").unwrap();
        assert!((lateness / 500.0 - 1.0).abs() < 1e-12, "{lateness}");
        assert_eq!(limit_of("navigation.duration_h", "1 day"), Ok(24.0));
        assert_eq!(limit_of("pacing.device_clock.skew_ppm", "20 ppm"), Ok(20.0));
        // Every unit that a measure has is one of quantities.
        for entry in all.iter().filter(|entry| entry.unit != "1") {
            assert_eq!(unit(&entry.measure), Some(entry.unit), "{}", entry.measure);
            assert_eq!(limit_of(&entry.measure, &format!("2 {}", entry.unit)), Ok(2.0));
        }
        for shift_in_sigma in [
            "counterfactual.parameters.g_zz.sigma",
            "baseline.counterfactual.parameters.gyro_bias_x.sigma",
            "counterfactual.worst_shift_sigma",
        ] {
            assert_eq!(unit(shift_in_sigma), None, "{shift_in_sigma}");
            assert_eq!(
                limit_of(shift_in_sigma, "3 deg/h/g"),
                Err(MeasureTextError::NoUnit {
                    found: "3 deg/h/g".to_owned(),
                    measure: shift_in_sigma.to_owned(),
                })
            );
        }
    }
}
