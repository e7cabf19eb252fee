//! What is wrong with a file of requirements, and where; what an import left out.

use crate::requirement::Requirements;
use std::fmt;

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Line in the file, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The field, `requirements.NAV-1.limit`; empty where it isn't in one.
    pub path: String,
    /// What was found and what was expected.
    pub message: String,
}

impl Problem {
    pub(crate) fn new(
        (line, column): (usize, usize),
        path: impl Into<String>,
        message: impl Into<String>,
    ) -> Self {
        Self { line, column, path: path.into(), message: message.into() }
    }
}

/// Why a file of requirements can't be used: at least one problem, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RequirementsError {
    /// Name of the file.
    pub file: String,
    /// The problems.
    pub problems: Vec<Problem>,
}

impl RequirementsError {
    pub(crate) fn one(file: &str, problem: Problem) -> Self {
        Self { file: file.to_owned(), problems: vec![problem] }
    }
}

impl fmt::Display for RequirementsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            write!(f, "{}:{}:{}: ", self.file, problem.line, problem.column)?;
            if !problem.path.is_empty() {
                write!(f, "{}: ", problem.path)?;
            }
            f.write_str(&problem.message)?;
        }
        Ok(())
    }
}

impl std::error::Error for RequirementsError {}

/// Why requirements can't be written in a format: a requirement has what it has no place for.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("failed to write {format}: requirement {id}: {message}")]
pub struct ExportError {
    /// The format.
    pub format: &'static str,
    /// The requirement; `(all)` where it isn't one alone.
    pub id: String,
    /// What has no place.
    pub message: String,
}

/// Requirements from a file of another tool, and what of it has no place here.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The requirements.
    pub requirements: Requirements,
    /// What was left out, or has to be completed by hand, with its line.
    pub notes: Vec<Note>,
}

/// Something that an import didn't take over as it stood.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Line in the file, from 1.
    pub line: usize,
    /// What, in plain words.
    pub message: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

/// `did you mean X?` and the list of what is known.
pub(crate) fn suggestion(found: &str, known: &[&str]) -> String {
    let list = known.join(", ");
    let nearest = known
        .iter()
        .map(|name| (strsim::jaro_winkler(found, name), name))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0));
    match nearest {
        Some((_, name)) => format!("did you mean \"{name}\"? known: {list}"),
        None => format!("known: {list}"),
    }
}
