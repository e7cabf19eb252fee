//! Measures that a requirement can have: the numbers of the summary, by their paths.
//!
//! `tree` declares each of them once, with unit, meaning, sign and conditions. Readers of requirements
//! check paths and limits against it, and `octant requirements measures` lists it.

mod heading;
mod method;
mod need;
mod place;
mod tree;
mod unasked;

pub use need::MeasureNeed;
pub use unasked::{Unasked, unasked};

use octant_sample::further::{FURTHER_NAMES, FurtherGroup};
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
    /// Unit of the parameter on the way to it.
    parameter: Option<&'static str>,
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
                parameter = names.unit(index).or(parameter);
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
        Place::Each { names: Names::Further, .. } => FURTHER_NAMES.to_vec(),
        Place::Each { names: Names::Groups, .. } => {
            let further = FurtherGroup::ALL.map(FurtherGroup::name);
            ParameterGroup::ALL.map(ParameterGroup::name).into_iter().chain(further).collect()
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

impl Names {
    /// Unit of the quantity with this index in the set.
    fn unit(self, index: usize) -> Option<&'static str> {
        match self {
            Self::Parameters => Some(ParameterGroup::of(index).unit()),
            Self::Further => FurtherGroup::of(index).map(FurtherGroup::unit),
            Self::Groups => None,
        }
    }
}

fn unit_of(number: &Number, parameter: Option<&'static str>) -> Option<&'static str> {
    match number.unit {
        Unit::One | Unit::Sigma => None,
        Unit::Named(unit) => Some(unit),
        Unit::Parameter => parameter,
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

/// Reason why a limit of a measure has no factor sec φ; `None`: it may have one.
#[must_use]
pub fn without_secant(measure: &str) -> Option<String> {
    let bare = measure.trim_matches('|');
    let takes = walk(bare).is_ok_and(|found| found.number.secant);
    let of_heading = || all().into_iter().map(|entry| entry.measure);
    (!takes).then(|| {
        let those: Vec<String> =
            of_heading().filter(|path| walk(path).is_ok_and(|found| found.number.secant)).collect();
        format!(
            "found true, and the limit of {bare} has no factor sec φ; those with one: {}",
            those.join(", ")
        )
    })
}

/// Conditions without which a run doesn't have the measure at a path (without bars); none for a path that no run has.
#[must_use]
pub fn needs(path: &str) -> Vec<MeasureNeed> {
    let entry = all().into_iter().find(|entry| entry.measure == path);
    entry.map(|entry| entry.needs).unwrap_or_default()
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
    parameter: Option<&'static str>,
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
                next.parameter = names.unit(index).or(next.parameter);
                collect(of, &next, found);
            }
        }
    }
}
