//! A recorded reference in columns of a text file.

use super::SourceError;
use super::rows::Rows;
use octant_scenario::recorded::TimeUnit;
use octant_scenario::reference::ReferenceColumns;
use std::path::Path;

/// Streams the rows that have a reference.
pub(super) struct ReferenceText {
    rows: Rows,
    /// Indices of the three numbers.
    columns: [usize; 3],
    names: [&'static str; 3],
    time: Option<(usize, TimeUnit)>,
    row_period_ns: u64,
    /// Rows so far, with and without a reference, and those without.
    count: u64,
    empty: u64,
}

impl ReferenceText {
    /// Opens the file of a reference, whose name is expanded to `path`.
    pub(super) fn open(
        path: &Path,
        reference: &ReferenceColumns,
        names: [&'static str; 3],
    ) -> Result<Self, SourceError> {
        let ReferenceColumns { delimiter, comment, skip_lines, header, .. } = reference;
        let rows = Rows::open(path, *delimiter, comment, *skip_lines, *header)?;
        let [first, second, third] = &reference.columns;
        let columns = [rows.column(first)?, rows.column(second)?, rows.column(third)?];
        let time = match &reference.time {
            Some(time) => Some((rows.column(&time.column)?, time.unit)),
            None => None,
        };
        Ok(Self {
            rows,
            columns,
            names,
            time,
            row_period_ns: reference.row_period_ns,
            count: 0,
            empty: 0,
        })
    }

    /// Returns stamp, ns, and numbers of the next reference; `None` at the end. Rows whose three
    /// fields are empty have none.
    pub(super) fn next(&mut self) -> Result<Option<(u64, [f64; 3])>, SourceError> {
        while self.rows.advance()? {
            self.count += 1;
            let mut empty = [false; 3];
            for (empty, index) in empty.iter_mut().zip(self.columns) {
                *empty = self.rows.field(index)?.is_empty();
            }
            if empty == [true; 3] {
                self.empty += 1;
                continue;
            }
            if let Some(missing) = empty.iter().position(|empty| *empty) {
                return Err(self.rows.column_error(
                    self.columns[missing],
                    format!(
                        "found no {} beside the others of the reference, expected all three or none",
                        self.names[missing]
                    ),
                ));
            }
            let mut values = [0.0; 3];
            for (value, index) in values.iter_mut().zip(self.columns) {
                *value = self.rows.number(index)?;
            }
            let stamp_ns = match self.time {
                Some((index, unit)) => self.rows.time_ns(index, unit)?,
                None => self.count.saturating_mul(self.row_period_ns),
            };
            return Ok(Some((stamp_ns, values)));
        }
        Ok(None)
    }

    /// The file.
    pub(super) fn path(&self) -> &str {
        self.rows.path()
    }

    /// Number of rows so far without a reference.
    pub(super) const fn empty(&self) -> u64 {
        self.empty
    }

    /// Makes an error of the last row.
    pub(super) fn error(&self, reason: String) -> SourceError {
        self.rows.error(reason)
    }

    /// Makes an error of the file as a whole.
    pub(super) fn error_of_file(&self, reason: String) -> SourceError {
        SourceError::Read { path: self.rows.path().to_owned(), reason }
    }
}
