//! Finds the files of a run: `RUN.partial` while it is in progress, `RUN` afterwards.

use octant_evidence::manifest::shell_path;
use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Name of the recording in a run folder.
pub const RECORDING: &str = "recording.mcap";
/// Suffix of a folder's name while its run is in progress.
const PARTIAL: &str = ".partial";

/// Reasons why there is no run to watch.
#[derive(Debug, thiserror::Error)]
pub enum PlaceError {
    /// No run has this name.
    #[error(
        "find the run {}: there is neither a folder nor a recording of this name, nor a folder \
         {}{PARTIAL}", .path.display(), .path.display()
    )]
    Missing {
        /// Name that was given.
        path: PathBuf,
    },
    /// The folder has no recording, and none is being written in it.
    #[error("watch {}: expected a run folder, and {file} is missing in it", .path.display())]
    NotARun {
        /// The folder.
        path: PathBuf,
        /// Missing file.
        file: String,
    },
    /// No run is in progress.
    #[error(
        "find a run that goes on: there is no folder *{PARTIAL} with a {RECORDING} in {}; a run that \
         has ended is named: octant watch {}/NAME", .folder.display(), shell_path(.folder)
    )]
    NoneGoesOn {
        /// Folder that was searched.
        folder: PathBuf,
    },
}

/// Place of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunPlace {
    partial: PathBuf,
    finished: PathBuf,
    recording: String,
}

impl RunPlace {
    /// Finds the run of this name: its folder, with or without `.partial`, or its recording.
    ///
    /// # Errors
    /// If there is no such run.
    pub fn of(run: &Path) -> Result<Self, PlaceError> {
        let (folder, recording) = match run.file_name() {
            Some(name) if run.extension().is_some_and(|e| e == "mcap") && !run.is_dir() => {
                (run.parent().unwrap_or(Path::new("")), name.to_string_lossy().into_owned())
            }
            _ => (run, RECORDING.to_owned()),
        };
        let place = Self::named(folder, recording);
        if place.recording().is_some() || place.is_written() {
            return Ok(place);
        }
        match [&place.partial, &place.finished].into_iter().find(|folder| folder.is_dir()) {
            Some(folder) => {
                Err(PlaceError::NotARun { path: folder.clone(), file: place.recording })
            }
            None => Err(PlaceError::Missing { path: run.to_owned() }),
        }
    }

    fn named(folder: &Path, recording: String) -> Self {
        // `.` and `..` have no name to which a suffix can be added.
        let name = folder.file_name().unwrap_or_default().to_owned();
        let text = name.to_string_lossy();
        let with = |name: OsString| folder.with_file_name(name);
        let (partial, finished) = match text.strip_suffix(PARTIAL) {
            _ if name.is_empty() => (folder.to_owned(), folder.to_owned()),
            Some(stem) => (folder.to_owned(), with(stem.into())),
            None => {
                let mut partial = name.clone();
                partial.push(PARTIAL);
                let partial = with(partial);
                // Beside a finished run, a killed one of the same name isn't the one meant.
                let is_meant = !folder.is_dir() || is_locked(&partial);
                (if is_meant { partial } else { folder.to_owned() }, folder.to_owned())
            }
        };
        Self { partial, finished, recording }
    }

    /// Finds the most recent run in progress in a folder of runs; without one, the most recent run
    /// that was killed.
    ///
    /// # Errors
    /// If there is neither.
    pub fn newest(runs: &Path) -> Result<Self, PlaceError> {
        let began = |folder: &Path| -> Option<SystemTime> {
            let recording = fs::metadata(folder.join(RECORDING)).ok()?;
            // If the file system doesn't store the time of creation, the time of the last growth is
            // used.
            recording.created().or_else(|_| recording.modified()).ok()
        };
        let folders = fs::read_dir(runs).into_iter().flatten().flatten().map(|entry| entry.path());
        let found = folders
            .filter(|path| path.to_string_lossy().ends_with(PARTIAL))
            .filter_map(|path| Some((is_locked(&path), began(&path)?, path)))
            // Remains of a killed run rank after every run in progress.
            .max();
        match found {
            Some((_, _, folder)) => Ok(Self::named(&folder, RECORDING.to_owned())),
            None => Err(PlaceError::NoneGoesOn { folder: runs.to_owned() }),
        }
    }

    /// Returns the recording, if there is one.
    #[must_use]
    pub fn recording(&self) -> Option<PathBuf> {
        self.file(&self.recording)
    }

    /// Returns a file of the run.
    #[must_use]
    pub fn file(&self, name: &str) -> Option<PathBuf> {
        Some(self.folder().join(name)).filter(|path| path.is_file())
    }

    /// Returns the present folder of the run.
    #[must_use]
    pub fn folder(&self) -> &Path {
        if self.partial.is_dir() { &self.partial } else { &self.finished }
    }

    /// Returns whether a program is writing the run.
    #[must_use]
    pub fn is_written(&self) -> bool {
        is_locked(&self.partial)
    }
}

/// Returns whether the lock of a partial folder is held. If it isn't, the writer is dead.
fn is_locked(partial: &Path) -> bool {
    let path = partial.join(octant_evidence::LOCK);
    let Ok(file) = File::open(path) else { return false };
    // A shared lock, released at once: no run waits for it.
    match file.try_lock_shared() {
        Ok(()) => false,
        Err(TryLockError::WouldBlock) => true,
        // A file system without locks can't tell, so the lock may be held.
        Err(TryLockError::Error(_)) => true,
    }
}
