//! Archives that somebody else made: an `.fmu` or `.ssp` opened, read and unpacked safely.
//!
//! Everything in an archive is hostile until it is shown not to be. Names are checked before anything
//! is read ([`names`]); sizes are counted while unpacking, since headers can lie; what the standards
//! don't allow (other compression than Deflate, encryption, links) is refused, not worked around. An
//! FMU that was unpacked already is a folder, and is taken as one.

pub mod names;
mod zipped;

use names::NameProblem;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use zipped::Zipped;

/// What an archive may need at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Number of entries.
    pub entries: usize,
    /// Bytes that are read to know the entries.
    pub directory_bytes: u64,
    /// Bytes of all entries together, unpacked.
    pub unpacked_bytes: u64,
    /// How many times its packed size an entry may have, where it is larger than `ratio_free_bytes`.
    pub ratio: u64,
    /// Size up to which an entry may be packed as well as it can.
    pub ratio_free_bytes: u64,
    /// Bytes of one entry that is read into memory.
    pub read_bytes: u64,
}

impl Limits {
    /// The limits for files of others. The largest FMUs in use hold some thousand files and one or two
    /// gigabytes of tables; descriptions of large Modelica models have some ten megabytes.
    pub const DEFAULT: Self = Self {
        // A zip without extensions counts entries in 16 bits.
        entries: 65_535,
        // 65 535 entries with names of 400 bytes each; what is read beyond it is no directory.
        directory_bytes: 32 << 20,
        // Twice the largest in use, and still room on any disk.
        unpacked_bytes: 4 << 30,
        // Deflate reaches 1032 on zeros alone; text and tables stay under 30, libraries under 10.
        ratio: 100,
        // A table of zeros of this size harms nobody.
        ratio_free_bytes: 64 << 20,
        // A description of this size has a million variables.
        read_bytes: 256 << 20,
    };
}

impl Default for Limits {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Why an archive can't be used.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// The file can't be read.
    #[error("failed to open {file}: {error}")]
    Open {
        /// The file.
        file: String,
        /// Why.
        error: io::Error,
    },
    /// It is something else.
    #[error(
        "{file} is no zip archive: it {found}, expected an FMU or SSP file, or an unpacked folder"
    )]
    NotZip {
        /// The file.
        file: String,
        /// What it is instead.
        found: String,
    },
    /// It is a zip archive, but cut off or damaged.
    #[error("{file} is damaged: {reason}")]
    Damaged {
        /// The file.
        file: String,
        /// What is wrong.
        reason: String,
    },
    /// An entry is not to be unpacked.
    #[error("{file}: entry {:?} {}, expected {}", .problem.name, .problem.found, .problem.expected)]
    Entry {
        /// The file.
        file: String,
        /// The entry and what is wrong with it.
        problem: NameProblem,
    },
    /// An entry can't be read.
    #[error("{file}: entry {entry:?} is damaged: {reason}")]
    Unreadable {
        /// The file.
        file: String,
        /// The entry.
        entry: String,
        /// What is wrong.
        reason: String,
    },
    /// There is more in it than is unpacked for anybody.
    #[error("{file}: {what}, expected at most {limit}")]
    TooMuch {
        /// The file.
        file: String,
        /// What is too much.
        what: String,
        /// The limit.
        limit: String,
    },
    /// An entry isn't there.
    #[error("{file} has no {entry}")]
    Missing {
        /// The file.
        file: String,
        /// The entry.
        entry: String,
    },
    /// The temporary folder can't be written.
    #[error("failed to unpack {file} to {}: {error}", .path.display())]
    Write {
        /// The file.
        file: String,
        /// What is written.
        path: PathBuf,
        /// Why not.
        error: io::Error,
    },
}

/// One file in an archive.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its path, with forward slashes.
    pub name: String,
    /// Its size as the archive states it: for showing, not for trusting.
    pub stated_bytes: u64,
}

/// Something about an entry that the standards forbid, but that does no harm here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Odd {
    /// The entry; empty: the archive as a whole.
    pub entry: String,
    /// What it is.
    pub what: Oddity,
}

/// What other tools may stumble over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Oddity {
    /// The entry says that it needs this version of the format, times ten.
    Version(u16),
    /// It isn't packed, but its size comes after it: who reads from the start can't tell its end.
    Descriptor,
    /// Its name isn't ASCII, nor marked as UTF-8: others read it as code page 437.
    Unmarked,
    /// Windows can't hold its name: there it isn't unpacked.
    Windows(String),
    /// The headers before the entries say something else than the directory at the end.
    Headers(String),
}

/// An archive or an unpacked folder whose entries are known.
#[derive(Debug)]
pub struct Archive {
    file: String,
    limits: Limits,
    entries: Vec<Entry>,
    problems: Vec<NameProblem>,
    oddities: Vec<Odd>,
    contents: Contents,
}

#[derive(Debug)]
enum Contents {
    Zip(Zipped),
    Folder(PathBuf),
}

/// A folder with all entries. If it is a temporary one, it goes with this.
#[derive(Debug)]
pub struct Unpacked {
    path: PathBuf,
    /// Held for its drop, which removes the folder.
    _temporary: Option<tempfile::TempDir>,
}

impl Unpacked {
    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Archive {
    /// Opens an archive, or a folder that was one.
    ///
    /// # Errors
    /// If it is none, is damaged, or holds anything that isn't to be unpacked.
    pub fn open(path: &Path) -> Result<Self, ArchiveError> {
        Self::survey(path, Limits::DEFAULT)?.without_problems()
    }

    /// Opens an archive that is in memory, such as an FMU in an SSP file; `file` names it in messages.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn from_bytes(file: &str, bytes: Vec<u8>) -> Result<Self, ArchiveError> {
        Self::survey_bytes(file, bytes, Limits::DEFAULT)?.without_problems()
    }

    /// As [`Self::open`], but with entries that aren't to be unpacked: [`Self::problems`]. None of
    /// them can be read, and such an archive isn't unpacked.
    ///
    /// # Errors
    /// If it is no archive, is damaged or too large.
    pub fn survey(path: &Path, limits: Limits) -> Result<Self, ArchiveError> {
        let file = path.display().to_string();
        let open = |error| ArchiveError::Open { file: file.clone(), error };
        if fs::metadata(path).map_err(open)?.is_dir() {
            return Self::survey_folder(path, file, limits);
        }
        let source = fs::File::open(path).map_err(open)?;
        Self::survey_zip(file.clone(), Box::new(io::BufReader::new(source)), limits)
    }

    /// As [`Self::survey`], of an archive that is in memory.
    ///
    /// # Errors
    /// As [`Self::survey`].
    pub fn survey_bytes(file: &str, bytes: Vec<u8>, limits: Limits) -> Result<Self, ArchiveError> {
        Self::survey_zip(file.to_owned(), Box::new(io::Cursor::new(bytes)), limits)
    }

    fn survey_zip(
        file: String,
        source: Box<dyn zipped::Source>,
        limits: Limits,
    ) -> Result<Self, ArchiveError> {
        let zipped::Opened { zip, entries, problems, oddities } =
            Zipped::open(&file, source, &limits)?;
        Ok(Self { file, limits, entries, problems, oddities, contents: Contents::Zip(zip) })
    }

    /// The files below a folder. Links aren't followed.
    fn survey_folder(path: &Path, file: String, limits: Limits) -> Result<Self, ArchiveError> {
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
                    entries.push(Entry { name, stated_bytes: metadata.len() });
                } else {
                    problems.push(NameProblem {
                        name,
                        found: "is a link or a device".into(),
                        expected: "a file or a folder",
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

    /// The name that messages have for it.
    #[must_use]
    pub fn file(&self) -> &str {
        &self.file
    }

    /// It is a folder, not a file.
    #[must_use]
    pub fn is_folder(&self) -> bool {
        matches!(self.contents, Contents::Folder(_))
    }

    /// Its files, without those that have a problem.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        &self.entries
    }

    /// Entries that aren't to be unpacked.
    #[must_use]
    pub fn problems(&self) -> &[NameProblem] {
        &self.problems
    }

    /// What other tools may stumble over.
    #[must_use]
    pub fn oddities(&self) -> &[Odd] {
        &self.oddities
    }

    /// There is a file of this name.
    #[must_use]
    pub fn contains(&self, name: &str) -> bool {
        self.entries.iter().any(|entry| entry.name == name)
    }

    /// There is a file below this folder, whose name ends with a slash.
    #[must_use]
    pub fn contains_below(&self, folder: &str) -> bool {
        self.entries.iter().any(|entry| entry.name.starts_with(folder))
    }

    /// One file, in memory.
    ///
    /// # Errors
    /// If it isn't there, is damaged or too large for memory.
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
                let limits = Limits { unpacked_bytes: limit, ..self.limits };
                zip.copy(&self.file, name, &limits, &mut 0, &mut bytes, |error| {
                    ArchiveError::Unreadable {
                        file: self.file.clone(),
                        entry: name.into(),
                        reason: error.to_string(),
                    }
                })?;
            }
            Contents::Folder(folder) => {
                use std::io::Read;
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

    /// All files in a folder: a temporary one, or the folder itself where it is one.
    ///
    /// # Errors
    /// If an entry isn't to be unpacked, is damaged or too large, or the temporary folder can't be
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
            // The name was checked part by part: it stays below the folder.
            let path = temporary.path().join(&entry.name);
            let write =
                |error| ArchiveError::Write { file: file.clone(), path: path.clone(), error };
            if let Some(folder) = path.parent() {
                fs::create_dir_all(folder).map_err(write)?;
            }
            let mut target = fs::File::create_new(&path).map_err(write)?;
            zip.copy(file, &entry.name, &self.limits, &mut written, &mut target, write)?;
            target.flush().map_err(write)?;
            // Tools that an FMU brings along have to stay programs.
            #[cfg(unix)]
            if zip.is_program(&entry.name) {
                use std::os::unix::fs::PermissionsExt;
                target.set_permissions(fs::Permissions::from_mode(0o755)).map_err(write)?;
            }
        }
        Ok(Unpacked { path: temporary.path().to_owned(), _temporary: Some(temporary) })
    }
}

#[cfg(test)]
mod tests;
