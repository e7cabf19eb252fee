//! System structures as files: SSP 1.0, and of SSP 2.0 what FMUs in a fixed-step master need.
//!
//! | module | idea |
//! |---|---|
//! | [`package`] | the folder of a structure: unpacked from an `.ssp`, or as it lies |
//! | [`structure`] | `SystemStructure.ssd`: systems, components, connectors, connections, bindings |
//! | [`parameters`] | parameter sets (`.ssv`) and parameter mappings (`.ssm`), inline or in files |
//! | [`annotation`] | what a structure says to this program alone |
//! | `xml` | elements and attributes with their lines |
//!
//! Nothing is looked up in an FMU here: that is done when the system is
//! [built](super::system).

pub mod annotation;
pub mod package;
pub mod parameters;
pub mod structure;
mod xml;

use std::fmt;

/// What is wrong with a file of a system structure, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SspError {
    /// The file, as the user names it.
    pub file: String,
    /// Its line, from 1; `None`: the file as a whole.
    pub line: Option<u32>,
    /// The element, with the name that it has: `Connection`, `Component "plant"`.
    pub element: String,
    /// What was found and what is expected.
    pub message: String,
}

impl SspError {
    /// About a file as a whole.
    pub(crate) fn of_file(file: &str, message: impl Into<String>) -> Self {
        Self { file: file.to_owned(), line: None, element: String::new(), message: message.into() }
    }
}

impl fmt::Display for SspError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if !self.element.is_empty() {
            write!(f, ": {}", self.element)?;
        }
        write!(f, ": {}", self.message)
    }
}

impl std::error::Error for SspError {}

#[cfg(test)]
mod tests;
