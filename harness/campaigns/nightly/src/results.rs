//! Reads the results of a campaign's cases from its tables.

use octant_campaign::merge::factors::parts;
use octant_campaign::merge::merged;
use octant_campaign::table::{ColumnValue, ColumnValues, ExistingTable, TableError};
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_score::rederive::stands;
use octant_verdict::{Comparison, Verdict};
use std::collections::BTreeMap;
use std::path::Path;

/// Measures for which less is better, as columns of `cases.parquet`.
const LESS_IS_BETTER: [&str; 13] = [
    "navigation.latitude_error_arcmin.max",
    "navigation.latitude_error_arcmin.rms",
    "navigation.longitude_error_arcmin.max",
    "navigation.longitude_error_arcmin.rms",
    "navigation.radial_error_nmi.max",
    "navigation.radial_error_nmi.rms",
    "navigation.radial_error_nmi.rate_per_h",
    "navigation.heading_error_arcmin.rms",
    "navigation.pitch_error_arcmin.rms",
    "navigation.roll_error_arcmin.rms",
    "navigation.velocity_north_error_mps.rms",
    "navigation.velocity_east_error_mps.rms",
    "calibration.worst_normalized_error",
];

/// Those of them that older programs don't score.
pub(crate) const SCORED_LATER: [&str; 5] = [
    "navigation.heading_error_arcmin.rms",
    "navigation.pitch_error_arcmin.rms",
    "navigation.roll_error_arcmin.rms",
    "navigation.velocity_north_error_mps.rms",
    "navigation.velocity_east_error_mps.rms",
];

/// One case.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseRow {
    /// Id, derived from everything that determines its result except the program.
    pub case: String,
    /// Scenario in the campaign.
    pub scenario: String,
    /// Key shared with the same case of another night: scenario, seed, replicate and factors.
    pub pair: String,
    /// Verdict.
    pub verdict: Verdict,
    /// Reasons, as text.
    pub reasons: String,
    /// Measures for which less is better.
    pub measures: BTreeMap<String, f64>,
    /// Requirements with their verdicts and margins.
    pub checks: BTreeMap<String, (Verdict, Option<f64>)>,
    /// All columns of its row.
    pub row: Vec<(String, ColumnValue)>,
}

/// Reads the tables of a campaign in a folder.
///
/// # Errors
/// If they can't be read, or aren't of this version.
pub fn read(folder: &Path) -> Result<Vec<CaseRow>, TableError> {
    let (of_checks, of_cases) = (merged(folder, "checks"), merged(folder, "cases"));
    let mut checks = checks(&of_checks)?;
    let table = ExistingTable::open(&of_cases)?;
    let columns = columns(&table)?;
    let mut all = Vec::with_capacity(table.rows);
    for row in 0..table.rows {
        let row: Vec<(String, ColumnValue)> = columns
            .iter()
            .filter_map(|(name, values)| Some((name.clone(), values.at(row)?)))
            .collect();
        let text = |name: &str| match row.iter().find(|(other, _)| other == name) {
            Some((_, ColumnValue::Text(text))) => text.to_string(),
            _ => String::new(),
        };
        let case = text("case");
        let verdict = verdict(&text("verdict")).ok_or_else(|| TableError::Form {
            path: of_cases.clone(),
            reason: format!("case {case} has verdict {:?}", text("verdict")),
        })?;
        let checks = checks.remove(&case).unwrap_or_default();
        if let Some(worst) = checks.values().map(|(verdict, _)| *verdict).max()
            && verdict < worst
        {
            return Err(TableError::Form {
                path: of_cases.clone(),
                reason: format!(
                    "case {case} says {}, its checks come to {}",
                    verdict.name(),
                    worst.name()
                ),
            });
        }
        let reasons = [text("error"), text("reasons")].into_iter().find(|text| !text.is_empty());
        all.push(CaseRow {
            scenario: text("scenario"),
            pair: pair(&row, &table.units),
            verdict,
            reasons: reasons.unwrap_or_default(),
            measures: measures(&row),
            checks,
            row,
            case,
        });
    }
    Ok(all)
}

type Checks = BTreeMap<String, (Verdict, Option<f64>)>;

fn checks(path: &Path) -> Result<BTreeMap<String, Checks>, TableError> {
    let table = ExistingTable::open(path)?;
    let columns = columns(&table)?;
    let at = |name: &str, row: usize| {
        columns.iter().find(|(other, _)| other == name).and_then(|(_, values)| values.at(row))
    };
    let mut all: BTreeMap<String, Checks> = BTreeMap::new();
    for row in 0..table.rows {
        let (
            Some(ColumnValue::Text(case)),
            Some(ColumnValue::Text(requirement)),
            Some(ColumnValue::Text(name)),
        ) = (at("case", row), at("requirement", row), at("verdict", row))
        else {
            return Err(TableError::Form {
                path: path.to_owned(),
                reason: format!("row {row} has no case, requirement or verdict"),
            });
        };
        let margin = match at("margin", row) {
            Some(ColumnValue::Number(margin)) => Some(margin),
            _ => None,
        };
        let verdict = verdict(&name).ok_or_else(|| TableError::Form {
            path: path.to_owned(),
            reason: format!("row {row} has verdict {name:?}"),
        })?;
        let number = |name: &str| match at(name, row) {
            Some(ColumnValue::Number(number)) => Some(number),
            _ => None,
        };
        // A verdict in the table is accepted only if value and limit support it.
        let sign = Comparison::ALL
            .into_iter()
            .find(|known| at("comparison", row) == Some(ColumnValue::Text(known.sign().into())));
        let known = sign.zip(number("limit"));
        if !known.is_some_and(|(sign, limit)| stands(verdict, sign, number("value"), limit)) {
            return Err(TableError::Form {
                path: path.to_owned(),
                reason: format!(
                    "case {case} says {} of {requirement}, its value and its limit say something else",
                    verdict.name()
                ),
            });
        }
        let checks = all.entry(case.to_string()).or_default();
        checks.insert(requirement.to_string(), (verdict, margin));
    }
    Ok(all)
}

fn columns(table: &ExistingTable) -> Result<Vec<(String, ColumnValues)>, TableError> {
    let read = |(name, _): &(String, _)| Ok(table.column(name)?.map(|v| (name.clone(), v)));
    table.columns.iter().filter_map(|column| read(column).transpose()).collect()
}

fn verdict(name: &str) -> Option<Verdict> {
    Verdict::ALL.into_iter().find(|verdict| verdict.name() == name)
}

/// Builds the key that pairs cases of two nights. The id can't be used: it changes with the
/// scenario. A factor with a unit is a number in tables with units, and a text in older ones.
fn pair(row: &[(String, ColumnValue)], units: &BTreeMap<String, String>) -> String {
    let told = row.iter().filter(|(name, _)| {
        ["scenario", "seed", "replicate"].contains(&name.as_str()) || name.starts_with("factor.")
    });
    let one = |(name, value): &(String, ColumnValue)| {
        let quantity = match (value, units.get(name)) {
            (ColumnValue::Number(number), Some(unit)) => Some((*number, unit.as_str())),
            (ColumnValue::Text(text), None) if name.starts_with("factor.") => parts(text),
            _ => None,
        };
        match quantity {
            Some((number, unit)) => format!("{name}={number} {unit};"),
            None => format!("{name}={value:?};"),
        }
    };
    told.map(one).collect()
}

/// Collects the measures of a case, and the root mean square of the errors of each group of
/// parameters.
fn measures(row: &[(String, ColumnValue)]) -> BTreeMap<String, f64> {
    let number = |path: &str| {
        row.iter().find(|(name, _)| name == path).and_then(|(_, value)| match value {
            ColumnValue::Number(number) => Some(*number),
            _ => None,
        })
    };
    let mut all: BTreeMap<String, f64> = LESS_IS_BETTER
        .iter()
        .filter_map(|path| Some(((*path).to_owned(), number(path)?)))
        .collect();
    for group in ParameterGroup::ALL {
        let errors: Option<Vec<f64>> = NAMES[group.range()]
            .iter()
            .map(|name| number(&format!("calibration.parameters.{name}.error")))
            .collect();
        if let Some(rms) = errors.and_then(|errors| octant_statistics::sample::rms(&errors)) {
            all.insert(format!("calibration.parameters.{}.error_rms", group.name()), rms);
        }
    }
    all
}
