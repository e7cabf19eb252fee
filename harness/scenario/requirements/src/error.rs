//! Notes of an import, and requirements that a format can't hold.

use octant_account::{Account, AccountEntry, Weight};
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
    /// Account of the objects of the document.
    pub account: Account,
}

/// Units of the account of a `requirements.toml`.
const OWN_UNIT: [&str; 2] = ["requirement", "requirements"];

impl Imported {
    /// Requirements of a `requirements.toml`, all of which are used.
    #[must_use]
    pub fn own(requirements: Requirements, file: &str) -> Self {
        let count = requirements.requirements.len() as u64;
        let account = Account::new(file, OWN_UNIT).used(count);
        Self { requirements, notes: Vec::new(), attachments: Vec::new(), account }
    }

    /// True for the requirements of a `requirements.toml`, which is no document of another tool.
    pub(crate) fn is_own(&self) -> bool {
        self.account.unit()[0] == OWN_UNIT[0]
    }

    /// Number of objects that could have been requirements, and could not be read or are missing.
    #[must_use]
    pub fn skipped(&self) -> u64 {
        let of = |(heading, entry): (&str, &AccountEntry)| {
            (entry.weight == Weight::Doubt && matches!(heading, "left out" | "missing"))
                .then_some(entry.count)
        };
        self.account.entries().filter_map(of).sum()
    }

    /// Accounts of this document, and of those that it was converted from.
    #[must_use]
    pub fn accounts(&self) -> Vec<Account> {
        let mut all = self.requirements.accounts.clone();
        all.push(self.account.clone());
        all
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
}

impl Note {
    pub(crate) fn new(line: usize, message: impl Into<String>) -> Self {
        Self { line, message: message.into(), ..Self::default() }
    }

    pub(crate) fn in_file(self, file: &str) -> Self {
        Self { file: file.to_owned(), ..self }
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
