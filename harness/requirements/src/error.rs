//! Problems of a file of requirements, with their places, and notes of an import.

use crate::requirement::Requirements;
use std::fmt;

/// One problem.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RequirementsProblem {
    /// Line in the file, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Path of the field, `requirements.NAV-1.limit`; empty if the problem isn't in a field.
    pub path: String,
    /// Value found and value expected.
    pub message: String,
}

impl RequirementsProblem {
    pub(crate) fn new(
        (line, column): (usize, usize),
        path: impl Into<String>,
        message: impl Into<String>,
    ) -> Self {
        Self { line, column, path: path.into(), message: message.into() }
    }
}

/// Error of a file of requirements: at least one problem, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RequirementsError {
    /// Name of the file.
    pub file: String,
    /// The problems.
    pub problems: Vec<RequirementsProblem>,
}

impl RequirementsError {
    pub(crate) fn one(file: &str, problem: RequirementsProblem) -> Self {
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

/// Error of requirements that a format can't hold.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("failed to write {format}: requirement {id}: {message}")]
pub struct ExportError {
    /// The format.
    pub format: &'static str,
    /// Id of the requirement; `(all)` if it isn't a single one.
    pub id: String,
    /// Part that the format can't hold.
    pub message: String,
}

/// Requirements from a file of another tool, with notes on the parts that were not taken over.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The requirements.
    pub requirements: Requirements,
    /// Parts that were left out, or have to be completed by hand, with their lines.
    pub notes: Vec<Note>,
}

/// Part that an import didn't take over unchanged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Line in the file, from 1.
    pub line: usize,
    /// Description, in plain words.
    pub message: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: {}", self.line, self.message)
    }
}

/// Text `did you mean "X"?`, if a name is similar, with the list of known names.
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
