//! The folder of a run: written as `RUN.partial`, renamed to `RUN` when the run ends.
//!
//! A folder `RUN` always holds a complete run. A kill leaves `RUN.partial`, which is readable and
//! never taken for a finished run. A lock in it distinguishes a run in progress from one that was
//! killed.

pub use super::error::FolderError;
pub use super::files::LOCK;

use super::files::MANIFEST;
use super::leftover::{self, Leftover, system};
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// Suffix of a folder's name while its run is in progress.
pub const PARTIAL: &str = ".partial";

/// Treatment of an existing folder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Keep it, and fail.
    #[default]
    Refuse,
    /// Replace a run, finished or killed; anything else is kept, and fails.
    Replace,
}

/// Folder of a run that is being written.
///
/// If dropped without [`RunFolder::finish`], the partial folder stays as it is.
#[derive(Debug)]
pub struct RunFolder {
    partial: PathBuf,
    finished: PathBuf,
    existing: Existing,
    lock: File,
}

impl RunFolder {
    /// Creates `path` with `.partial` appended.
    ///
    /// # Errors
    /// If there is something in the way that must not be replaced, or the operating system refuses.
    pub fn create(path: &Path, existing: Existing) -> Result<Self, FolderError> {
        let Some(name) = path.file_name() else {
            return Err(FolderError::NoName { path: path.into() });
        };
        let mut partial_name = name.to_owned();
        partial_name.push(PARTIAL);
        let partial = path.with_file_name(partial_name);
        leftover::clean(path)?;
        // Reported at the start, not after hours of simulation.
        check_finished(path, existing)?;
        if partial.exists() {
            Self::clear_partial(&partial, path, existing)?;
        }
        if let Some(parent) = path.parent() {
            system("create", parent, fs::create_dir_all(parent))?;
        }
        system("create", &partial, fs::create_dir(&partial))?;
        let lock_path = partial.join(LOCK);
        let lock = system("create", &lock_path, File::create_new(&lock_path))?;
        system("lock", &lock_path, lock.lock())?;
        Ok(Self { partial, finished: path.into(), existing, lock })
    }

    /// Clears the partial folder of a run that was killed, so that the next one can begin. A run that is whole takes
    /// its name where the name is free.
    ///
    /// # Errors
    /// If a run is still written there, something there must not be replaced, or the operating system refuses.
    pub fn clear_partial(
        partial: &Path,
        finished: &Path,
        existing: Existing,
    ) -> Result<(), FolderError> {
        let lock_path = partial.join(LOCK);
        let lock = match File::open(&lock_path) {
            Ok(lock) => lock,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Self::clear_unmarked(partial, finished, existing);
            }
            Err(source) => {
                return Err(FolderError::System { action: "open", path: lock_path, source });
            }
        };
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(FolderError::Busy { path: partial.into() });
            }
            Err(TryLockError::Error(source)) => {
                return Err(FolderError::System { action: "lock", path: lock_path, source });
            }
        }
        match existing {
            Existing::Refuse => Err(FolderError::Unfinished { path: partial.into() }),
            Existing::Replace => leftover::discard(partial),
        }
    }

    /// Clears the remains of a kill without the lock: an empty folder, a complete run without its
    /// name, or a run whose lock was removed.
    fn clear_unmarked(
        partial: &Path,
        finished: &Path,
        existing: Existing,
    ) -> Result<(), FolderError> {
        match leftover::look(partial)? {
            // A run that starts at this moment loses its folder here, and reports it when it makes
            // its lock.
            Leftover::Empty => system("remove", partial, fs::remove_dir(partial)),
            Leftover::Whole if !finished.exists() => {
                system("rename", partial, fs::rename(partial, finished))?;
                check_finished(finished, existing)
            }
            Leftover::Whole | Leftover::Parts => match existing {
                Existing::Refuse => Err(FolderError::Unfinished { path: partial.into() }),
                Existing::Replace => leftover::discard(partial),
            },
            Leftover::Foreign => Err(FolderError::NotARun { path: partial.into(), expected: LOCK }),
        }
    }

    /// Path where the run is written.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.partial
    }

    /// Path of the run when it has ended.
    #[must_use]
    pub fn finished_path(&self) -> &Path {
        &self.finished
    }

    /// Gives the run its name. The manifest must be there.
    ///
    /// # Errors
    /// If there is no manifest, something has taken the name meanwhile, or the operating system
    /// refuses. The partial folder then stays.
    pub fn finish(self) -> Result<PathBuf, FolderError> {
        let Self { partial, finished, existing, lock } = self;
        let expected = MANIFEST;
        if !partial.join(expected).is_file() {
            return Err(FolderError::NotARun { path: partial, expected });
        }
        check_finished(&finished, existing)?;
        let lock_path = partial.join(LOCK);
        // Closed first: Windows doesn't rename a folder with an open file in it.
        drop(lock);
        system("remove", &lock_path, fs::remove_file(&lock_path))?;
        if finished.exists() {
            leftover::replace(&finished, &partial)?;
        } else {
            system("rename", &partial, fs::rename(&partial, &finished))?;
        }
        Ok(finished)
    }
}

/// Refuses a finished run in the way, or anything else that must not be touched.
fn check_finished(path: &Path, existing: Existing) -> Result<(), FolderError> {
    if !path.exists() {
        return Ok(());
    }
    let expected = MANIFEST;
    match existing {
        Existing::Refuse => Err(FolderError::Finished { path: path.into() }),
        Existing::Replace if path.join(expected).is_file() => Ok(()),
        Existing::Replace => Err(FolderError::NotARun { path: path.into(), expected }),
    }
}
