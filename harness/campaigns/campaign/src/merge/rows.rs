//! Rows of a table by the cases that they belong to, read column by column.

use crate::plan::CasePlaces;
use crate::table::{ColumnCursor, ColumnValue, ColumnValues, ExistingTable, TableError};
use std::path::{Path, PathBuf};

/// Rows of a case that follow one another, in few bytes: a table can have those of millions of cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct CaseRows {
    /// Place of the case in the plan, which has at most ten million cases.
    case: u32,
    /// First row.
    start: u64,
    /// Number of rows. More than fit follow as rows of the same case.
    rows: u32,
}

impl CaseRows {
    /// Returns the place of the case in the plan.
    pub(crate) fn case(self) -> usize {
        self.case as usize
    }

    /// Returns the number of rows.
    pub(crate) fn count(self) -> usize {
        self.rows as usize
    }

    /// Returns each of the rows.
    pub(crate) fn each(self) -> std::ops::Range<usize> {
        let start = usize::try_from(self.start).unwrap_or(usize::MAX);
        start..start.saturating_add(self.count())
    }
}

/// A table, and where the rows of each case are.
#[derive(Debug)]
pub(crate) struct CaseTable {
    pub(crate) path: PathBuf,
    pub(crate) table: ExistingTable,
    /// Rows in the order of the plan.
    pub(crate) runs: Vec<CaseRows>,
    /// True if the rows are in this order too: each is read once, and none has to be kept.
    is_in_order: bool,
}

impl CaseTable {
    /// Opens a table. `place` are the cases of the plan by their ids.
    pub(crate) fn open(path: &Path, place: &CasePlaces<'_>) -> Result<Self, TableError> {
        Self::of(path, ExistingTable::open(path)?, place)
    }

    /// Finds the rows of each case in a table.
    pub(crate) fn of(
        path: &Path,
        table: ExistingTable,
        place: &CasePlaces<'_>,
    ) -> Result<Self, TableError> {
        let form = |reason: String| TableError::Form { path: path.to_owned(), reason };
        let Some(mut cases) = table.cursor("case")? else {
            return Err(form("it has no column case".to_owned()));
        };
        let mut runs: Vec<CaseRows> = Vec::new();
        for row in 0..table.rows {
            let id = match cases.next()? {
                Some(ColumnValue::Text(id)) => Some(id),
                Some(_) => return Err(form("it has no column case".to_owned())),
                None => None,
            };
            let id = id.as_deref().unwrap_or("");
            let case = place.get(id);
            let case = case.ok_or_else(|| form(format!("the plan has no case {id}")))?;
            let case = u32::try_from(case).unwrap_or(u32::MAX);
            match runs.last_mut() {
                Some(run) if run.case == case && run.rows < u32::MAX => run.rows += 1,
                _ => runs.push(CaseRows { case, start: row as u64, rows: 1 }),
            }
        }
        let is_in_order = runs.is_sorted();
        runs.sort_unstable();
        Ok(Self { path: path.to_owned(), table, runs, is_in_order })
    }

    /// Returns the cases that have rows, in the order of the plan.
    pub(crate) fn cases(&self) -> impl Iterator<Item = usize> {
        self.runs.chunk_by(|a, b| a.case == b.case).filter_map(|runs| Some(runs.first()?.case()))
    }

    /// Returns the rows of a case.
    pub(crate) fn rows(&self, case: usize) -> &[CaseRows] {
        let from = self.runs.partition_point(|run| run.case() < case);
        let to = self.runs.partition_point(|run| run.case() <= case);
        &self.runs[from..to]
    }

    /// Number of rows of a case.
    pub(crate) fn count(&self, case: usize) -> usize {
        self.rows(case).iter().map(|run| run.count()).sum()
    }

    /// Returns the values of a column; all are null if there is no such column.
    pub(crate) fn values(&self, column: &str) -> Result<CaseColumn, TableError> {
        Ok(if self.is_in_order {
            self.table
                .cursor(column)?
                .map(Box::new)
                .map_or(CaseColumn::Missing, |cursor| CaseColumn::InOrder { cursor, next: 0 })
        } else {
            self.table.column(column)?.map_or(CaseColumn::Missing, CaseColumn::Whole)
        })
    }
}

/// Values of a column, of which rows are read in the order of the plan.
pub(crate) enum CaseColumn {
    /// The rows are in that order.
    InOrder { cursor: Box<ColumnCursor>, next: usize },
    /// The rows are in another order.
    Whole(ColumnValues),
    /// Column that the table lacks.
    Missing,
}

impl CaseColumn {
    /// Returns the value of a row, which comes after all that were read before.
    pub(crate) fn at(&mut self, row: usize) -> Result<Option<ColumnValue>, TableError> {
        match self {
            Self::Missing => Ok(None),
            Self::Whole(values) => Ok(values.at(row)),
            Self::InOrder { cursor, next } => {
                cursor.skip(row.saturating_sub(*next))?;
                *next = row + 1;
                cursor.next()
            }
        }
    }
}
