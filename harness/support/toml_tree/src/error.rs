//! Problems of a file of TOML, with their places.

use std::fmt;
use std::path::Path;

/// Place of a value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// Position in the file, from 1.
    File {
        /// Line.
        line: usize,
        /// Column, in characters.
        column: usize,
    },
    /// Argument of a command line, behind its option.
    Argument(String),
    /// The file as a whole, which can't be read.
    Unread,
    /// No place: the default of a key that the file omits.
    Default,
}

/// One problem of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Place.
    pub place: Place,
    /// Dotted path of the field, `procedure.calibration.duration`; empty at the root.
    pub path: String,
    /// Value found and value expected.
    pub message: String,
}

/// Error of a file that can't be used: all problems found, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileProblems {
    /// Name of the file.
    pub file: String,
    /// The problems, at least one.
    pub problems: Vec<Problem>,
}

impl FileProblems {
    /// Reads the text of a file.
    ///
    /// # Errors
    /// If it can't be read.
    pub fn text_of(path: &Path) -> Result<String, Self> {
        std::fs::read_to_string(path).map_err(|error| Self {
            file: path.display().to_string(),
            problems: vec![Problem {
                place: Place::Unread,
                path: String::new(),
                message: error.to_string(),
            }],
        })
    }
}

impl fmt::Display for FileProblems {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            match &problem.place {
                Place::File { line, column } => write!(f, "{}:{line}:{column}: ", self.file)?,
                Place::Argument(argument) => write!(f, "{argument}: ")?,
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

impl std::error::Error for FileProblems {}
