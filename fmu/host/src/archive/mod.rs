//! Archives from others: an `.fmu` or `.ssp` is opened, read and unpacked safely.
//!
//! Everything in an archive is considered hostile until it is checked. Names are checked before
//! anything is read ([`names`]); sizes are counted during unpacking, since headers can lie; content
//! that the standards don't allow (other compression than Deflate, encryption, links) is refused,
//! not worked around. An unpacked FMU is a folder, and is accepted as one.

mod duplicates;
mod entry;
mod error;
mod limits;
pub mod names;
mod zipped;

pub use entry::{ArchiveEntry, Odd, Oddity};
pub use error::ArchiveError;
pub use limits::ArchiveLimits;

use names::NameProblem;
use octant_base::hash::sha256_of_copy;
use std::fs;
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use zipped::Zipped;

/// Largest copy of an archive that is held in memory, bytes; a larger one is a temporary file.
const MEMORY_MAX: usize = 64 << 20;

/// An archive or an unpacked folder whose entries are known.
#[derive(Debug)]
pub struct Archive {
    file: String,
    limits: ArchiveLimits,
    entries: Vec<ArchiveEntry>,
    problems: Vec<NameProblem>,
    oddities: Vec<Odd>,
    contents: Contents,
}

#[derive(Debug)]
enum Contents {
    Zip(Zipped),
    Folder(PathBuf),
}

/// A folder with all entries. A temporary folder is removed when this is dropped.
#[derive(Debug)]
pub struct Unpacked {
    path: PathBuf,
    /// Held for its drop, which removes the folder.
    _temporary: Option<tempfile::TempDir>,
}

impl Unpacked {
    /// Path of the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Archive {
    /// Opens an archive, or a folder with its unpacked content.
    ///
    /// # Errors
    /// If the path is neither, is damaged, or contains an entry that must not be unpacked.
    pub fn open(path: &Path) -> Result<Self, ArchiveError> {
        Self::survey(path, ArchiveLimits::DEFAULT)?.without_problems()
    }

    /// Opens an archive in memory, such as an FMU in an SSP file; `file` is its name in messages.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn from_bytes(file: &str, bytes: Vec<u8>) -> Result<Self, ArchiveError> {
        Self::survey_bytes(file, bytes, ArchiveLimits::DEFAULT)?.without_problems()
    }

    /// Opens as [`Self::open`], but accepts entries that must not be unpacked: [`Self::problems`].
    /// Such entries can't be read, and their archive can't be unpacked.
    ///
    /// # Errors
    /// If it is no archive, is damaged or too large.
    pub fn survey(path: &Path, limits: ArchiveLimits) -> Result<Self, ArchiveError> {
        let file = path.display().to_string();
        let open = |error| ArchiveError::Open { file: file.clone(), error };
        if fs::metadata(path).map_err(open)?.is_dir() {
            return Self::survey_folder(path, file, limits);
        }
        let source = fs::File::open(path).map_err(open)?;
        Self::survey_zip(file.clone(), Box::new(io::BufReader::new(source)), limits)
    }

    /// Opens a copy of an archive as it is now, and returns its SHA-256: whatever happens to the file later, the
    /// hashed bytes are the ones that are read and unpacked. A folder is opened as it is, and has no hash.
    ///
    /// # Errors
    /// As [`Self::open`], or if the copy can't be written.
    pub fn open_copy(path: &Path) -> Result<(Self, Option<String>), ArchiveError> {
        let file = path.display().to_string();
        let limits = ArchiveLimits::DEFAULT;
        let open = |error| ArchiveError::Open { file: file.clone(), error };
        if fs::metadata(path).map_err(open)?.is_dir() {
            let folder = Self::survey_folder(path, file, limits)?.without_problems()?;
            return Ok((folder, None));
        }
        let mut source = fs::File::open(path).map_err(open)?;
        let mut start = [0; zipped::START];
        let length = zipped::read_start(&mut source, &mut start).map_err(open)?;
        // Anything else is refused by its first bytes, and a device may have no end.
        zipped::check_start(&file, &start[..length])?;
        let mut copy = tempfile::spooled_tempfile(MEMORY_MAX);
        let most = limits.unpacked_bytes;
        let copied = sha256_of_copy(source.take(most + 1), &mut copy)
            .and_then(|hash| Ok((hash, copy.stream_position()?, copy.rewind()?)));
        let (hash, length, ()) = copied.map_err(|error| ArchiveError::Copy {
            file: file.clone(),
            path: std::env::temp_dir(),
            error,
        })?;
        if length > most {
            let (what, limit) = ("it is too large".into(), format!("{most} bytes"));
            return Err(ArchiveError::TooMuch { file, what, limit });
        }
        let source = Box::new(io::BufReader::new(copy));
        Ok((Self::survey_zip(file, source, limits)?.without_problems()?, Some(hash)))
    }

    /// Opens as [`Self::survey`], from memory.
    ///
    /// # Errors
    /// As [`Self::survey`].
    pub fn survey_bytes(
        file: &str,
        bytes: Vec<u8>,
        limits: ArchiveLimits,
    ) -> Result<Self, ArchiveError> {
        Self::survey_zip(file.to_owned(), Box::new(io::Cursor::new(bytes)), limits)
    }

    fn survey_zip(
        file: String,
        source: Box<dyn zipped::Source>,
        limits: ArchiveLimits,
    ) -> Result<Self, ArchiveError> {
        let zipped::Opened { zip, entries, problems, oddities } =
            Zipped::open(&file, source, &limits)?;
        Ok(Self { file, limits, entries, problems, oddities, contents: Contents::Zip(zip) })
    }

    /// Lists the files below a folder. A link is a file where it leads to one below the folder, and a
    /// problem else.
    fn survey_folder(
        path: &Path,
        file: String,
        limits: ArchiveLimits,
    ) -> Result<Self, ArchiveError> {
        let mut entries = Vec::new();
        let mut problems = Vec::new();
        let mut folders = vec![(path.to_owned(), String::new())];
        while let Some((folder, prefix)) = folders.pop() {
            let open = |error| ArchiveError::Open { file: folder.display().to_string(), error };
            for item in fs::read_dir(&folder).map_err(open)? {
                let item = item.map_err(open)?;
                let name = format!("{prefix}{}", item.file_name().to_string_lossy());
                let metadata = item.metadata().map_err(open)?;
                if let Err(problem) = names::check(name.as_bytes()) {
                    problems.push(problem);
                } else if metadata.is_dir() {
                    folders.push((item.path(), name + "/"));
                } else if metadata.is_file() {
                    entries.push(ArchiveEntry { name, stated_bytes: metadata.len() });
                } else if let Some(stated_bytes) = linked_within(path, &item.path()) {
                    entries.push(ArchiveEntry { name, stated_bytes });
                } else {
                    problems.push(NameProblem {
                        name,
                        found: "is a link or a device".into(),
                        expected: "a file, a folder, or a link to a file of the FMU's folder",
                    });
                }
                if entries.len() + folders.len() > limits.entries {
                    return Err(ArchiveError::TooMuch {
                        file,
                        what: "the folder has more entries than any FMU".into(),
                        limit: limits.entries.to_string(),
                    });
                }
            }
        }
        entries.sort_by(|a, b| a.name.cmp(&b.name));
        let contents = Contents::Folder(path.to_owned());
        Ok(Self { file, limits, entries, problems, oddities: Vec::new(), contents })
    }

    fn without_problems(self) -> Result<Self, ArchiveError> {
        match self.problems.first() {
            None => Ok(self),
            Some(problem) => Err(ArchiveError::Entry { file: self.file, problem: problem.clone() }),
        }
    }

    /// Name of the archive in messages.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Returns whether this is a folder, not a file.
    #[must_use]
    pub fn is_folder(&self) -> bool {
        matches!(self.contents, Contents::Folder(_))
    }

    /// Files, without those that have a problem.
    #[must_use]
    pub fn entries(&self) -> &[ArchiveEntry] {
        &self.entries
    }

    /// Entries that must not be unpacked.
    #[must_use]
    pub fn problems(&self) -> &[NameProblem] {
        &self.problems
    }

    /// Properties that may confuse other tools.
    #[must_use]
    pub fn oddities(&self) -> &[Odd] {
        &self.oddities
    }

    /// Returns whether there is a file of this name.
    #[must_use]
    pub fn contains(&self, name: &str) -> bool {
        self.entries.iter().any(|entry| entry.name == name)
    }

    /// Returns whether there is a file below this folder, whose name ends with a slash.
    #[must_use]
    pub fn contains_below(&self, folder: &str) -> bool {
        self.entries.iter().any(|entry| entry.name.starts_with(folder))
    }

    /// Reads one file into memory.
    ///
    /// # Errors
    /// If the file is missing, damaged or too large for memory.
    pub fn read(&mut self, name: &str) -> Result<Vec<u8>, ArchiveError> {
        if !self.contains(name) {
            let entry = names::printable(name.as_bytes());
            return Err(ArchiveError::Missing { file: self.file.clone(), entry });
        }
        let limit = self.limits.read_bytes;
        let too_much = || ArchiveError::TooMuch {
            file: self.file.clone(),
            what: format!("entry {name:?} is too large to be read"),
            limit: format!("{limit} bytes"),
        };
        let mut bytes = Vec::new();
        match &mut self.contents {
            Contents::Zip(zip) => {
                let limits = ArchiveLimits { unpacked_bytes: limit, ..self.limits };
                zip.copy(&self.file, name, &limits, &mut 0, &mut bytes, |error| {
                    ArchiveError::Unreadable {
                        file: self.file.clone(),
                        entry: name.into(),
                        reason: error.to_string(),
                    }
                })?;
            }
            Contents::Folder(folder) => {
                let file = folder.join(name);
                let unreadable =
                    |error| ArchiveError::Open { file: file.display().to_string(), error };
                fs::File::open(&file)
                    .and_then(|source| source.take(limit + 1).read_to_end(&mut bytes))
                    .map_err(unreadable)?;
                if bytes.len() as u64 > limit {
                    return Err(too_much());
                }
            }
        }
        Ok(bytes)
    }

    /// Unpacks all files into a temporary folder, or returns the folder itself if this is one.
    ///
    /// # Errors
    /// If an entry must not be unpacked, is damaged or too large, or the temporary folder can't be
    /// written.
    pub fn unpack(&mut self) -> Result<Unpacked, ArchiveError> {
        if let Some(problem) = self.problems.first() {
            return Err(ArchiveError::Entry { file: self.file.clone(), problem: problem.clone() });
        }
        let zip = match &mut self.contents {
            Contents::Folder(folder) => {
                return Ok(Unpacked { path: folder.clone(), _temporary: None });
            }
            Contents::Zip(zip) => zip,
        };
        let file = &self.file;
        let temporary =
            tempfile::Builder::new().prefix("octant-fmu-").tempdir().map_err(|error| {
                ArchiveError::Write { file: file.clone(), path: std::env::temp_dir(), error }
            })?;
        let mut written = 0;
        for entry in &self.entries {
            // The name was checked part by part, so that it stays below the folder.
            let path = temporary.path().join(&entry.name);
            let write =
                |error| ArchiveError::Write { file: file.clone(), path: path.clone(), error };
            if let Some(folder) = path.parent() {
                fs::create_dir_all(folder).map_err(write)?;
            }
            let mut target = fs::File::create_new(&path).map_err(write)?;
            zip.copy(file, &entry.name, &self.limits, &mut written, &mut target, write)?;
            target.flush().map_err(write)?;
            // Tools inside an FMU have to stay executable.
            #[cfg(unix)]
            if zip.is_program(&entry.name) {
                use std::os::unix::fs::PermissionsExt;
                target.set_permissions(fs::Permissions::from_mode(0o755)).map_err(write)?;
            }
        }
        Ok(Unpacked { path: temporary.path().to_owned(), _temporary: Some(temporary) })
    }
}

/// Size of the file to which a link leads, bytes; `None` if it leads to none below the folder.
fn linked_within(folder: &Path, link: &Path) -> Option<u64> {
    let target = fs::canonicalize(link).ok()?;
    if !target.starts_with(fs::canonicalize(folder).ok()?) {
        return None;
    }
    let metadata = fs::metadata(&target).ok()?;
    metadata.is_file().then_some(metadata.len())
}

#[cfg(test)]
mod tests;
