//! Results as the index knows them: where each is, and what tells it from others.

use crate::execute::case::ResultError;
use crate::plan::case_id::CaseId;
use std::cmp::Ordering;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// A stored result.
#[derive(Clone, Debug)]
pub(super) enum Stored {
    /// A file of its own.
    File(Box<StoredFile>),
    /// A record of a part.
    Record(StoredRecord),
}

/// A result in a file of its own.
#[derive(Clone, Debug)]
pub(super) struct StoredFile {
    pub(super) path: PathBuf,
    /// True if its name says that it differs from the first.
    pub(super) is_second: bool,
}

/// A record with a result, by its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct StoredRecord {
    pub(super) time_ns: u64,
    pub(super) part: u32,
    pub(super) offset: u64,
    pub(super) has_facts: bool,
    /// Place of its maker in the list of the folder's.
    pub(super) maker: u16,
}

/// Id of a case as a record has it: that of a planned case, or any other text. The ids of planned cases come first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum StoredId {
    Case(CaseId),
    Other(Box<str>),
}

impl From<&str> for StoredId {
    fn from(text: &str) -> Self {
        text.parse().map_or_else(|_| Self::Other(text.into()), Self::Case)
    }
}

impl Deref for StoredId {
    type Target = str;

    fn deref(&self) -> &str {
        match self {
            Self::Case(id) => id,
            Self::Other(text) => text,
        }
    }
}

impl Stored {
    /// Order in which the results of a case count: files first, then records by their time.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::File(_), Self::File(_)) => Ordering::Equal,
            (Self::File(_), Self::Record(_)) => Ordering::Less,
            (Self::Record(_), Self::File(_)) => Ordering::Greater,
            (Self::Record(one), Self::Record(another)) => one.cmp(another),
        }
    }

    pub(super) fn is_beside(&self) -> bool {
        matches!(self, Self::File(file) if file.is_second)
    }
}

/// Reads a result that has a file of its own.
pub(super) fn read_file(path: &Path) -> Result<Vec<u8>, ResultError> {
    std::fs::read(path).map_err(|source| ResultError::System { path: path.to_owned(), source })
}

/// Records of the parts that hold no result that counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct NotCounted {
    /// Results that a later record takes back.
    pub(super) taken_back: u64,
    /// Parts whose last record was never completed.
    pub(super) torn: u64,
}
