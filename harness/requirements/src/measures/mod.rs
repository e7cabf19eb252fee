//! Measures that a requirement can have: the numbers of the summary, by their paths.
//!
//! `tree` declares each of them once, with unit, meaning, sign and conditions. Readers of requirements
//! check paths and limits against it, and `octant requirements measures` lists it.

mod method;
mod need;
mod place;
mod tree;

pub use need::MeasureNeed;

use octant_sample::parameters::{NAMES, ParameterGroup};
use place::{Names, Number, Place, Unit};
use serde::Serialize;
use tree::SUMMARY;

/// Measure that a requirement can have.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct MeasureEntry {
    /// Path in the summary.
    pub measure: String,
    /// Unit of the measure, in which a plain limit is; "1" for a count or a ratio, whose limits have no
    /// unit.
    pub unit: &'static str,
    /// Meaning, in words.
    pub meaning: String,
    /// True if the measure can be negative: a limit on one side alone needs bars about it.
    pub signed: bool,
    /// Conditions without which a run doesn't have it.
    pub needs: Vec<MeasureNeed>,
}

/// Reason why a path isn't a measure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathError {
    /// Place in the path up to which it is valid.
    pub place: String,
    /// Part after it that is unknown; `None` if the path ends at a table.
    pub part: Option<String>,
    /// Keys to choose from; empty after a number.
    pub keys: Vec<&'static str>,
}

/// Number at the end of a path.
struct Found {
    number: &'static Number,
    /// Parameter on the way to it.
    parameter: Option<usize>,
}

/// Checks that a run can have the measure at this path (without bars).
///
/// # Errors
/// The part of the path that leads nowhere, with the keys to choose from.
pub fn check(path: &str) -> Result<(), PathError> {
    walk(path).map(|_| ())
}

fn walk(path: &str) -> Result<Found, PathError> {
    let mut walked: Vec<&str> = Vec::new();
    let (mut at, mut parameter) = (&SUMMARY, None);
    let told = |walked: &[&str], part: Option<&str>, keys| PathError {
        place: if walked.is_empty() { "the summary".to_owned() } else { walked.join(".") },
        part: part.map(str::to_owned),
        keys,
    };
    for part in path.split('.') {
        let keys = keys(at);
        let Some(index) = keys.iter().position(|key| *key == part) else {
            return Err(told(&walked, Some(part), keys));
        };
        at = match at {
            Place::Table { keys, .. } => &keys[index].1,
            Place::Each { names, of, .. } => {
                if let Names::Parameters = names {
                    parameter = Some(index);
                }
                of
            }
            // A number has no keys.
            Place::Number(_) => return Err(told(&walked, Some(part), keys)),
        };
        walked.push(part);
    }
    match at {
        Place::Number(number) => Ok(Found { number, parameter }),
        table => Err(told(&walked, None, keys(table))),
    }
}

/// Keys at a place, in their order; none of a number.
fn keys(place: &Place) -> Vec<&'static str> {
    match place {
        Place::Number(_) => Vec::new(),
        Place::Table { keys, .. } => keys.iter().map(|(key, _)| *key).collect(),
        Place::Each { names: Names::Parameters, .. } => NAMES.to_vec(),
        Place::Each { names: Names::Groups, .. } => {
            ParameterGroup::ALL.map(ParameterGroup::name).to_vec()
        }
    }
}

/// Unit in which a limit of the measure at a path (without bars) can be written; `None` for counts and
/// ratios, and for paths that no run has.
#[must_use]
pub fn unit(path: &str) -> Option<&'static str> {
    let Found { number, parameter } = walk(path).ok()?;
    unit_of(number, parameter)
}

fn unit_of(number: &Number, parameter: Option<usize>) -> Option<&'static str> {
    match number.unit {
        Unit::One | Unit::Sigma => None,
        Unit::Named(unit) => Some(unit),
        Unit::Parameter => parameter.map(|index| ParameterGroup::of(index).unit()),
    }
}

/// True if the measure at a path (without bars) is a multiple of a standard deviation.
#[must_use]
pub fn is_in_sigma(path: &str) -> bool {
    walk(path).is_ok_and(|found| matches!(found.number.unit, Unit::Sigma))
}

/// True if the measure at a path (without bars) can be negative.
#[must_use]
pub fn is_signed(path: &str) -> bool {
    walk(path).is_ok_and(|found| found.number.signed)
}

/// Lists all measures, in the order of the summary.
#[must_use]
pub fn all() -> Vec<MeasureEntry> {
    let mut found = Vec::new();
    collect(&SUMMARY, &Walked::default(), &mut found);
    found
}

/// Way from the top of the summary to a place.
#[derive(Clone, Default)]
struct Walked {
    path: Vec<&'static str>,
    parameter: Option<usize>,
    meaning: Vec<&'static str>,
    needs: Vec<MeasureNeed>,
}

impl Walked {
    fn to(&self, key: &'static str) -> Self {
        let mut next = self.clone();
        next.path.push(key);
        next
    }

    fn with(&self, meaning: &'static str, needs: &[MeasureNeed]) -> Self {
        let mut next = self.clone();
        if !meaning.is_empty() {
            next.meaning.push(meaning);
        }
        next.needs.extend_from_slice(needs);
        next.needs.sort_unstable();
        next.needs.dedup();
        next
    }
}

fn collect(place: &'static Place, walked: &Walked, found: &mut Vec<MeasureEntry>) {
    match place {
        Place::Number(number) => {
            let walked = walked.with(number.meaning, number.needs);
            found.push(MeasureEntry {
                measure: walked.path.join("."),
                unit: unit_of(number, walked.parameter).unwrap_or("1"),
                meaning: walked.meaning.join(": "),
                signed: number.signed,
                needs: walked.needs,
            });
        }
        Place::Table { meaning, needs, keys } => {
            let walked = walked.with(meaning, needs);
            for (key, inner) in *keys {
                collect(inner, &walked.to(key), found);
            }
        }
        Place::Each { meaning, needs, names, of } => {
            let walked = walked.with(meaning, needs);
            for (index, key) in keys(place).into_iter().enumerate() {
                let mut next = walked.to(key).with(key, &[]);
                if let Names::Parameters = names {
                    next.parameter = Some(index);
                }
                collect(of, &next, found);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Every path that the check accepts, found by asking it for the keys of each place.
    fn accepted(place: &str, found: &mut Vec<String>) {
        let error = check(&format!("{place}no_such_name")).unwrap_err();
        for key in error.keys {
            let path = format!("{place}{key}");
            match check(&path) {
                Ok(()) => found.push(path),
                Err(_) => accepted(&format!("{path}."), found),
            }
        }
    }

    #[test]
    fn all_that_is_listed_is_accepted_and_all_that_is_accepted_is_listed() {
        let listed: Vec<String> = all().into_iter().map(|entry| entry.measure).collect();
        let mut found = Vec::new();
        accepted("", &mut found);
        assert_eq!(listed, found);
        let once: BTreeSet<&String> = listed.iter().collect();
        assert_eq!(once.len(), listed.len());
        // 30 parameters with five numbers, of two methods, are 300 of them.
        let parameters = |path: &&String| path.contains("calibration.parameters.");
        assert_eq!(listed.iter().filter(parameters).count(), 300);
    }

    #[test]
    fn an_entry_has_what_its_path_says() {
        let all = all();
        let entry = |path: &str| all.iter().find(|entry| entry.measure == path).unwrap();
        let slope = entry("baseline.navigation.longitude_error_arcmin.slope_per_day");
        assert_eq!((slope.unit, slope.signed), ("arcmin/day", true));
        assert_eq!(
            slope.needs,
            [
                MeasureNeed::Navigation,
                MeasureNeed::Truth,
                MeasureNeed::SchulerPeriod,
                MeasureNeed::Baseline
            ]
        );
        assert!(slope.meaning.starts_with("second method: navigation: longitude error"));
        let error = entry("calibration.parameters.g_zz.error");
        assert_eq!((error.unit, error.signed), ("deg/h/g", true));
        assert_eq!(error.needs, [MeasureNeed::Calibration, MeasureNeed::Truth]);
        assert!(error.meaning.contains("g_zz"), "{}", error.meaning);
        let nis = entry("calibration.nis_mean");
        assert_eq!((nis.unit, nis.signed), ("1", false));
        for entry in &all {
            assert!(!entry.meaning.is_empty() && !entry.meaning.ends_with(": "), "{entry:?}");
            assert!(!entry.needs.windows(2).any(|pair| pair[0] >= pair[1]), "{entry:?}");
        }
    }

    /// The names of the summary end in their units: each number whose name does has that unit.
    #[test]
    fn units_are_those_of_the_names() {
        const ENDS: [(&str, &str); 9] = [
            ("_arcmin", "arcmin"),
            ("_nmi", "nmi"),
            ("_mps", "m/s"),
            ("_deg", "deg"),
            ("_us", "us"),
            ("_ppm", "ppm"),
            ("_min", "min"),
            ("_h", "h"),
            ("_s", "s"),
        ];
        let mut checked = 0;
        for entry in all() {
            let parts: Vec<&str> = entry.measure.split('.').rev().collect();
            let named = |part: &&str| {
                ENDS.iter().find(|(end, _)| part.ends_with(end)).map(|(_, unit)| *unit)
            };
            let expected = match parts.as_slice() {
                ["normalized", ..] => "1".to_owned(),
                ["slope_per_day", of, ..] => format!("{}/day", named(of).unwrap()),
                ["rate_per_h", of, ..] => format!("{}/h", named(of).unwrap()),
                [last, of, ..] => match named(last).or_else(|| named(of)) {
                    Some(unit) => unit.to_owned(),
                    None => continue,
                },
                _ => unreachable!(),
            };
            assert_eq!(entry.unit, expected, "{}", entry.measure);
            checked += 1;
        }
        assert!(checked > 150, "{checked}");
    }

    #[test]
    fn a_path_that_leads_nowhere_is_told_with_the_keys_there() {
        let error = |path| check(path).unwrap_err();
        assert_eq!(error("navigation").part, None);
        assert_eq!(
            error("navigation.radial_error_nmi").keys,
            ["max", "rms", "final", "rate_per_h"]
        );
        let unknown = error("navigation.radial_error_nmi.least");
        assert_eq!(
            (unknown.place.as_str(), unknown.part.as_deref()),
            ("navigation.radial_error_nmi", Some("least"))
        );
        let beyond = error("calibration.nis_mean.max");
        assert_eq!((beyond.place.as_str(), beyond.keys.len()), ("calibration.nis_mean", 0));
        assert_eq!(error("nothing").place, "the summary");
    }
}
