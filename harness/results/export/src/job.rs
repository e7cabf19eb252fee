//! One export: its recording as surveyed, its place, and the second reading that fills the files.

use super::error::ExportFailure;
use super::rows::{Choice, each_row};
use super::survey::{Survey, SurveyedTable};
use super::table::Cell;
use octant_base::whole_file::new_file;
use octant_recorder::reader::{Info, Recording};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Version of the exported files' layout: tables, names of columns and their units.
pub const EXPORT_VERSION: u32 = 1;

/// Takes a row of the table with an index.
pub(crate) type TakesIndexedRow<'a> = dyn FnMut(usize, &[Cell]) -> Result<(), ExportFailure> + 'a;

/// One export.
pub(crate) struct Job<'a> {
    pub(crate) choice: &'a Choice,
    pub(crate) survey: Survey,
    /// Head of the recording.
    pub(crate) info: Info,
    /// File, or folder of files.
    pub(crate) out: &'a Path,
    /// True if existing files are replaced.
    pub(crate) force: bool,
}

impl<'a> Job<'a> {
    /// Surveys the recording.
    pub(crate) fn new(
        choice: &'a Choice,
        out: &'a Path,
        force: bool,
    ) -> Result<Self, ExportFailure> {
        let recording = Recording::open(&choice.recording).map_err(|source| {
            ExportFailure::Recording { path: choice.recording.clone(), source }
        })?;
        let info = recording.info().clone();
        drop(recording);
        Ok(Self { choice, survey: Survey::of(choice)?, info, out, force })
    }

    /// Passes on the rows of the surveyed tables with the table's index. A recording that has grown since the survey
    /// gives no more rows than were counted.
    pub(crate) fn rows(&self, take: &mut TakesIndexedRow<'_>) -> Result<(), ExportFailure> {
        let mut given = vec![0u64; self.survey.tables.len()];
        each_row(self.choice, &mut |table, cells| {
            let found = self.survey.tables.iter().position(|known| known.table == table);
            let Some(index) = found else { return Ok(()) };
            if given[index] == self.survey.tables[index].rows {
                return Ok(());
            }
            given[index] += 1;
            take(index, cells)
        })
        .map(|_| ())
    }

    /// Description of the export as JSON: version, origin, tables with their columns and units.
    pub(crate) fn about(&self) -> Value {
        let tables = self.survey.tables.iter().map(|table| {
            json!({
                "table": table.table.name(),
                "rows": table.rows,
                "columns": columns_json(table),
            })
        });
        json!({
            "version": EXPORT_VERSION,
            "octant": env!("CARGO_PKG_VERSION"),
            "recording": {
                "file": self.choice.recording.file_name().map(|name| name.to_string_lossy()),
                "octant": self.info.octant,
                "samples": self.info.samples.name(),
                "run": self.info.run,
                "truncated": self.survey.end.is_truncated,
            },
            "every_s": self.choice.every_ns.map(|period_ns| period_ns as f64 / 1e9),
            "tables": tables.collect::<Vec<_>>(),
        })
    }
}

/// Columns of a table as JSON: name, unit, type, description.
pub(crate) fn columns_json(table: &SurveyedTable) -> Value {
    table.columns.iter().map(|found| json!(found.column)).collect()
}

/// File that gets its name when it is complete.
pub(crate) struct NewFile {
    path: PathBuf,
    new: tempfile::NamedTempFile,
    force: bool,
}

impl NewFile {
    /// Creates the file, and its folder.
    pub(crate) fn create(path: &Path, force: bool) -> Result<Self, ExportFailure> {
        let in_the_way = || ExportFailure::InTheWay { path: path.to_owned() };
        let there = std::fs::symlink_metadata(path).ok();
        if there.as_ref().is_some_and(|there| !force || !there.is_file()) {
            return Err(in_the_way());
        }
        let system = |source| ExportFailure::System { path: path.to_owned(), source };
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        std::fs::create_dir_all(folder).map_err(system)?;
        let new = new_file(folder).map_err(system)?;
        Ok(Self { path: path.to_owned(), new, force })
    }

    /// Handle to write with.
    pub(crate) fn file(&self) -> Result<std::fs::File, ExportFailure> {
        self.new.as_file().try_clone().map_err(|source| self.system(source))
    }

    /// Failure of the operating system at this file.
    pub(crate) fn system(&self, source: std::io::Error) -> ExportFailure {
        ExportFailure::System { path: self.path.clone(), source }
    }

    /// Failure of a format's library at this file.
    pub(crate) fn format(&self, reason: impl std::fmt::Display) -> ExportFailure {
        ExportFailure::Format { path: self.path.clone(), reason: reason.to_string() }
    }

    /// Gives the complete file its name.
    pub(crate) fn finish(self) -> Result<PathBuf, ExportFailure> {
        let Self { path, new, force } = self;
        let kept = if force { new.persist(&path) } else { new.persist_noclobber(&path) };
        match kept {
            Ok(_) => Ok(path),
            Err(error) if error.error.kind() == std::io::ErrorKind::AlreadyExists => {
                Err(ExportFailure::InTheWay { path })
            }
            Err(error) => Err(ExportFailure::System { path, source: error.error }),
        }
    }
}
