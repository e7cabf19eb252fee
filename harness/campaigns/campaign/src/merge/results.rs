//! Results of cases as tables: one row per case, per checked requirement, and per point of a drift.

use super::factors::FactorColumns;
use crate::execute::case::{CaseResult, ResultError};
use crate::judge::except_requirements::verdict_except_requirements;
use crate::judge::twins::{SharedTwins, TwinsSaid};
use crate::plan::{Case, Plan};
use crate::store::CampaignResults;
use crate::store::in_plan_order::{RESULTS_AT_ONCE, read_in_order};
use crate::table::spill::SpilledRows;
use crate::table::{ColumnKind, ColumnValue, TableError, write_streamed};
use octant_score::summary::Summary;
use octant_score::verdict::RequirementResult;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// Column with the numerics version of a case's result.
pub(crate) const NUMERICS: &str = "numerics";

/// Columns with their kinds.
pub(crate) type Columns = &'static [(&'static str, ColumnKind)];

/// Column with the BLAKE3 of a case's result file.
pub(crate) const RESULT: &str = "result_blake3";

/// Tables: name of the file, and its first columns; other columns follow, sorted by name.
pub const TABLES: [(&str, Columns); 3] = [
    (
        "cases",
        &[
            ("case", ColumnKind::Text),
            ("scenario", ColumnKind::Text),
            ("seed", ColumnKind::Integer),
            ("replicate", ColumnKind::Integer),
            ("verdict", ColumnKind::Text),
            ("besides", ColumnKind::Text),
            ("reasons", ColumnKind::Text),
            ("error", ColumnKind::Text),
            ("stream_hash", ColumnKind::Text),
            (NUMERICS, ColumnKind::Integer),
            (RESULT, ColumnKind::Text),
            ("set", ColumnKind::Text),
        ],
    ),
    (
        "checks",
        &[
            ("case", ColumnKind::Text),
            ("requirement", ColumnKind::Text),
            ("measure", ColumnKind::Text),
            ("comparison", ColumnKind::Text),
            ("limit", ColumnKind::Number),
            ("value", ColumnKind::Number),
            ("margin", ColumnKind::Number),
            ("verdict", ColumnKind::Text),
            ("reason", ColumnKind::Text),
        ],
    ),
    (
        "drift",
        &[
            ("case", ColumnKind::Text),
            ("hours", ColumnKind::Number),
            ("latitude_error_arcmin", ColumnKind::Number),
            ("longitude_error_arcmin", ColumnKind::Number),
        ],
    ),
];

/// Rows of all tables, and how many of each case.
#[derive(Debug)]
pub(crate) struct TableRows {
    /// The tables, in the order of [`TABLES`].
    pub(crate) tables: [SpilledRows; 3],
    /// Rows of each case in each table, in the order in which the cases were given.
    pub(crate) counts: Vec<[u32; 3]>,
}

/// Lists columns in the order in which they are written.
pub(crate) fn ordered(
    first: Columns,
    kinds: &BTreeMap<&str, ColumnKind>,
) -> Vec<(String, ColumnKind)> {
    let others = kinds.keys().copied().filter(|name| !first.iter().any(|(other, _)| other == name));
    let names = first.iter().map(|(name, _)| *name).chain(others);
    names.filter_map(|name| Some((name.to_owned(), *kinds.get(name)?))).collect()
}

/// Writes the tables of cases, in the order of the plan, from the results in a folder.
///
/// # Errors
/// If a result can't be read or contradicts itself, or the operating system refuses.
pub fn tables(
    plan: &Plan,
    folder: &Path,
    cases: impl Iterator<Item = usize>,
    path: impl Fn(&str) -> std::path::PathBuf,
) -> Result<(), TableError> {
    let factors = FactorColumns::of(plan);
    let beside = path(TABLES[0].0);
    let place = beside.parent().unwrap_or(folder);
    // A plan has at most ten million cases.
    let cases: Vec<u32> = cases.filter_map(|case| u32::try_from(case).ok()).collect();
    let all = rows(plan, &open(folder)?, &cases, &factors, place)?;
    for ((name, first), rows) in TABLES.iter().zip(&all.tables) {
        let columns = ordered(first, &rows.kinds());
        let mut units = factors.units();
        units.retain(|name, _| rows.kinds().contains_key(name.as_str()));
        write_streamed(&path(name), &plan.id, &columns, &units, |index| {
            Ok(rows.column(&columns[index].0))
        })?;
    }
    Ok(())
}

/// Opens the results in a folder.
pub(crate) fn open(folder: &Path) -> Result<CampaignResults, TableError> {
    CampaignResults::open(folder).map_err(|error| unread(folder, &error))
}

/// Describes why a result, or all of them, can't be read.
fn unread(path: &Path, error: &ResultError) -> TableError {
    // The reason begins with action and file, as the error does.
    let (path, reason) = (path.to_owned(), error.to_string());
    let start = format!("read {}: ", path.display());
    let reason = reason.strip_prefix(&start).map(str::to_owned).unwrap_or(reason);
    TableError::Form { path, reason }
}

/// Rows of a case in all tables.
struct RowsOfCase {
    case: BTreeMap<String, ColumnValue>,
    checks: Vec<[Option<ColumnValue>; 9]>,
    drift: Vec<[f64; 3]>,
    twins: Option<TwinsSaid>,
}

/// Collects the rows of all tables from results, in temporary files in a folder.
pub(crate) fn rows(
    plan: &Plan,
    results: &CampaignResults,
    cases: &[u32],
    factors: &FactorColumns<'_>,
    place: &Path,
) -> Result<TableRows, TableError> {
    let [mut all_cases, mut checks, mut drift] =
        TABLES.map(|(_, first)| SpilledRows::new(place, first));
    let mut counts = Vec::with_capacity(cases.len());
    let case_of = |index: usize| plan.cases.get(*cases.get(index)? as usize);
    let read =
        |index: usize| case_of(index).map(|case| rows_of(plan, results, case, factors)).transpose();
    let mut shared = SharedTwins::default();
    read_in_order(cases.len(), RESULTS_AT_ONCE, read, |index, rows| {
        if let Some(reason) = shared.contradiction(rows.twins) {
            let id = case_of(index).map_or("", |case| case.id.as_str());
            let path = results.place(id).map_or_else(Default::default, |at| at.path().to_owned());
            return Err(TableError::Form { path, reason });
        }
        let count = |rows: usize| u32::try_from(rows).unwrap_or(u32::MAX);
        counts.push([1, count(rows.checks.len()), count(rows.drift.len())]);
        all_cases.push(rows.case)?;
        rows.checks.into_iter().try_for_each(|row| checks.push_values(row))?;
        let id = text(case_of(index).map_or("", |case| case.id.as_str()));
        rows.drift.into_iter().try_for_each(|row| {
            let [hours, latitude, longitude] = row.map(|value| Some(ColumnValue::Number(value)));
            drift.push_values([Some(id.clone()), hours, latitude, longitude])
        })
    })?;
    Ok(TableRows { tables: [all_cases, checks, drift], counts })
}

fn rows_of(
    plan: &Plan,
    results: &CampaignResults,
    case: &Case,
    factors: &FactorColumns<'_>,
) -> Result<RowsOfCase, TableError> {
    let place = results.place(&case.id);
    let path = place.map_or_else(Default::default, |place| place.path().to_owned());
    let read = results.of_plan(plan, case).map_err(|error| unread(&path, &error))?;
    let (result, hash) = read.ok_or_else(|| TableError::Form {
        path,
        reason: format!("the result of case {} is gone", case.id),
    })?;
    let series = result.summary.iter().flat_map(|summary| &summary.navigation);
    Ok(RowsOfCase {
        case: case_row(case, &result, &hash, factors),
        checks: result.summary.iter().flat_map(|summary| check_rows(case, summary)).collect(),
        drift: series.flat_map(|navigation| &navigation.series_hours).copied().collect(),
        twins: TwinsSaid::of(case, result.summary.as_ref()),
    })
}

fn text(value: impl Into<Arc<str>>) -> ColumnValue {
    ColumnValue::Text(value.into())
}

fn row<'a>(
    pairs: impl IntoIterator<Item = (&'a str, Option<ColumnValue>)>,
) -> BTreeMap<String, ColumnValue> {
    let there = |(name, value): (&str, Option<ColumnValue>)| Some((name.to_owned(), value?));
    pairs.into_iter().filter_map(there).collect()
}

fn case_row(
    case: &Case,
    result: &CaseResult,
    hash: &str,
    factors: &FactorColumns<'_>,
) -> BTreeMap<String, ColumnValue> {
    let summary = result.summary.as_ref();
    let mut all = row([
        ("case", Some(text(case.id.as_str()))),
        ("scenario", Some(text(case.scenario.as_str()))),
        ("seed", i64::try_from(case.seed).ok().map(ColumnValue::Integer)),
        ("replicate", Some(ColumnValue::Integer(i64::from(case.replicate)))),
        ("verdict", Some(text(result.verdict.name()))),
        ("besides", Some(text(verdict_except_requirements(result).name()))),
        ("reasons", summary.map(|summary| text(summary.reasons.join("; ")))),
        ("error", result.error.as_deref().map(text)),
        ("stream_hash", summary.map(|summary| text(summary.stream_hash.as_str()))),
        (
            NUMERICS,
            summary.and_then(|summary| Some(ColumnValue::Integer(i64::from(summary.numerics?)))),
        ),
        (RESULT, Some(text(hash))),
        ("set", Some(text(case.set.to_strings().join("; ")))),
    ]);
    for (name, value) in case.factors.iter() {
        all.insert(format!("factor.{name}"), factors.value(name, value));
    }
    if let Some(document) = summary.and_then(|summary| serde_json::to_value(summary).ok()) {
        measures(&document, &mut all);
    }
    all
}

/// Parts of a summary that have columns of their own, or don't concern the case.
const NOT_MEASURES: [&str; 9] = [
    "schema",
    "octant",
    "numerics",
    "seed",
    "scenario",
    "verdict",
    "reasons",
    "requirements",
    "stream_hash",
];

/// Collects every value of a summary under its dotted path; values of a fault under its id.
fn measures(document: &serde_json::Value, all: &mut BTreeMap<String, ColumnValue>) {
    let serde_json::Value::Object(parts) = document else { return };
    for (name, part) in parts.iter().filter(|(name, _)| !NOT_MEASURES.contains(&name.as_str())) {
        if name == "faults" {
            for fault in part.as_array().into_iter().flatten() {
                let id = fault.get("id").and_then(serde_json::Value::as_str).unwrap_or("");
                walk(&format!("faults.{id}"), fault, all);
            }
        } else {
            walk(name, part, all);
        }
    }
}

fn walk(path: &str, value: &serde_json::Value, all: &mut BTreeMap<String, ColumnValue>) {
    match value {
        serde_json::Value::Object(parts) => {
            for (name, part) in parts {
                walk(&format!("{path}.{name}"), part, all);
            }
        }
        serde_json::Value::Number(number) => {
            all.extend(
                number.as_f64().map(|number| (path.to_owned(), ColumnValue::Number(number))),
            );
        }
        serde_json::Value::Bool(value) => {
            _ = all.insert(path.to_owned(), ColumnValue::Boolean(*value))
        }
        serde_json::Value::String(text) => {
            _ = all.insert(path.to_owned(), ColumnValue::Text(text.as_str().into()));
        }
        // Series have a table of their own.
        serde_json::Value::Array(_) | serde_json::Value::Null => {}
    }
}

/// Rows of the checks of a case, in the columns of their table.
fn check_rows(case: &Case, summary: &Summary) -> Vec<[Option<ColumnValue>; 9]> {
    let id = text(case.id.as_str());
    let row = |result: &RequirementResult| {
        [
            Some(id.clone()),
            Some(text(result.id.as_str())),
            Some(text(result.measure.as_str())),
            Some(text(result.comparison.sign())),
            Some(ColumnValue::Number(result.limit)),
            result.value.map(ColumnValue::Number),
            result.margin.map(ColumnValue::Number),
            Some(text(result.verdict.name())),
            result.reason.as_deref().map(text),
        ]
    };
    summary.requirements.iter().map(row).collect()
}
