//! Notes of an import, and requirements that a format can't hold.

use octant_verdict::Requirements;
use std::fmt;

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
    /// Pictures and other files of an archive, which texts refer to.
    pub attachments: Vec<Attachment>,
}

impl Imported {
    /// Number of requirements that could not be read, and are missing.
    #[must_use]
    pub fn skipped(&self) -> usize {
        self.notes.iter().filter(|note| note.skipped).count()
    }
}

/// A file in an archive beside the requirements.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Path in the archive.
    pub name: String,
    /// Content.
    pub bytes: Vec<u8>,
}

/// Part that an import didn't take over unchanged.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Note {
    /// File in an archive or folder; empty if there is only one.
    pub file: String,
    /// Line in the file, from 1; 0 if the note isn't about a line.
    pub line: usize,
    /// Description, in plain words.
    pub message: String,
    /// True if a requirement could not be read, and is missing.
    pub skipped: bool,
}

impl Note {
    pub(crate) fn new(line: usize, message: impl Into<String>) -> Self {
        Self { line, message: message.into(), ..Self::default() }
    }

    pub(crate) fn in_file(self, file: &str) -> Self {
        Self { file: file.to_owned(), ..self }
    }

    pub(crate) fn skipped(self) -> Self {
        Self { skipped: true, ..self }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.file.as_str(), self.line) {
            ("", 0) => {}
            ("", line) => write!(f, "line {line}: ")?,
            (file, 0) => write!(f, "{file}: ")?,
            (file, line) => write!(f, "{file}, line {line}: ")?,
        }
        f.write_str(&self.message)
    }
}

/// Joins names for a message: all of a few, and the number of the others.
pub(crate) fn listed<T: AsRef<str>>(names: &[T]) -> String {
    const SHOWN: usize = 10;
    let shown: Vec<&str> = names.iter().take(SHOWN).map(AsRef::as_ref).collect();
    match names.len().checked_sub(SHOWN) {
        None | Some(0) => shown.join(", "),
        Some(more) => format!("{} and {more} more", shown.join(", ")),
    }
}
