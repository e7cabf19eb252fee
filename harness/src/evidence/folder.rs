//! The folder of a run: written as `RUN.partial`, renamed to `RUN` when the run ends.
//!
//! Who sees `RUN` sees a whole run. What a kill leaves is `RUN.partial`, readable and never taken
//! for a finished run. A lock in it tells a run that is going on from one that was killed.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// What to do with a folder that is there already.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Leave it, and fail.
    #[default]
    Refuse,
    /// Replace a run, finished or killed; anything else is left, and fails.
    Replace,
}

/// Why a run folder could not be made or finished.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// There is a finished run.
    #[error("create run folder {path}: it holds a run already")]
    Finished {
        /// The folder.
        path: PathBuf,
    },
    /// There is what a killed run left.
    #[error("create run folder {path}: a run that did not end left it")]
    Unfinished {
        /// The folder.
        path: PathBuf,
    },
    /// A run is being written there at this moment.
    #[error("create run folder {path}: another run is writing there")]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// There is something that is no run.
    #[error("replace {path}: it is not a run folder ({expected} is missing in it)")]
    NotARun {
        /// The folder.
        path: PathBuf,
        /// The file that a run has.
        expected: &'static str,
    },
    /// A path without a name, as `/` or `..`.
    #[error("create run folder {path}: expected a path that ends in a name")]
    NoName {
        /// The path.
        path: PathBuf,
    },
    /// The system refused.
    #[error("{action} {path}: {source}")]
    System {
        /// What was tried.
        action: &'static str,
        /// On what.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// Held while a run is written; removed before the folder gets its name.
pub(crate) const LOCK: &str = ".writing";

/// The folder of a run that is being written.
///
/// Dropped without [`RunFolder::finish`], the partial folder stays as it is.
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
    /// If there is something in the way that is not to be replaced, or the system refuses.
    pub fn create(path: &Path, existing: Existing) -> Result<Self, FolderError> {
        let Some(name) = path.file_name() else {
            return Err(FolderError::NoName { path: path.into() });
        };
        let mut partial_name = name.to_owned();
        partial_name.push(".partial");
        let partial = path.with_file_name(partial_name);
        // Said at the start, not after hours of simulation.
        check_finished(path, existing)?;
        if partial.exists() {
            Self::clear_partial(&partial, existing)?;
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

    fn clear_partial(partial: &Path, existing: Existing) -> Result<(), FolderError> {
        let lock_path = partial.join(LOCK);
        let lock = match File::open(&lock_path) {
            Ok(lock) => lock,
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                return Err(match existing {
                    Existing::Refuse => FolderError::Unfinished { path: partial.into() },
                    Existing::Replace => {
                        FolderError::NotARun { path: partial.into(), expected: LOCK }
                    }
                });
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
            Existing::Replace => system("remove", partial, fs::remove_dir_all(partial)),
        }
    }

    /// Where the run is written.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.partial
    }

    /// Where the run will be when it has ended.
    #[must_use]
    pub fn finished_path(&self) -> &Path {
        &self.finished
    }

    /// Gives the run its name. The manifest has to be there.
    ///
    /// # Errors
    /// If there is no manifest, something has taken the name meanwhile, or the system refuses. The
    /// partial folder is then still there.
    pub fn finish(self) -> Result<PathBuf, FolderError> {
        let Self { partial, finished, existing, lock } = self;
        let expected = super::manifest::FILE_NAME;
        if !partial.join(expected).is_file() {
            return Err(FolderError::NotARun { path: partial, expected });
        }
        check_finished(&finished, existing)?;
        let lock_path = partial.join(LOCK);
        // Closed first: Windows renames no folder with an open file in it.
        drop(lock);
        system("remove", &lock_path, fs::remove_file(&lock_path))?;
        if finished.exists() {
            let mut aside = finished.clone().into_os_string();
            aside.push(".replaced");
            let aside = PathBuf::from(aside);
            system("rename", &finished, fs::rename(&finished, &aside))?;
            system("rename", &partial, fs::rename(&partial, &finished))?;
            system("remove", &aside, fs::remove_dir_all(&aside))?;
        } else {
            system("rename", &partial, fs::rename(&partial, &finished))?;
        }
        Ok(finished)
    }
}

/// A finished run in the way, or something else that is not to be touched.
fn check_finished(path: &Path, existing: Existing) -> Result<(), FolderError> {
    if !path.exists() {
        return Ok(());
    }
    let expected = super::manifest::FILE_NAME;
    match existing {
        Existing::Refuse => Err(FolderError::Finished { path: path.into() }),
        Existing::Replace if path.join(expected).is_file() => Ok(()),
        Existing::Replace => Err(FolderError::NotARun { path: path.into(), expected }),
    }
}

fn system<T>(action: &'static str, path: &Path, result: io::Result<T>) -> Result<T, FolderError> {
    result.map_err(|source| FolderError::System { action, path: path.into(), source })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finished(path: &Path, content: &str) {
        let run = RunFolder::create(path, Existing::Replace).unwrap();
        fs::write(run.path().join("manifest.json"), content).unwrap();
        assert_eq!(run.finish().unwrap(), path);
    }

    #[test]
    fn a_run_gets_its_name_when_it_ends() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/RUN");
        let run = RunFolder::create(&path, Existing::Refuse).unwrap();
        assert_eq!(run.path(), folder.path().join("deep/RUN.partial"));
        assert!(!path.exists());
        let other = RunFolder::create(&path, Existing::Replace).unwrap_err();
        assert!(matches!(other, FolderError::Busy { .. }), "{other}");
        let path_of_run = run.path().to_owned();
        assert!(matches!(run.finish(), Err(FolderError::NotARun { .. })), "no manifest");
        assert!(path_of_run.exists());
        finished(&path, "one");
        assert!(!path_of_run.exists());
        assert!(!path.join(LOCK).exists());
    }

    #[test]
    fn a_finished_run_is_replaced_only_when_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("RUN");
        finished(&path, "one");
        let error = RunFolder::create(&path, Existing::Refuse).unwrap_err();
        assert!(matches!(error, FolderError::Finished { .. }), "{error}");
        finished(&path, "two");
        assert_eq!(fs::read_to_string(path.join("manifest.json")).unwrap(), "two");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left over");
    }

    #[test]
    fn what_a_kill_left_is_kept_until_told_otherwise() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("RUN");
        drop(RunFolder::create(&path, Existing::Refuse).unwrap());
        let error = RunFolder::create(&path, Existing::Refuse).unwrap_err();
        assert!(matches!(error, FolderError::Unfinished { .. }), "{error}");
        finished(&path, "one");
    }

    #[test]
    fn a_folder_that_is_no_run_is_never_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("home");
        fs::create_dir(&path).unwrap();
        fs::write(path.join("thesis.tex"), "years of work").unwrap();
        let error = RunFolder::create(&path, Existing::Replace).unwrap_err();
        assert!(matches!(error, FolderError::NotARun { .. }), "{error}");
        fs::create_dir(folder.path().join("x.partial")).unwrap();
        let error = RunFolder::create(&folder.path().join("x"), Existing::Replace).unwrap_err();
        assert!(matches!(error, FolderError::NotARun { .. }), "{error}");
        let error = RunFolder::create(Path::new("/"), Existing::Replace).unwrap_err();
        assert!(matches!(error, FolderError::NoName { .. }), "{error}");
    }
}
