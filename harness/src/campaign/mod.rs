//! Campaigns: many cases of scenarios, planned, run anywhere, merged and judged.
//!
//! [`mod@file`] is what a user writes, [`plan`] the list of cases that it makes, [`case`] one of them run,
//! [`execute`] all of them, each in a process of its own, [`results`] their tables, [`merge`] those of all
//! shards, [`independence`] which of them are one draw.

pub mod case;
pub mod chain;
mod draw;
pub mod emit;
pub mod execute;
pub mod file;
pub mod independence;
pub mod inside;
mod make;
pub mod merge;
pub mod plan;
pub(crate) mod process;
pub mod reexecute;
pub mod report;
pub mod requirements;
pub mod results;
pub mod status;
pub mod stop;
pub mod table;
pub mod trace;

/// Start and end of the name of a file that isn't whole yet.
const NEW: (&str, &str) = (".octant-", ".new");

/// A file that gets its name when it is whole; what others may read of it is as of any new file. It is
/// locked while it is written, so that [`clean`] tells it from one that a kill left.
pub(crate) fn new_file(folder: &std::path::Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(NEW.0).suffix(NEW.1);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    loop {
        let new = builder.tempfile_in(folder)?;
        // A file system without locks keeps what a kill leaves. On others than Unix a lock would keep
        // the writer out too.
        let is_locked = cfg!(unix) && new.as_file().lock().is_ok();
        // Taken for left between the two: another one.
        if !is_locked || new.path().try_exists()? {
            return Ok(new);
        }
    }
}

/// Removes files that a kill left before they were whole. Those that are being written stay.
pub(crate) fn clean(folder: &std::path::Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if !(cfg!(unix) && name.starts_with(NEW.0) && name.ends_with(NEW.1)) {
            continue;
        }
        let path = entry.path();
        // A file that can't be opened, locked or removed stays: nobody takes it for a whole one.
        if let Ok(file) = std::fs::File::options().write(true).open(&path)
            && file.try_lock().is_ok()
        {
            let _ = std::fs::remove_file(&path);
        }
    }
}

/// Puts a file in its place in one piece. One that is there already and the same isn't touched.
pub(crate) fn keep(path: &std::path::Path, bytes: &[u8]) -> std::io::Result<()> {
    if std::fs::read(path).is_ok_and(|there| there == bytes) {
        return Ok(());
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(std::path::Path::new("."));
    clean(folder);
    let new = new_file(folder)?;
    std::fs::write(new.path(), bytes)?;
    new.persist(path)?;
    Ok(())
}

#[cfg(test)]
#[cfg(unix)]
mod tests {
    use super::*;

    #[test]
    fn what_a_kill_left_is_removed_and_what_is_written_stays() {
        let folder = tempfile::tempdir().unwrap();
        let written = new_file(folder.path()).unwrap();
        let left = new_file(folder.path()).unwrap();
        // A kill gives the lock back, and leaves the file.
        let (file, left) = left.keep().unwrap();
        drop(file);
        clean(folder.path());
        assert!(written.path().exists() && !left.exists());
    }
}
