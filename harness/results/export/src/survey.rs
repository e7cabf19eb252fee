//! First reading of a recording: how many rows each table has, and which of its columns have values.

use super::columns::columns;
use super::error::ExportFailure;
use super::rows::{Choice, ReadToEnd, each_row};
use super::table::{Cell, Column, Table};

/// Column as the recording fills it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SurveyedColumn {
    /// The column.
    pub column: Column,
    /// Place among the cells of a row.
    pub place: usize,
    /// Number of cells with a value.
    pub filled: u64,
    /// Sum of the texts' lengths in UTF-16 units, each rounded up to a multiple of four.
    pub text_units: u64,
}

/// Table as the recording fills it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SurveyedTable {
    /// The table.
    pub table: Table,
    /// Number of rows.
    pub rows: u64,
    /// Columns that have a value in some row; all of them in a table without rows.
    pub columns: Vec<SurveyedColumn>,
    /// Names of the columns that have none.
    pub left_out: Vec<String>,
}

/// What there is to export.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Survey {
    /// Chosen tables that have rows.
    pub tables: Vec<SurveyedTable>,
    /// Chosen tables that have none.
    pub empty: Vec<Table>,
    /// State at the end of reading.
    pub end: ReadToEnd,
}

impl Survey {
    /// Reads a recording.
    ///
    /// # Errors
    /// If it can't be read.
    pub fn of(choice: &Choice) -> Result<Self, ExportFailure> {
        let mut tables: Vec<SurveyedTable> = choice.tables.iter().map(|t| unread(*t)).collect();
        let end = each_row(choice, &mut |table, cells| {
            if let Some(found) = tables.iter_mut().find(|found| found.table == table) {
                found.count(cells);
            }
            Ok(())
        })?;
        let (mut there, empty): (Vec<_>, Vec<_>) =
            tables.into_iter().partition(|table| table.rows > 0);
        for table in &mut there {
            let (columns, without): (Vec<_>, Vec<_>) =
                std::mem::take(&mut table.columns).into_iter().partition(|c| c.filled > 0);
            table.columns = columns;
            table.left_out = without.into_iter().map(|without| without.column.name).collect();
        }
        Ok(Self { tables: there, empty: empty.iter().map(|table| table.table).collect(), end })
    }

    /// Table as it was found.
    #[must_use]
    pub fn table(&self, table: Table) -> Option<&SurveyedTable> {
        self.tables.iter().find(|found| found.table == table)
    }

    /// Sentences about what the export doesn't have, for the user.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if self.end.is_truncated {
            notes.push(format!(
                "the recording is truncated after {:.3} s; the part before that is exported",
                self.end.last_ns as f64 / 1e9
            ));
        }
        for table in &self.tables {
            let has_truth = |name: &String| name.starts_with("true_") || name.contains("_error_");
            let (truth, others): (Vec<_>, Vec<_>) =
                table.left_out.iter().partition(|n| has_truth(n));
            let name = table.table.name();
            if table.table == Table::Navigation && !truth.is_empty() {
                notes.push(format!(
                    "{name}: the recording has no truth, columns of truth and errors are left out"
                ));
            }
            let is_error = |name: &&String| name.starts_with("error_");
            let is_sigma = |name: &&String| name.starts_with("sigma_");
            let is_clean = |name: &&String| name.starts_with("clean_");
            for (is, what) in [
                (
                    &is_error as &dyn Fn(&&String) -> bool,
                    "errors, because the true values are unknown",
                ),
                (&is_sigma, "σ of parameters that aren't estimated"),
                (&is_clean, "samples of the source, because all reached the core as they were"),
            ] {
                let count = others.iter().filter(|name| is(name)).count();
                if count > 0 {
                    notes.push(format!("{name}: without {count} columns of {what}"));
                }
            }
            let rest: Vec<&str> = others
                .iter()
                .filter(|name| !is_error(name) && !is_sigma(name) && !is_clean(name))
                .map(|name| name.as_str())
                .collect();
            if !rest.is_empty() {
                notes.push(format!("{name}: no values for {}, left out", rest.join(", ")));
            }
        }
        for table in &self.empty {
            notes.push(format!("{}: the recording has no rows for it, left out", table.name()));
        }
        notes
    }
}

fn unread(table: Table) -> SurveyedTable {
    let column = |(place, column)| SurveyedColumn { column, place, filled: 0, text_units: 0 };
    let columns = columns(table).into_iter().enumerate().map(column).collect();
    SurveyedTable { table, rows: 0, columns, left_out: Vec::new() }
}

impl SurveyedTable {
    fn count(&mut self, cells: &[Cell]) {
        debug_assert_eq!(cells.len(), self.columns.len(), "{}", self.table.name());
        self.rows += 1;
        for (column, cell) in self.columns.iter_mut().zip(cells) {
            column.filled += u64::from(*cell != Cell::Empty);
            if let Cell::Text(text) = cell {
                column.text_units += (text.encode_utf16().count() as u64).next_multiple_of(4);
            }
        }
    }
}
