//! `operator.jsonl` in the folder of a run: a record a line, each on the disk before it counts.

use crate::record::{Act, OperatorRecord, SCHEMA};
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Name of the file.
pub const FILE_NAME: &str = "operator.jsonl";

/// A journal that grows. The file is made with the first record.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: Option<File>,
    /// Set by a record that wasn't written whole: none may follow on its line.
    broken: bool,
}

/// Reasons why a journal can't be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The operating system refuses.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// A line is no record.
    #[error("read {path}: line {line}: {problem}")]
    Line {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Found and expected content.
        problem: String,
    },
}

impl Journal {
    /// Makes the journal of a run in this folder.
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        Self { path: folder.join(FILE_NAME), file: None, broken: false }
    }

    /// Adds a record, and returns its line when the disk has it.
    ///
    /// # Errors
    /// If the file can't be written.
    pub fn add(&mut self, record: &OperatorRecord) -> Result<String, JournalError> {
        let path = &self.path;
        let line = serde_json::to_string(record).map_err(io::Error::from);
        let line = line.map_err(|source| refused("write", path, source))?;
        let file = match &mut self.file {
            Some(file) => file,
            none => {
                let opened = OpenOptions::new().append(true).create_new(true).open(path);
                none.insert(opened.map_err(|source| refused("make", path, source))?)
            }
        };
        if self.broken {
            let source = io::Error::other("a record before it wasn't written");
            return Err(refused("write", path, source));
        }
        let written =
            file.write_all(format!("{line}\n").as_bytes()).and_then(|()| file.sync_data());
        self.broken = written.is_err();
        written.map_err(|source| refused("write", path, source))?;
        Ok(line)
    }
}

fn refused(action: &'static str, path: &Path, source: io::Error) -> JournalError {
    JournalError::System { action, path: path.to_owned(), source }
}

/// Reads the records of a run; none where it has no journal. A last line without an end was interrupted.
///
/// # Errors
/// If the file can't be read, or a line is no record of this version.
pub fn read(folder: &Path) -> Result<Vec<OperatorRecord>, JournalError> {
    let path = folder.join(FILE_NAME);
    let read = octant_base::regular::read(&path)
        .and_then(|bytes| String::from_utf8(bytes).map_err(io::Error::other));
    let text = match read {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(source) => return Err(refused("read", &path, source)),
    };
    parse(&text).map_err(|(line, problem)| JournalError::Line { path, line, problem })
}

/// Questions that were asked and not answered, by their records.
#[must_use]
pub fn open(records: &[OperatorRecord]) -> Vec<&OperatorRecord> {
    let mut open: Vec<&OperatorRecord> = Vec::new();
    for record in records {
        match record.act {
            Act::Asked => open.push(record),
            Act::Answered | Act::Unanswered => {
                open.retain(|other| other.step != record.step);
            }
            _ => {}
        }
    }
    open
}

/// Reads the lines of a journal.
///
/// # Errors
/// If a line is no record of this version: its number from 1, and the problem.
pub fn parse(text: &str) -> Result<Vec<OperatorRecord>, (usize, String)> {
    let mut records: Vec<OperatorRecord> = Vec::new();
    let whole = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
    for (index, line) in whole.enumerate() {
        let problem = |problem: String| (index + 1, problem);
        let record: OperatorRecord =
            serde_json::from_str(line).map_err(|error| problem(format!("no record: {error}")))?;
        if record.schema != SCHEMA {
            let found = record.schema;
            return Err(problem(format!("record of schema {found}, this octant reads {SCHEMA}")));
        }
        let expected = index + 1;
        if record.number as usize != expected {
            return Err(problem(format!("found record {}, expected {expected}", record.number)));
        }
        records.push(record);
    }
    Ok(records)
}
