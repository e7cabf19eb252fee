//! What is wrong with a scenario, and where.

use std::fmt;

/// Where a value was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the file, from 1.
    File {
        /// Line.
        line: usize,
        /// Column, in characters.
        column: usize,
    },
    /// In the argument of a `--set`.
    Argument(String),
    /// In the argument of a `--fire`.
    Fire(String),
    /// The file as a whole: it can't be read.
    Unread,
    /// Nowhere: the default of a key that the scenario leaves out.
    Default,
}

/// One thing that is wrong with a scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Where.
    pub place: Place,
    /// Dotted path of the field, `procedure.calibration.duration`; empty at the root.
    pub path: String,
    /// What was found and what was expected.
    pub message: String,
}

/// Why a scenario can't be run: every problem that was found, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScenarioError {
    /// Name of the file.
    pub file: String,
    /// The problems, at least one.
    pub problems: Vec<Problem>,
}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            match &problem.place {
                Place::File { line, column } => write!(f, "{}:{line}:{column}: ", self.file)?,
                Place::Argument(argument) => write!(f, "--set {argument}: ")?,
                Place::Fire(argument) => write!(f, "--fire {argument}: ")?,
                Place::Unread => write!(f, "failed to read {}: ", self.file)?,
                Place::Default => write!(f, "{}: ", self.file)?,
            }
            if !problem.path.is_empty() {
                write!(f, "{}: ", problem.path)?;
            }
            f.write_str(&problem.message)?;
        }
        Ok(())
    }
}

impl std::error::Error for ScenarioError {}
