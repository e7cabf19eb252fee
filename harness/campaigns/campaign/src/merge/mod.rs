//! Merges the parts of shards into the same tables, wherever and in whatever order they were run.

pub mod chain;
pub mod factors;
pub mod results;
mod rows;

use super::plan::CasePlaces;
use crate::judge::independence::Shown;
use crate::judge::stop;
use crate::plan::shard::Shard;
use crate::plan::{Plan, short};
use crate::store::facts::row_result;
use crate::table::{
    ColumnCursor, ColumnKind, ColumnValue, ExistingTable, TableError, write_streamed,
};
use octant_account::{Account, AccountEntry};
use octant_base::failing::{Failing, FailureKind};
use octant_statistics::cluster::RowResult;
use octant_verdict::Verdict;
use results::{Columns, NUMERICS, TABLES, ordered};
use rows::{CaseColumn, CaseRows, CaseTable};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Returns the file of a shard's table in the folder of its campaign.
#[must_use]
pub fn part(folder: &Path, shard: Shard, table: &str) -> PathBuf {
    folder.join("parts").join(format!("{}.{table}.parquet", shard.stem()))
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

impl Failing for MergeError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Table(error) => error.kind(),
            Self::Nothing { .. } | Self::Foreign { .. } | Self::Numerics { .. } => {
                FailureKind::Input
            }
            Self::Differs { .. } => FailureKind::Bench,
        }
    }
}

/// Summary of a merge.
#[derive(Clone, Debug, PartialEq)]
pub struct Merged {
    /// Number of parts.
    pub parts: usize,
    /// Cases of the plan with a result.
    pub cases: usize,
    /// Cases of the plan without a result.
    pub missing: usize,
    /// Account of the results in the parts: each is used, or left out.
    pub account: Account,
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

/// Returns the number of cases that count: all, or those up to the point where the stopping rule is
/// satisfied, from the parts in `folders`.
///
/// # Errors
/// If a part can't be read.
pub fn end(plan: &Plan, folders: &[PathBuf]) -> Result<usize, MergeError> {
    let Some(rule) = &plan.stop else { return Ok(plan.cases.len()) };
    let mut all: HashMap<Arc<str>, Shown> = HashMap::new();
    // A case without a summary checked nothing, so it shows nothing.
    for path in parts(folders, "cases") {
        let table = ExistingTable::open(&path)?;
        let [mut cases, mut streams] =
            [texts(&table, &path, "case")?, texts(&table, &path, "stream_hash")?];
        // Parts of older versions have only the verdict of the whole case.
        let mut besides =
            texts(&table, &path, "besides").or_else(|_| texts(&table, &path, "verdict"))?;
        for _ in 0..table.rows {
            let (case, stream) = (text(&mut cases)?, text(&mut streams)?);
            let besides = named(text(&mut besides)?.as_deref());
            let result = row_result(Verdict::Pass, besides);
            let Some(case) = case else { continue };
            let stream = stream.map(|stream| stream.to_string());
            all.insert(case, Shown { result, stream });
        }
    }
    let mut checked: HashSet<Arc<str>> = HashSet::new();
    for path in parts(folders, "checks") {
        let table = ExistingTable::open(&path)?;
        let (mut cases, mut ids) =
            (texts(&table, &path, "case")?, texts(&table, &path, "requirement")?);
        let mut verdicts = texts(&table, &path, "verdict")?;
        for _ in 0..table.rows {
            let (case, id, verdict) = (text(&mut cases)?, text(&mut ids)?, text(&mut verdicts)?);
            if let (Some(case), Some(id)) = (case, id)
                && *id == *rule.requirement
            {
                if let Some(shown) = all.get_mut(&case) {
                    let check = row_result(named(verdict.as_deref()), Verdict::Pass);
                    shown.result = shown.result.max(check);
                }
                checked.insert(case);
            }
        }
    }
    let decision = stop::decide(plan, rule, |case| {
        let mut shown = all.get(case.id.as_str())?.clone();
        if !checked.contains(case.id.as_str()) {
            shown.result = shown.result.max(RowResult::Unknown);
        }
        Some(shown)
    });
    Ok(decision.end(plan.cases.len()))
}

/// Returns the verdict of a name; an error where there is none.
fn named(name: Option<&str>) -> Verdict {
    Verdict::ALL.into_iter().find(|verdict| Some(verdict.name()) == name).unwrap_or(Verdict::Error)
}

/// Opens a text column of a part.
fn texts(table: &ExistingTable, path: &Path, name: &str) -> Result<ColumnCursor, TableError> {
    let is_text = table.columns.contains(&(name.to_owned(), ColumnKind::Text));
    match table.cursor(name)?.filter(|_| is_text) {
        Some(cursor) => Ok(cursor),
        None => Err(TableError::Form {
            path: path.to_owned(),
            reason: format!("it has no texts in a column {name}"),
        }),
    }
}

/// Reads the next text of a column.
fn text(cursor: &mut ColumnCursor) -> Result<Option<Arc<str>>, TableError> {
    Ok(match cursor.next()? {
        Some(ColumnValue::Text(text)) => Some(text),
        _ => None,
    })
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
    let place = CasePlaces::of(plan);
    let account = Account::new("results of the parts", ["result", "results"]);
    let mut merged_cases = Merged { parts: 0, cases: 0, missing: 0, account };
    for (name, first) in TABLES {
        let paths = parts(folders, name);
        if paths.is_empty() {
            let folder = folders.first().cloned().unwrap_or_default();
            return Err(MergeError::Nothing { folder });
        }
        let mut tables = Vec::with_capacity(paths.len());
        for path in &paths {
            let table = ExistingTable::open(path)?;
            if table.plan != plan.id {
                return Err(MergeError::Foreign {
                    path: path.clone(),
                    found: short(&table.plan).to_owned(),
                    expected: short(&plan.id).to_owned(),
                });
            }
            tables.push(CaseTable::of(path, table, &place)?);
        }
        let rows = Merging::of(&tables);
        let columns = columns(first, &tables);
        rows.refuse_differing(plan, &tables, &columns)?;
        let counts = rows.counts(end);
        // If several parts contain a case, the rows of the first are used.
        let kept = rows.kept(end);
        // A column whose cases don't count is left out.
        let mut columns = columns;
        if end < plan.cases.len() {
            let first = |name: &String| first.iter().any(|(other, _)| other == name);
            let mut there = Vec::with_capacity(columns.len());
            for (column, kind) in columns {
                if first(&column) || has_value(&tables, &kept, &column)? {
                    there.push((column, kind));
                }
            }
            columns = there;
        }
        if name == "cases" {
            let cases = kept.iter().map(|kept| kept.rows.count()).sum();
            let missing = end.min(plan.cases.len()).saturating_sub(cases);
            let account = merged_cases.account;
            let account = counts.into_account(account, paths.len(), missing as u64);
            merged_cases = Merged { parts: paths.len(), cases, missing, account };
        }
        let mut units = BTreeMap::new();
        tables.iter().for_each(|table| units.extend(table.table.units.clone()));
        // A part that is older than units makes the column text.
        units.retain(|name, _| columns.contains(&(name.clone(), ColumnKind::Number)));
        write_streamed(&merged(out, name), &plan.id, &columns, &units, |index| {
            let mut of_parts = of_parts(&tables, &columns[index].0)?;
            let rows =
                kept.iter().flat_map(|kept| kept.rows.each().map(move |row| (kept.part(), row)));
            Ok(rows.map(move |(part, row)| of_parts[part].at(row)))
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

/// Opens a column of every part.
fn of_parts(tables: &[CaseTable], column: &str) -> Result<Vec<CaseColumn>, TableError> {
    tables.iter().map(|table| table.values(column)).collect()
}

/// Returns whether any of the rows that are kept has a value in a column.
fn has_value(tables: &[CaseTable], kept: &[Rows], column: &str) -> Result<bool, TableError> {
    let mut of_parts = of_parts(tables, column)?;
    for kept in kept {
        for row in kept.rows.each() {
            if of_parts[kept.part()].at(row)?.is_some() {
                return Ok(true);
            }
        }
    }
    Ok(false)
}

/// Lists every column of any part; a column of different kinds becomes text.
fn columns(first: Columns, tables: &[CaseTable]) -> Vec<(String, ColumnKind)> {
    let mut kinds: BTreeMap<&str, ColumnKind> = BTreeMap::new();
    for (name, kind) in tables.iter().flat_map(|table| &table.table.columns) {
        let all = kinds.entry(name).or_insert(*kind);
        if *all != *kind {
            *all = ColumnKind::Text;
        }
    }
    ordered(first, &kinds)
}

/// Rows of a case in a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Rows {
    part: u32,
    rows: CaseRows,
}

impl Rows {
    fn part(&self) -> usize {
        self.part as usize
    }
}

/// Rows of the table of cases, by what becomes of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct RowCounts {
    used: u64,
    again: u64,
    after: u64,
}

impl RowCounts {
    fn into_account(self, account: Account, parts: usize, missing: u64) -> Account {
        let Self { used, again, after } = self;
        let again =
            AccountEntry::new(again, "results that another part has too, with equal values");
        account
            .used(used)
            .left_out(again)
            .left_out(AccountEntry::new(
                after,
                "results after the point at which the campaign stopped",
            ))
            .missing(AccountEntry::new(missing, "results of cases of the plan"))
            .note(AccountEntry::new(parts as u64, "parts"))
    }
}

/// Rows of all parts, by case in the order of the plan and by part.
struct Merging(Vec<Rows>);

impl Merging {
    fn of(tables: &[CaseTable]) -> Self {
        let mut all = Vec::with_capacity(tables.iter().map(|table| table.runs.len()).sum());
        for (part, table) in (0..).zip(tables) {
            all.extend(table.runs.iter().map(|rows| Rows { part, rows: *rows }));
        }
        all.sort_unstable_by_key(|rows| (rows.rows.case(), rows.part, rows.rows));
        Self(all)
    }

    /// Returns the rows of each case.
    fn cases(&self) -> impl Iterator<Item = &[Rows]> {
        self.0.chunk_by(|a, b| a.rows.case() == b.rows.case())
    }

    /// Counts the rows by what becomes of them.
    fn counts(&self, end: usize) -> RowCounts {
        let mut counts = RowCounts::default();
        for of_case in self.cases() {
            let first = of_case.first().map(|rows| rows.part);
            for rows in of_case {
                let to = if rows.rows.case() >= end {
                    &mut counts.after
                } else if Some(rows.part) == first {
                    &mut counts.used
                } else {
                    &mut counts.again
                };
                *to += rows.rows.count() as u64;
            }
        }
        counts
    }

    /// Returns the rows that count: of a case in several parts those of the first.
    fn kept(mut self, end: usize) -> Vec<Rows> {
        let mut last = None;
        self.0.retain(|rows| {
            let case = rows.rows.case();
            let first = last.filter(|(of, _)| *of == case).map_or(rows.part, |(_, first)| first);
            last = Some((case, first));
            case < end && rows.part == first
        });
        self.0
    }

    /// Refuses parts that contain a case with different values.
    fn refuse_differing(
        &self,
        plan: &Plan,
        tables: &[CaseTable],
        columns: &[(String, ColumnKind)],
    ) -> Result<(), MergeError> {
        let several = |rows: &&[Rows]| {
            rows.first().is_some_and(|first| rows.iter().any(|rows| rows.part != first.part))
        };
        if !self.cases().any(|rows| several(&rows)) {
            return Ok(());
        }
        // The numerics version comes first: if it differs, other differences have no meaning.
        let (before, after): (Vec<_>, Vec<_>) =
            columns.iter().map(|(name, _)| name).partition(|name| *name == NUMERICS);
        for column in before.into_iter().chain(after) {
            let mut of_parts = of_parts(tables, column)?;
            for rows in self.cases().filter(several) {
                // Rows with the same index in different parts are the same row; a part with more rows
                // differs.
                let mut first: Option<(usize, Vec<Option<ColumnValue>>)> = None;
                for of_part in rows.chunk_by(|a, b| a.part == b.part) {
                    let Some(part) = of_part.first().map(Rows::part) else { continue };
                    let places = of_part.iter().flat_map(|rows| rows.rows.each());
                    let values =
                        places
                            .map(|row| of_parts[part].at(row))
                            .collect::<Result<Vec<_>, TableError>>()?;
                    let Some((of_first, expected)) = &first else {
                        first = Some((part, values));
                        continue;
                    };
                    if *expected == values {
                        continue;
                    }
                    let case = of_part.first().map_or(0, |rows| rows.rows.case());
                    let case = plan.cases[case].id.to_string();
                    let [first, second] = [*of_first, part].map(|part| tables[part].path.clone());
                    return Err(if column == NUMERICS {
                        MergeError::Numerics { case, first, second }
                    } else {
                        MergeError::Differs { case, column: column.clone(), first, second }
                    });
                }
            }
        }
        Ok(())
    }
}
