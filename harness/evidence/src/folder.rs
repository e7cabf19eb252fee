//! The folder of a run: written as `RUN.partial`, renamed to `RUN` when the run ends.
//!
//! A folder `RUN` always holds a complete run. A kill leaves `RUN.partial`, which is readable and
//! never taken for a finished run. A lock in it distinguishes a run in progress from one that was
//! killed.

pub use super::error::FolderError;
pub use super::names::LOCK;

use super::leftover::{self, Leftover, system};
use super::names::MANIFEST;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

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
        partial_name.push(".partial");
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

    fn clear_partial(
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
        let aside = if finished.exists() { Some(leftover::put_aside(&finished)?) } else { None };
        system("rename", &partial, fs::rename(&partial, &finished))?;
        // The run is there under its name: remains of the previous one are not its failure, and the
        // next run removes them.
        if let Some(aside) = aside {
            let _ = fs::remove_dir_all(aside);
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

    /// A run that is whole takes its name only where the name is free.
    #[test]
    fn a_whole_run_never_takes_the_place_of_a_finished_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("RUN");
        let run = RunFolder::create(&path, Existing::Refuse).unwrap();
        fs::write(run.path().join("manifest.json"), "whole").unwrap();
        fs::remove_file(run.path().join(LOCK)).unwrap();
        let partial = run.path().to_owned();
        drop(run);
        fs::create_dir(&path).unwrap();
        let error = RunFolder::clear_partial(&partial, &path, Existing::Refuse).unwrap_err();
        assert!(matches!(error, FolderError::Unfinished { .. }), "{error}");
        assert_eq!(fs::read_to_string(partial.join("manifest.json")).unwrap(), "whole");
    }

    #[cfg(unix)]
    #[test]
    fn a_lock_that_cannot_be_opened_is_no_missing_one() {
        let folder = tempfile::tempdir().unwrap();
        let partial = folder.path().join("RUN.partial");
        fs::create_dir(&partial).unwrap();
        std::os::unix::fs::symlink(LOCK, partial.join(LOCK)).unwrap();
        let error = RunFolder::create(&folder.path().join("RUN"), Existing::Replace).unwrap_err();
        assert!(matches!(error, FolderError::System { action: "open", .. }), "{error}");
    }

    /// Covers every state that a kill can leave: the next run starts, and only that run is there
    /// afterwards.
    #[test]
    fn what_kills_leave_is_cleaned_by_the_next_run() {
        type Left = fn(&Path);
        let make = |path: PathBuf, files: &[&str]| {
            fs::create_dir(&path).unwrap();
            files.iter().for_each(|name| fs::write(path.join(name), "old").unwrap());
        };
        let all: [(&str, Left); 7] = [
            ("the folder alone", |here| fs::create_dir(here.join("RUN.partial")).unwrap()),
            ("a run that is whole but for its name", |here| {
                let run = RunFolder::create(&here.join("RUN"), Existing::Refuse).unwrap();
                fs::write(run.path().join("manifest.json"), "old").unwrap();
                fs::remove_file(run.path().join(LOCK)).unwrap();
            }),
            ("a removal that was broken off", |here| {
                let path = here.join("RUN.partial");
                fs::create_dir(&path).unwrap();
                fs::write(path.join("recording.mcap"), "old").unwrap();
                fs::write(path.join(".octant-x.new"), "old").unwrap();
            }),
            ("a run put aside by an older version", |here| {
                let path = here.join("RUN.replaced");
                fs::create_dir(&path).unwrap();
                fs::write(path.join("manifest.json"), "old").unwrap();
            }),
            ("a run put aside, half removed", |here| {
                let run = here.join("RUN");
                fs::create_dir(&run).unwrap();
                fs::write(run.join("manifest.json"), "old").unwrap();
                let aside = super::leftover::put_aside(&run).unwrap();
                fs::remove_file(aside.join("manifest.json")).unwrap();
            }),
            ("both names gone, the new run whole", |here| {
                let run = RunFolder::create(&here.join("RUN"), Existing::Refuse).unwrap();
                fs::write(run.path().join("manifest.json"), "new").unwrap();
                fs::remove_file(run.path().join(LOCK)).unwrap();
                let path = here.join("RUN.replaced");
                fs::create_dir(&path).unwrap();
                fs::write(path.join("manifest.json"), "old").unwrap();
            }),
            ("a file that was not whole", |here| {
                let run = RunFolder::create(&here.join("RUN"), Existing::Refuse).unwrap();
                fs::write(run.path().join(".octant-y.new"), "old").unwrap();
            }),
        ];
        for (what, leave) in all {
            let folder = tempfile::tempdir().unwrap();
            leave(folder.path());
            finished(&folder.path().join("RUN"), "next");
            let names: Vec<_> =
                fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
            assert_eq!(names, ["RUN"], "{what}");
            assert_eq!(
                fs::read_to_string(folder.path().join("RUN/manifest.json")).unwrap(),
                "next",
                "{what}"
            );
        }
        // A foreign folder with such a name stays, and doesn't disturb the end of a run.
        let folder = tempfile::tempdir().unwrap();
        finished(&folder.path().join("RUN"), "one");
        make(folder.path().join("RUN.replaced"), &["thesis.tex"]);
        finished(&folder.path().join("RUN"), "two");
        assert!(folder.path().join("RUN.replaced/thesis.tex").exists());
        // Without --force a run that only lacked its name gets it, and stays.
        let folder = tempfile::tempdir().unwrap();
        make(folder.path().join("RUN.partial"), &["manifest.json"]);
        let error = RunFolder::create(&folder.path().join("RUN"), Existing::Refuse).unwrap_err();
        assert!(matches!(error, FolderError::Finished { .. }), "{error}");
        assert!(folder.path().join("RUN/manifest.json").exists());
        // A run that was put aside comes back if the new one never got its name.
        let folder = tempfile::tempdir().unwrap();
        make(folder.path().join("RUN"), &["manifest.json"]);
        super::leftover::put_aside(&folder.path().join("RUN")).unwrap();
        let error = RunFolder::create(&folder.path().join("RUN"), Existing::Refuse).unwrap_err();
        assert!(matches!(error, FolderError::Finished { .. }), "{error}");
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
        fs::write(folder.path().join("x.partial/thesis.tex"), "more of it").unwrap();
        let error = RunFolder::create(&folder.path().join("x"), Existing::Replace).unwrap_err();
        assert!(matches!(error, FolderError::NotARun { .. }), "{error}");
        let error = RunFolder::create(Path::new("/"), Existing::Replace).unwrap_err();
        assert!(matches!(error, FolderError::NoName { .. }), "{error}");
    }
}
