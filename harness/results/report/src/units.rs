//! Units of the measures that a requirement can have, as the pages show them.

use octant_base::display::DisplayUnits;
use octant_sample::parameters::ParameterGroup;
use octant_verdict::measures;
use std::borrow::Cow;

/// Returns the unit of the measure at a path of the summary, with or without bars: `arcmin`, `nmi/h`,
/// `ppm`; empty for counts, ratios and paths that no run has.
#[must_use]
pub fn unit(path: &str) -> &'static str {
    let path = path.trim_matches('|');
    match measures::unit(path) {
        Some("us") => "µs",
        Some(unit) => unit,
        None if measures::is_in_sigma(path) => "σ",
        None => of_group(path),
    }
}

/// Unit of the root mean square of a group's errors, which nights have beside the measures of runs.
fn of_group(path: &str) -> &'static str {
    let name = path
        .strip_prefix("calibration.parameters.")
        .and_then(|rest| rest.strip_suffix(".error_rms"));
    let group = ParameterGroup::ALL.into_iter().find(|group| Some(group.name()) == name);
    group.map_or("", ParameterGroup::unit)
}

/// Unit in which a page shows a measure.
#[derive(Clone, Debug, PartialEq)]
pub struct PageUnit {
    /// Number of these units in the measure's own.
    pub factor: f64,
    /// Name; empty for counts and ratios.
    pub name: Cow<'static, str>,
}

impl PageUnit {
    /// Converts a value from the measure's own unit.
    #[must_use]
    pub fn of(&self, value: f64) -> f64 {
        value * self.factor
    }
}

/// Returns the unit of the measure at a path, with or without bars, among these display units. Only
/// errors of position, attitude and velocity have other units than their own.
#[must_use]
pub fn shown(path: &str, units: &DisplayUnits) -> PageUnit {
    let own = unit(path);
    match error_of(path) {
        Some((name, per)) => {
            let unit = units.of(name);
            let name = if per.is_empty() {
                unit.name.into()
            } else {
                format!("{}{per}", unit.name).into()
            };
            PageUnit { factor: unit.factor, name }
        }
        None => PageUnit { factor: 1.0, name: own.into() },
    }
}

/// Returns whether the measure at a path, with or without bars, is an error of latitude or longitude, whose
/// length on the ground depends on the place.
#[must_use]
pub fn is_of_place(path: &str) -> bool {
    error_of(path).is_some_and(|(name, _)| matches!(name, "latitude" | "longitude"))
}

/// Name of the error that a measure is, as in [`DisplayUnits::of`], and the time that it is divided by.
fn error_of(path: &str) -> Option<(&'static str, &'static str)> {
    let path = path.trim_matches('|');
    let own = measures::unit(path)?;
    let name = match own.split('/').next()? {
        "arcmin" => ["latitude", "longitude", "heading", "pitch", "roll"]
            .into_iter()
            .find(|name| path.split(['.', '_']).any(|word| word == *name))?,
        "nmi" => "radial",
        "m" if own.starts_with("m/s") => "north",
        _ => return None,
    };
    let per = ["/day", "/h"].into_iter().find(|per| own.ends_with(per)).unwrap_or("");
    Some((name, per))
}
