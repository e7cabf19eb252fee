//! Problems of a file of requirements, with their places.

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
    /// A problem at a line and column.
    pub fn new(
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
    /// Error of a file with one problem.
    pub fn one(file: &str, problem: RequirementsProblem) -> Self {
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
