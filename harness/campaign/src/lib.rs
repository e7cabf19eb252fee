//! Campaigns: many cases of scenarios, planned, run anywhere, merged and judged.
//!
//! [`Campaign`](octant_scenario::campaign::Campaign) is the user's file, [`plan`] the list of its
//! cases, [`case`] runs one of them, [`execute`] all of them in processes that do the [`work`],
//! [`mod@store`] stores their results and reads them, [`results`] writes their tables, [`merge`] merges
//! those of all shards, [`independence`] groups them into independent draws.

pub mod against;
pub mod alike;
mod besides;
pub mod bundle;
pub mod case;
pub mod chain;
mod draw;
pub mod emit;
pub mod execute;
mod execution;
pub mod factor_values;
pub mod factors;
pub mod facts;
pub mod independence;
pub mod inside;
mod make;
pub mod merge;
pub mod page;
pub mod plan;
mod plan_error;
mod planned;
pub mod process;
pub mod reexecute;
pub mod report;
pub mod requirements;
mod result_error;
pub mod results;
pub mod selection;
mod shard;
pub mod sites;
mod spill;
pub mod status;
pub mod stop;
pub mod store;
pub mod sweep;
pub mod sweep_page;
pub mod table;
mod table_rows;
pub mod trace;
pub mod work;
mod worker;

/// Prefix and suffix of the name of an incomplete file.
const NEW: (&str, &str) = (".octant-", ".new");

/// Creates a file that gets its name when it is complete, with the permissions of any new file. The
/// file is locked while it is written, so that [`clean`] can tell it from the remains of a kill.
pub fn new_file(folder: &std::path::Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(NEW.0).suffix(NEW.1);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    loop {
        let new = builder.tempfile_in(folder)?;
        // On a file system without locks the remains of a kill stay. On systems other than Unix a
        // lock would keep the writer out too.
        let is_locked = cfg!(unix) && new.as_file().lock().is_ok();
        // If [`clean`] removed the file before it was locked, another one is made.
        if !is_locked || new.path().try_exists()? {
            return Ok(new);
        }
    }
}

/// Removes incomplete files that a kill left. Files that are being written stay.
pub fn clean(folder: &std::path::Path) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if !(cfg!(unix) && name.starts_with(NEW.0) && name.ends_with(NEW.1)) {
            continue;
        }
        let path = entry.path();
        // A file that can't be opened, locked or removed stays: its name marks it as incomplete.
        if let Ok(file) = std::fs::File::options().write(true).open(&path)
            && file.try_lock().is_ok()
        {
            let _ = std::fs::remove_file(&path);
        }
    }
}

/// Writes a file atomically. An existing file with the same bytes isn't touched.
pub fn keep(path: &std::path::Path, bytes: &[u8]) -> std::io::Result<()> {
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
        // A kill releases the lock, and leaves the file.
        let (file, left) = left.keep().unwrap();
        drop(file);
        clean(folder.path());
        assert!(written.path().exists() && !left.exists());
    }
}
