//! System structures as files: SSP 1.0, and the part of SSP 2.0 that FMUs in a fixed-step master
//! need.
//!
//! | module | idea |
//! |---|---|
//! | [`package`] | the folder of a structure: unpacked from an `.ssp`, or a plain folder |
//! | [`structure`] | `SystemStructure.ssd`: systems, components, connectors, connections, bindings |
//! | `connectors` | connectors, and the types of these and of entries of dictionaries |
//! | `dictionary` | signal dictionaries (`.ssb`), inline or in files |
//! | [`parameters`] | parameter sets (`.ssv`) and parameter mappings (`.ssm`), inline or in files |
//! | [`annotation`] | settings of a structure for this program alone |
//! | `warnings` | deviations that are read with a warning |
//! | `xml` | elements and attributes with their lines |
//!
//! The FMUs aren't read here: that is done when the system is [built](super::system).

pub mod annotation;
mod connectors;
mod dictionary;
pub mod package;
pub mod parameters;
mod parts;
pub mod structure;
mod xml;

use std::fmt;

/// Problem in a file of a system structure, with its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SspError {
    /// File, as the user names it.
    pub file: String,
    /// Line, from 1; `None`: the file as a whole.
    pub line: Option<u32>,
    /// Element with its name: `Connection`, `Component "plant"`.
    pub element: String,
    /// Found and expected.
    pub message: String,
}

impl SspError {
    /// Creates an error about a file as a whole.
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
