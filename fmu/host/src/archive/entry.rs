//! Entries of an archive, and their oddities.

/// One file in an archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArchiveEntry {
    /// Path, with forward slashes.
    pub name: String,
    /// Size as stated in the archive: for display only, not to be trusted.
    pub stated_bytes: u64,
}

/// A property of an entry that the standards forbid, but that does no harm here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Odd {
    /// Name of the entry; empty: the archive as a whole.
    pub entry: String,
    /// Property.
    pub what: Oddity,
}

/// Property that may confuse other tools.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Oddity {
    /// The entry requires this version of the format, times ten.
    Version(u16),
    /// The entry isn't packed, but its size follows it: a reader from the start can't find its end.
    Descriptor,
    /// The name is neither ASCII nor marked as UTF-8: other tools read it as code page 437.
    Unmarked,
    /// The name is impossible on Windows, where the archive can't be unpacked.
    Windows(String),
    /// The entry is there more than once, each time with the same content.
    Duplicate,
    /// The headers before the entries contradict the directory at the end.
    Headers(String),
}
