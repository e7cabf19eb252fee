//! Limits of an archive.

/// Limits of an archive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArchiveLimits {
    /// Number of entries.
    pub entries: usize,
    /// Bytes read for the directory of the entries.
    pub directory_bytes: u64,
    /// Bytes of all entries together, unpacked.
    pub unpacked_bytes: u64,
    /// Largest ratio of an entry's size to its packed size, if the entry is larger than
    /// `ratio_free_bytes`.
    pub ratio: u64,
    /// Size up to which the ratio of an entry is unlimited.
    pub ratio_free_bytes: u64,
    /// Bytes of one entry when read into memory.
    pub read_bytes: u64,
}

impl ArchiveLimits {
    /// Limits for files from others. The largest FMUs in use hold some thousand files and one or
    /// two gigabytes of tables; descriptions of large Modelica models have some ten megabytes.
    pub const DEFAULT: Self = Self {
        // A zip without extensions counts entries in 16 bits.
        entries: 65_535,
        // 65 535 entries with names of 400 bytes each; a larger directory isn't genuine.
        directory_bytes: 32 << 20,
        // Twice the largest in use, which still fits on any disk.
        unpacked_bytes: 4 << 30,
        // Deflate reaches 1032 only on zeros; text and tables stay under 30, libraries under 10.
        ratio: 100,
        // A table of zeros of this size does no harm.
        ratio_free_bytes: 64 << 20,
        // A description of this size has a million variables.
        read_bytes: 256 << 20,
    };
}

impl Default for ArchiveLimits {
    fn default() -> Self {
        Self::DEFAULT
    }
}
