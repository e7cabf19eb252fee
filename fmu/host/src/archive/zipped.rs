//! A zip archive: its entries are examined, and read with every byte counted.

use super::duplicates::{ContentComparison, HEADER, Header, compare};
use super::entry::{ArchiveEntry, Odd, Oddity};
use super::error::ArchiveError;
use super::limits::ArchiveLimits;
use super::names::{self, NameProblem, Names};
use std::collections::btree_map::{BTreeMap, Entry};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use zip::read::{ArchiveOffset, Config, ZipArchive};
use zip::{CompressionMethod, result::ZipError};

/// Source of the bytes of an archive.
pub(super) trait Source: Read + Seek + Send + std::fmt::Debug {}
impl<T: Read + Seek + Send + std::fmt::Debug> Source for T {}

/// A source that fails after a limit of bytes: the content of the directory decides how much is
/// read for it.
#[derive(Debug)]
struct Metered {
    source: Box<dyn Source>,
    left: Arc<AtomicU64>,
}

impl Read for Metered {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.source.read(buffer)?;
        let left = self.left.load(Ordering::Relaxed);
        let Some(rest) = left.checked_sub(read as u64) else {
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, "its directory is too large"));
        };
        if left != u64::MAX {
            self.left.store(rest, Ordering::Relaxed);
        }
        Ok(read)
    }
}

impl Seek for Metered {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.source.seek(to)
    }
}

/// A zip archive.
#[derive(Debug)]
pub(super) struct Zipped {
    archive: ZipArchive<Metered>,
    /// Index in the archive, and whether it is a program, of each entry that may be unpacked.
    places: BTreeMap<String, (usize, bool)>,
}

/// An opened archive.
pub(super) struct Opened {
    pub(super) zip: Zipped,
    pub(super) entries: Vec<ArchiveEntry>,
    pub(super) problems: Vec<NameProblem>,
    pub(super) oddities: Vec<Odd>,
}

impl Zipped {
    /// Opens the archive and examines every entry's header.
    pub(super) fn open(
        file: &str,
        mut source: Box<dyn Source>,
        limits: &ArchiveLimits,
    ) -> Result<Opened, ArchiveError> {
        let mut start = [0; START];
        let length = read_start(&mut source, &mut start)
            .map_err(|error| ArchiveError::Open { file: file.into(), error })?;
        check_start(file, &start[..length])?;
        let left = Arc::new(AtomicU64::new(limits.directory_bytes));
        let metered = Metered { source, left: left.clone() };
        // A zip archive with an offset in the file is two files in one.
        let config = Config { archive_offset: ArchiveOffset::Known(0) };
        let damaged = |error: ZipError| match error {
            ZipError::Io(error) if error.kind() == io::ErrorKind::FileTooLarge => {
                ArchiveError::TooMuch {
                    file: file.into(),
                    what: "its directory is too large".into(),
                    limit: format!("{} bytes", limits.directory_bytes),
                }
            }
            error => ArchiveError::Damaged { file: file.into(), reason: reason(&error) },
        };
        let archive = ZipArchive::with_config(config, metered).map_err(damaged)?;
        if archive.len() > limits.entries {
            return Err(ArchiveError::TooMuch {
                file: file.into(),
                what: format!("it has {} entries", archive.len()),
                limit: limits.entries.to_string(),
            });
        }
        // The library keeps one entry for a name, and not every field: the directory is read once
        // more.
        let start = archive.central_directory_start();
        let mut metered = archive.into_inner();
        left.store(limits.directory_bytes, Ordering::Relaxed);
        let (twice, mut oddities) =
            directory(&mut metered, start).map_err(|error| damaged(ZipError::Io(error)))?;
        left.store(u64::MAX, Ordering::Relaxed);
        let mut problems = duplicates(&mut metered, &twice, limits, &mut oddities);
        left.store(limits.directory_bytes, Ordering::Relaxed);
        let mut archive = ZipArchive::with_config(config, metered).map_err(damaged)?;
        // Two entries that share bytes make a huge archive from a small file.
        if archive.has_overlapping_entries().map_err(damaged)? {
            let reason = "entries overlap".into();
            return Err(ArchiveError::Damaged { file: file.into(), reason });
        }
        // The library's check of the headers refuses every duplicate.
        if twice.is_empty()
            && let Err(error) = archive.validate_header_consistency()
        {
            let entry = String::new();
            oddities.push(Odd { entry, what: Oddity::Headers(reason(&error)) });
        }
        left.store(u64::MAX, Ordering::Relaxed);
        let mut seen = Names::default();
        let mut entries = Vec::new();
        let mut places = BTreeMap::new();
        for index in 0..archive.len() {
            match look(&mut archive, index, &mut seen) {
                Err(error) => return Err(damaged(error)),
                Ok(Err(problem)) => problems.push(problem),
                Ok(Ok(None)) => {}
                Ok(Ok(Some((entry, is_program)))) => {
                    if let Err(problem) = names::check_for_windows(&entry.name) {
                        if cfg!(windows) {
                            problems.push(problem);
                            continue;
                        }
                        let what = Oddity::Windows(problem.found);
                        oddities.push(Odd { entry: problem.name, what });
                    }
                    places.insert(entry.name.clone(), (index, is_program));
                    entries.push(entry);
                }
            }
        }
        Ok(Opened { zip: Self { archive, places }, entries, problems, oddities })
    }

    /// Returns whether the archive marks the entry as a program.
    #[cfg(unix)]
    pub(super) fn is_program(&self, name: &str) -> bool {
        self.places.get(name).is_some_and(|&(_, is_program)| is_program)
    }

    /// Copies an entry and counts the bytes; `written`: bytes of all entries so far.
    pub(super) fn copy(
        &mut self,
        file: &str,
        name: &str,
        limits: &ArchiveLimits,
        written: &mut u64,
        target: &mut impl Write,
        failed_to_write: impl Fn(io::Error) -> ArchiveError,
    ) -> Result<(), ArchiveError> {
        let unreadable = |reason: String| ArchiveError::Unreadable {
            file: file.into(),
            entry: name.into(),
            reason,
        };
        let missing = || ArchiveError::Missing { file: file.into(), entry: name.into() };
        let &(index, _) = self.places.get(name).ok_or_else(missing)?;
        let mut entry = self.archive.by_index(index).map_err(|error| unreadable(reason(&error)))?;
        // Entries don't overlap, so that this is at most the size of the file.
        let packed = entry.compressed_size().max(1);
        let mut unpacked = 0u64;
        let mut buffer = vec![0; 64 << 10];
        loop {
            let read = match entry.read(&mut buffer) {
                Ok(0) => return Ok(()),
                Ok(read) => read,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return Err(unreadable(error.to_string())),
            };
            unpacked += read as u64;
            *written += read as u64;
            if *written > limits.unpacked_bytes {
                return Err(ArchiveError::TooMuch {
                    file: file.into(),
                    what: format!("with entry {name:?} more is unpacked than from any FMU"),
                    limit: format!("{} bytes", limits.unpacked_bytes),
                });
            }
            if unpacked > limits.ratio_free_bytes && unpacked / packed > limits.ratio {
                return Err(ArchiveError::TooMuch {
                    file: file.into(),
                    what: format!(
                        "entry {name:?} unpacks to more than {} times its size",
                        limits.ratio
                    ),
                    limit: format!("{} bytes for such an entry", limits.ratio_free_bytes),
                });
            }
            target.write_all(&buffer[..read]).map_err(&failed_to_write)?;
        }
    }
}

/// Number of the first bytes by which an archive is known.
pub(super) const START: usize = 4;

/// Checks the first bytes of a file.
pub(super) fn check_start(file: &str, start: &[u8]) -> Result<(), ArchiveError> {
    if start == b"PK\x03\x04" || start == b"PK\x05\x06" {
        return Ok(());
    }
    let found = match start {
        [] => "is empty".to_owned(),
        _ => format!("begins with {:?}", names::printable(start)),
    };
    Err(ArchiveError::NotZip { file: file.into(), found })
}

/// Reads the first bytes of a file, as many as it has, and goes back to its beginning.
pub(super) fn read_start(source: &mut impl Source, start: &mut [u8]) -> io::Result<usize> {
    let mut length = 0;
    while length < start.len() {
        match source.read(&mut start[length..])? {
            0 => break,
            read => length += read,
        }
    }
    source.seek(SeekFrom::Start(0))?;
    Ok(length)
}

/// Examines an entry's header: a file to unpack, a folder (nothing), or a problem.
#[allow(clippy::type_complexity, reason = "one caller, which takes it apart at once")]
fn look(
    archive: &mut ZipArchive<Metered>,
    index: usize,
    seen: &mut Names,
) -> Result<Result<Option<(ArchiveEntry, bool)>, NameProblem>, ZipError> {
    let entry = archive.by_index_raw(index)?;
    let raw = entry.name_raw();
    let problem = |found: String, expected| {
        Ok(Err(NameProblem { name: names::printable(raw), found, expected }))
    };
    let name = match names::check(raw) {
        Ok(name) => name,
        Err(found) => return Ok(Err(found)),
    };
    if entry.encrypted() {
        return problem("is encrypted".into(), "an entry that anybody can read");
    }
    // File types in the mode field of Unix zips.
    const TYPE: u32 = 0o170_000;
    const FOLDER: u32 = 0o040_000;
    const FILE: u32 = 0o100_000;
    match entry.unix_mode().map_or(0, |mode| mode & TYPE) {
        0 | FILE | FOLDER => {}
        0o120_000 => return problem("is a symbolic link".into(), "a file or a folder"),
        _ => return problem("is a device".into(), "a file or a folder"),
    }
    if !matches!(entry.compression(), CompressionMethod::Stored | CompressionMethod::Deflated) {
        return problem(
            format!("is packed with {}", entry.compression()),
            "stored or Deflate, which the standards allow",
        );
    }
    if let Err(problem) = seen.add(name) {
        return Ok(Err(problem));
    }
    if name.ends_with('/') {
        return Ok(Ok(None));
    }
    let is_program = entry.unix_mode().is_some_and(|mode| mode & 0o100 != 0);
    Ok(Ok(Some((ArchiveEntry { name: name.into(), stated_bytes: entry.size() }, is_program))))
}

/// An entry that has the name of an earlier one: both headers.
struct Duplicate {
    name: Vec<u8>,
    headers: [Header; 2],
}

/// Examines the directory's headers for facts that the library doesn't keep: names that occur
/// twice, and properties that may confuse other tools.
fn directory(source: &mut Metered, start: u64) -> io::Result<(Vec<Duplicate>, Vec<Odd>)> {
    source.seek(SeekFrom::Start(start))?;
    let mut seen: BTreeMap<Vec<u8>, Header> = BTreeMap::new();
    let mut twice = Vec::new();
    let mut oddities = Vec::new();
    let mut header = [0; HEADER];
    loop {
        source.read_exact(&mut header[..4])?;
        if &header[..4] != b"PK\x01\x02" {
            return Ok((twice, oddities));
        }
        source.read_exact(&mut header[4..])?;
        let field = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
        let mut name = vec![0; field(28).into()];
        source.read_exact(&mut name)?;
        source.seek(SeekFrom::Current(i64::from(field(30)) + i64::from(field(32))))?;
        let (version, flags, method) = (field(6), field(8), field(10));
        let mut odd = |what| oddities.push(Odd { entry: names::printable(&name), what });
        if version & 0xff > 20 {
            odd(Oddity::Version(version & 0xff));
        }
        if flags & 1 << 3 != 0 && method == 0 {
            odd(Oddity::Descriptor);
        }
        if flags & 1 << 11 == 0 && !name.is_ascii() {
            odd(Oddity::Unmarked);
        }
        match seen.entry(name) {
            Entry::Vacant(place) => {
                place.insert(header);
            }
            Entry::Occupied(first) => {
                let (name, headers) = (first.key().clone(), [*first.get(), header]);
                twice.push(Duplicate { name, headers });
            }
        }
    }
}

/// Compares the entries that have one name: identical ones are an oddity, others a problem.
fn duplicates(
    source: &mut Metered,
    twice: &[Duplicate],
    limits: &ArchiveLimits,
    oddities: &mut Vec<Odd>,
) -> Vec<NameProblem> {
    let mut problems = Vec::new();
    let mut left = limits.read_bytes;
    for Duplicate { name, headers: [one, other] } in twice {
        let name = names::printable(name);
        let found = match compare(source, one, other, &mut left) {
            ContentComparison::Identical => {
                oddities.push(Odd { entry: name, what: Oddity::Duplicate });
                continue;
            }
            ContentComparison::Different => "is there twice, with different contents",
            ContentComparison::Unknown => "is there twice, with contents that can't be compared",
        };
        let expected = "one entry of a name";
        problems.push(NameProblem { name, found: found.into(), expected });
    }
    problems
}

/// Describes an error of the zip library.
fn reason(error: &ZipError) -> String {
    match error {
        ZipError::Io(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
            "it ends too early".into()
        }
        ZipError::Io(error) => error.to_string(),
        ZipError::InvalidArchive(reason) => reason.to_string(),
        ZipError::UnsupportedArchive(reason) => (*reason).to_owned(),
        other => other.to_string(),
    }
}
