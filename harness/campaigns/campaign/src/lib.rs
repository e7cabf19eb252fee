//! Campaigns: many cases of scenarios, planned, run anywhere, merged and judged.
//!
//! [`Campaign`](octant_scenario::campaign::Campaign) is the user's file, [`plan`] the list of its
//! cases, [`case`] runs one of them, [`execute`] all of them in processes that do the [`work`],
//! [`mod@store`] stores their results and reads them, [`results`] writes their tables, [`merge`] merges
//! those of all shards, [`independence`] groups them into independent draws.

pub mod against;
pub mod alike;
mod besides;
pub mod case;
pub mod case_id;
mod case_places;
mod case_states;
pub mod chain;
mod draw;
pub mod execute;
mod execution;
pub mod factor_values;
pub mod factors;
pub mod facts;
mod in_plan_order;
pub mod independence;
pub mod inside;
mod make;
pub mod merge;
pub mod plan;
mod plan_error;
pub mod planned;
pub mod process;
pub mod reexecute;
pub mod report;
pub mod requirements;
mod result_error;
pub mod results;
pub mod selection;
mod shard;
pub mod shared;
mod shared_cases;
pub mod sites;
mod spill;
pub mod status;
pub mod stop;
pub mod store;
mod stream_key;
pub mod sweep;
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

/// Gives a new file its name. An existing file with the same bytes isn't touched.
pub fn keep_new(path: &std::path::Path, new: tempfile::NamedTempFile) -> std::io::Result<()> {
    if !has_same_bytes(path, new.path())? {
        new.persist(path)?;
    }
    Ok(())
}

/// Returns whether a file is there with the bytes of another one.
fn has_same_bytes(path: &std::path::Path, new: &std::path::Path) -> std::io::Result<bool> {
    use std::io::{BufRead, BufReader};
    let Ok(there) = std::fs::File::open(path) else { return Ok(false) };
    let (mut there, mut new) = (BufReader::new(there), BufReader::new(std::fs::File::open(new)?));
    loop {
        // A file that can't be read is replaced.
        let Ok(of_there) = there.fill_buf() else { return Ok(false) };
        let of_new = new.fill_buf()?;
        let count = of_there.len().min(of_new.len());
        if count == 0 {
            return Ok(of_there.len() == of_new.len());
        }
        if of_there.get(..count) != of_new.get(..count) {
            return Ok(false);
        }
        there.consume(count);
        new.consume(count);
    }
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

    #[test]
    fn a_file_with_the_same_bytes_is_not_touched() {
        use std::io::Write as _;
        use std::os::unix::fs::MetadataExt as _;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let long = vec![7; 20_000];
        let inode = |bytes: &[u8]| {
            let mut new = new_file(folder.path()).unwrap();
            new.write_all(bytes).unwrap();
            keep_new(&path, new).unwrap();
            assert_eq!(std::fs::read(&path).unwrap(), bytes);
            std::fs::metadata(&path).unwrap().ino()
        };
        let first = inode(&long);
        assert_eq!(inode(&long), first);
        let mut other = long.clone();
        other[19_999] = 8;
        for bytes in [&other[..], &long[..10], &[], &long] {
            let before = std::fs::metadata(&path).unwrap().ino();
            assert_ne!(inode(bytes), before);
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}

// The tests name the crate as its users do. They are a part of its one test program.
#[cfg(test)]
extern crate self as octant_campaign;
#[cfg(test)]
#[path = "../tests/main.rs"]
mod outside;
