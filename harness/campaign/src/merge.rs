//! Merges the parts of shards into the same tables, wherever and in whatever order they were run.

use super::chain;
use super::independence::Shown;
use super::plan::{Plan, short};
use super::results::{self, Columns, NUMERICS, TABLES, ordered};
use super::shard::Shard;
use super::stop;
use super::table::{ColumnKind, ColumnValues, ExistingTable, TableError, write_with_units};
use octant_requirements::Verdict;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Returns the file of a shard's table in the folder of its campaign.
#[must_use]
pub fn part(folder: &Path, shard: Shard, table: &str) -> PathBuf {
    let name = format!("{}-of-{}.{table}.parquet", shard.number, shard.of);
    folder.join("parts").join(name)
}

/// Returns the file of a merged table in the folder of its campaign.
#[must_use]
pub fn merged(folder: &Path, table: &str) -> PathBuf {
    folder.join(format!("{table}.parquet"))
}

/// Reasons why parts can't be merged.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A table can't be read or written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// No parts were given.
    #[error("merge {folder}: no parts of shards are there, expected parts/*.cases.parquet")]
    Nothing {
        /// The folder.
        folder: PathBuf,
    },
    /// A part is of another plan.
    #[error("merge {path}: it is of plan {found}, expected {expected}")]
    Foreign {
        /// The part.
        path: PathBuf,
        /// Plan that the part names.
        found: String,
        /// Plan of the campaign.
        expected: String,
    },
    /// A case has two results, by programs whose numerics versions explain the difference.
    #[error(
        "merge {second}: case {case} is of another numerics version than in {first}, so that its numbers differ: \
         run one of the two parts again with the program of the other"
    )]
    Numerics {
        /// The case.
        case: String,
        /// First part that contains it.
        first: PathBuf,
        /// Other part.
        second: PathBuf,
    },
    /// A case has two results.
    #[error(
        "merge {second}: case {case} differs in {column} from {first}: the same case has to come to the same result"
    )]
    Differs {
        /// The case.
        case: String,
        /// First column that differs.
        column: String,
        /// First part that contains the case.
        first: PathBuf,
        /// Other part.
        second: PathBuf,
    },
}

/// Summary of a merge.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Merged {
    /// Number of parts.
    pub parts: usize,
    /// Cases of the plan with a result.
    pub cases: usize,
    /// Cases of the plan without a result.
    pub missing: usize,
}

/// Lists the parts in some folders, in order of their names.
fn parts(folders: &[PathBuf], table: &str) -> Vec<PathBuf> {
    let end = format!(".{table}.parquet");
    let mut all: Vec<PathBuf> = folders
        .iter()
        .flat_map(|folder| std::fs::read_dir(folder.join("parts")).into_iter().flatten().flatten())
        .map(|entry| entry.path())
        .filter(|path| path.to_string_lossy().ends_with(&end))
        .collect();
    all.sort();
    all
}

/// Place of a row.
#[derive(Clone, Copy, Debug)]
struct Row {
    part: usize,
    row: usize,
}

/// Returns the number of cases that count: all, or those up to the point where the stopping rule is
/// satisfied, from the parts in `folders`.
///
/// # Errors
/// If a part can't be read.
pub fn end(plan: &Plan, folders: &[PathBuf]) -> Result<usize, MergeError> {
    let Some(rule) = &plan.stop else { return Ok(plan.cases.len()) };
    let mut all: HashMap<Arc<str>, Shown> = HashMap::new();
    let pass = Some(Verdict::Pass.name());
    // A case without a summary checked nothing, so it isn't passed.
    for path in parts(folders, "cases") {
        let table = ExistingTable::open(&path)?;
        let [cases, streams] = ["case", "stream_hash"].map(|name| texts(&table, &path, name));
        // Parts of older versions have only the verdict of the whole case.
        let besides =
            texts(&table, &path, "besides").or_else(|_| texts(&table, &path, "verdict"))?;
        for ((case, stream), besides) in cases?.into_iter().zip(streams?).zip(besides) {
            let (Some(case), passed) = (case, besides.as_deref() == pass) else { continue };
            let stream = stream.map(|stream| stream.to_string());
            all.insert(case, Shown { passed, stream });
        }
    }
    let mut checked: HashSet<Arc<str>> = HashSet::new();
    for path in parts(folders, "checks") {
        let table = ExistingTable::open(&path)?;
        let [cases, ids, verdicts] =
            ["case", "requirement", "verdict"].map(|name| texts(&table, &path, name));
        for ((case, id), verdict) in cases?.into_iter().zip(ids?).zip(verdicts?) {
            if let (Some(case), Some(id)) = (case, id)
                && *id == *rule.requirement
            {
                if let Some(shown) = all.get_mut(&case) {
                    shown.passed &= verdict.as_deref() == pass;
                }
                checked.insert(case);
            }
        }
    }
    let decision = stop::decide(plan, rule, |case| {
        let mut shown = all.get(case.id.as_str())?.clone();
        shown.passed &= checked.contains(case.id.as_str());
        Some(shown)
    });
    Ok(decision.end(plan.cases.len()))
}

/// Reads a text column of a part.
fn texts(
    table: &ExistingTable,
    path: &Path,
    name: &str,
) -> Result<Vec<Option<Arc<str>>>, TableError> {
    match table.column(name)? {
        Some(ColumnValues::Text(texts)) => Ok(texts),
        _ => Err(TableError::Form {
            path: path.to_owned(),
            reason: format!("it has no texts in a column {name}"),
        }),
    }
}

/// Merges the parts in `folders` into the tables of `out`, with the cases of the plan up to `end`,
/// in its order.
///
/// # Errors
/// If a part isn't of this plan, a case has two results, or the operating system refuses.
pub fn merge(
    plan: &Plan,
    folders: &[PathBuf],
    out: &Path,
    end: usize,
) -> Result<Merged, MergeError> {
    check_parts(plan, folders)?;
    let place: HashMap<&str, usize> =
        plan.cases.iter().enumerate().map(|(index, case)| (case.id.as_str(), index)).collect();
    let mut merged_cases = Merged { parts: 0, cases: 0, missing: 0 };
    for (name, first) in TABLES {
        let paths = parts(folders, name);
        if paths.is_empty() {
            let folder = folders.first().cloned().unwrap_or_default();
            return Err(MergeError::Nothing { folder });
        }
        let tables =
            paths.iter().map(|path| ExistingTable::open(path)).collect::<Result<Vec<_>, _>>()?;
        for (table, path) in tables.iter().zip(&paths) {
            if table.plan != plan.id {
                return Err(MergeError::Foreign {
                    path: path.clone(),
                    found: short(&table.plan).to_owned(),
                    expected: short(&plan.id).to_owned(),
                });
            }
        }
        let mut rows: BTreeMap<usize, Vec<Row>> = BTreeMap::new();
        for (at, table) in tables.iter().enumerate() {
            let Some(ColumnValues::Text(cases)) = table.column("case")? else {
                let reason = "it has no column case".to_owned();
                return Err(TableError::Form { path: paths[at].clone(), reason }.into());
            };
            for (row, case) in cases.iter().enumerate() {
                let index = case.as_deref().and_then(|case| place.get(case).copied());
                let Some(index) = index else {
                    let reason = format!("the plan has no case {}", case.as_deref().unwrap_or(""));
                    return Err(TableError::Form { path: paths[at].clone(), reason }.into());
                };
                rows.entry(index).or_default().push(Row { part: at, row });
            }
        }
        let columns = columns(first, &tables);
        refuse_differing(plan, &rows, &tables, &paths, &columns)?;
        // If several parts contain a case, the rows of the first are used.
        let kept: Vec<Row> = rows
            .range(..end)
            .flat_map(|(_, rows)| {
                let first = rows.first().map_or(0, |row| row.part);
                rows.iter().copied().filter(move |row| row.part == first)
            })
            .collect();
        // A column whose cases don't count is left out.
        let empty = |column: &str| -> Result<bool, TableError> {
            for (part, table) in tables.iter().enumerate() {
                let Some(values) = table.column(column)? else { continue };
                let mut mine = kept.iter().filter(|row| row.part == part);
                if mine.any(|row| values.at(row.row).is_some()) {
                    return Ok(false);
                }
            }
            Ok(true)
        };
        let mut columns = columns;
        if end < plan.cases.len() {
            let first = |name: &String| first.iter().any(|(other, _)| other == name);
            let mut there = Vec::with_capacity(columns.len());
            for (column, kind) in columns {
                if first(&column) || !empty(&column)? {
                    there.push((column, kind));
                }
            }
            columns = there;
        }
        if name == "cases" {
            merged_cases = Merged {
                parts: paths.len(),
                cases: kept.len(),
                missing: end.min(plan.cases.len()) - kept.len(),
            };
        }
        let mut units = BTreeMap::new();
        tables.iter().for_each(|table| units.extend(table.units.clone()));
        // A part that is older than units makes the column text.
        units.retain(|name, _| columns.contains(&(name.clone(), ColumnKind::Number)));
        write_with_units(&merged(out, name), &plan.id, &columns, &units, |index| {
            let (column, kind) = &columns[index];
            let of_parts =
                tables.iter().map(|table| table.column(column)).collect::<Result<Vec<_>, _>>()?;
            let mut values = ColumnValues::new(*kind);
            for Row { part, row } in &kept {
                values.push(of_parts[*part].as_ref().and_then(|values| values.at(*row)));
            }
            Ok(Cow::Owned(values))
        })?;
    }
    Ok(merged_cases)
}

/// Checks that parts agree with the results beside them.
fn check_parts(plan: &Plan, folders: &[PathBuf]) -> Result<(), MergeError> {
    let end = format!(".{}.parquet", TABLES[0].0);
    for folder in folders {
        let stored = results::open(folder)?;
        for path in parts(std::slice::from_ref(folder), TABLES[0].0) {
            // A part of another plan is reported as such elsewhere.
            if ExistingTable::open(&path)?.plan != plan.id {
                continue;
            }
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let stem = name.strip_suffix(&end).unwrap_or(&name);
            chain::check(plan, &stored, |table| {
                path.with_file_name(format!("{stem}.{table}.parquet"))
            })?;
        }
    }
    Ok(())
}

/// Lists every column of any part; a column of different kinds becomes text.
fn columns(first: Columns, tables: &[ExistingTable]) -> Vec<(String, ColumnKind)> {
    let mut kinds: BTreeMap<&str, ColumnKind> = BTreeMap::new();
    for (name, kind) in tables.iter().flat_map(|table| &table.columns) {
        let all = kinds.entry(name).or_insert(*kind);
        if *all != *kind {
            *all = ColumnKind::Text;
        }
    }
    ordered(first, &kinds)
}

/// Refuses parts that contain a case with different values.
fn refuse_differing(
    plan: &Plan,
    rows: &BTreeMap<usize, Vec<Row>>,
    tables: &[ExistingTable],
    paths: &[PathBuf],
    columns: &[(String, ColumnKind)],
) -> Result<(), MergeError> {
    let several = |rows: &&Vec<Row>| {
        rows.first().is_some_and(|first| rows.iter().any(|r| r.part != first.part))
    };
    if !rows.values().any(|rows| several(&rows)) {
        return Ok(());
    }
    // The numerics version comes first: if it differs, other differences have no meaning.
    let (before, after): (Vec<_>, Vec<_>) =
        columns.iter().map(|(name, _)| name).partition(|name| *name == NUMERICS);
    for column in before.into_iter().chain(after) {
        let values =
            tables.iter().map(|table| table.column(column)).collect::<Result<Vec<_>, _>>()?;
        let value = |row: &Row| values[row.part].as_ref().and_then(|values| values.at(row.row));
        for (index, rows) in rows.iter().filter(|(_, rows)| several(rows)) {
            // Rows with the same index in different parts are the same row; a part with more rows
            // differs.
            let of = |part: usize| rows.iter().filter(move |row| row.part == part);
            let first = rows[0].part;
            for part in rows.iter().map(|row| row.part).filter(|part| *part != first) {
                let same = of(first).map(value).eq(of(part).map(value));
                if !same && column == NUMERICS {
                    return Err(MergeError::Numerics {
                        case: plan.cases[*index].id.clone(),
                        first: paths[first].clone(),
                        second: paths[part].clone(),
                    });
                }
                if !same {
                    return Err(MergeError::Differs {
                        case: plan.cases[*index].id.clone(),
                        column: column.clone(),
                        first: paths[first].clone(),
                        second: paths[part].clone(),
                    });
                }
            }
        }
    }
    Ok(())
}
