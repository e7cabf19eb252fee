//! One run at a time works on the cases of a folder: a second one would do the same work again, perhaps by another program.

use super::execution::ExecuteError;
use crate::plan::FILE_NAME;
use crate::plan::shard::Shard;
use crate::store::writer::FOLDER;
use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

/// Extension of the file that a run of a shard locks, beside the results of the shard.
const LOCK: &str = "lock";

/// The right to work on the cases of a shard, until it is dropped. A process that is killed loses it.
#[derive(Debug)]
pub(super) struct Running {
    #[expect(dead_code, reason = "its lock ends with it")]
    plan: Option<File>,
    #[expect(dead_code, reason = "it ends with it")]
    shard: Option<ShardLock>,
}

/// Locked file of a shard, which is removed at the end.
#[derive(Debug)]
struct ShardLock {
    path: PathBuf,
    #[expect(dead_code, reason = "its lock ends with it")]
    file: File,
}

impl Drop for ShardLock {
    fn drop(&mut self) {
        // While it is locked: nobody else can have the file that goes. One that stays does no harm.
        let _ = std::fs::remove_file(&self.path);
    }
}

impl Running {
    /// Takes the right to work on a shard: different shards may be worked on at once, each by one run, and nothing
    /// beside a whole campaign. Where the file system has no locks nothing tells of another run.
    pub(super) fn begin(folder: &Path, shard: Shard) -> Result<Self, ExecuteError> {
        // On systems other than Unix a lock would keep readers out.
        let plan = cfg!(unix).then(|| File::open(folder.join(FILE_NAME)).ok()).flatten();
        let Some(plan) = plan else { return Ok(Self { plan: None, shard: None }) };
        let is_whole = shard == Shard::WHOLE;
        let lock = if is_whole { plan.try_lock() } else { plan.try_lock_shared() };
        let running = || ExecuteError::Running { folder: folder.to_owned() };
        let is_locked = match lock {
            Err(TryLockError::WouldBlock) => return Err(running()),
            // A file system without locks doesn't tell.
            Ok(()) => true,
            Err(TryLockError::Error(_)) => false,
        };
        let shard = match is_locked && !is_whole {
            true => Some(lock_shard(folder, shard)?.ok_or_else(running)?),
            false => None,
        };
        Ok(Self { plan: Some(plan), shard })
    }
}

/// Locks the file of a shard; `None` if another run has it.
fn lock_shard(folder: &Path, shard: Shard) -> Result<Option<ShardLock>, ExecuteError> {
    let results = folder.join(FOLDER);
    let path = results.join(format!("{}.{LOCK}", shard.stem()));
    let failed = |action| {
        let path = path.clone();
        move |source| ExecuteError::System { action, path, source }
    };
    std::fs::create_dir_all(&results).map_err(failed("create the folder of"))?;
    let other_parts = format!("-of-{}.{LOCK}", shard.of);
    let locks = |folder: &Path| std::fs::read_dir(folder).into_iter().flatten().flatten();
    for other in locks(&results).map(|entry| entry.path()) {
        let name = other.file_name().unwrap_or_default().to_string_lossy();
        let is_other = name.ends_with(&format!(".{LOCK}")) && !name.ends_with(&other_parts);
        // Shards of another number share cases with this one.
        if is_other && File::open(&other).is_ok_and(|file| file.try_lock().is_err()) {
            return Ok(None);
        }
    }
    loop {
        let mut options = File::options();
        options.write(true).create(true).truncate(false);
        let file = options.open(&path).map_err(failed("open"))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => return Ok(None),
            Err(TryLockError::Error(source)) => return Err(failed("lock")(source)),
            Ok(()) => {}
        }
        // A run that ended in the meantime removed the file that was opened: the next one has to see this lock.
        if is_same(&file, &path) {
            return Ok(Some(ShardLock { path, file }));
        }
    }
}

#[cfg(unix)]
fn is_same(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let place = |found: std::fs::Metadata| (found.dev(), found.ino());
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(open), Ok(named)) => place(open) == place(named),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_same(_: &File, _: &Path) -> bool {
    true
}

/// Removes the lock files of runs that were killed, unless a run is at work.
pub fn remove_locks(folder: &Path) {
    let Ok(plan) = File::open(folder.join(FILE_NAME)) else { return };
    if cfg!(unix) && plan.try_lock().is_err() {
        return;
    }
    for entry in std::fs::read_dir(folder.join(FOLDER)).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.extension().is_some_and(|extension| extension == LOCK) {
            // One that stays is an empty file of the folder.
            let _ = std::fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn each_shard_has_one_run_and_nothing_works_beside_the_whole() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(FILE_NAME), "").unwrap();
        let shard = |text: &str| Shard::parse(text).unwrap();
        let begin = |shard| Running::begin(folder.path(), shard);
        let first = begin(shard("1/3")).unwrap();
        let error = begin(shard("1/3")).unwrap_err().to_string();
        assert!(error.contains("another octant campaign run works on it"), "{error}");
        assert!(begin(shard("2/4")).is_err(), "it has cases of the first of three");
        let second = begin(shard("2/3")).unwrap();
        assert!(begin(Shard::WHOLE).is_err());
        drop(first);
        let again = begin(shard("1/3")).unwrap();
        remove_locks(folder.path());
        assert!(begin(shard("1/3")).is_err(), "locks at work stay");
        drop((again, second));
        let whole = begin(Shard::WHOLE).unwrap();
        assert!(begin(shard("3/3")).is_err());
        drop(whole);
        // Nothing is left; and what a kill left goes.
        let results = folder.path().join(FOLDER);
        assert_eq!(std::fs::read_dir(&results).unwrap().count(), 0);
        std::fs::write(results.join("1-of-3.lock"), "").unwrap();
        drop(begin(shard("1/3")).unwrap());
        std::fs::write(results.join("2-of-3.lock"), "").unwrap();
        remove_locks(folder.path());
        assert_eq!(std::fs::read_dir(&results).unwrap().count(), 0);
    }
}
