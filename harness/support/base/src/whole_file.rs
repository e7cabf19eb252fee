//! Files that are there whole or not at all: they are written under another name, and get their own when they are
//! complete.

use std::fs;
use std::io::{self, BufRead, BufReader};
use std::path::Path;
use tempfile::{Builder, NamedTempFile, TempDir};

/// Prefix and suffix of the name of an incomplete file.
const NEW: (&str, &str) = (".octant-", ".new");

/// Creates a file that gets its name when it is complete, with the permissions of any new file. The
/// file is locked while it is written, so that [`clean`] can tell it from the remains of a kill.
///
/// # Errors
/// If it can't be created.
pub fn new_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
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

/// Makes a folder with the permissions of any new one, which gets its name when it is complete; it is removed with
/// everything in it if it isn't kept.
///
/// # Errors
/// If it can't be made.
pub fn new_folder(parent: &Path) -> io::Result<TempDir> {
    let mut builder = Builder::new();
    builder.prefix(NEW.0).suffix(NEW.1);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
    builder.tempdir_in(parent)
}

/// Removes incomplete files that a kill left. Files that are being written stay.
pub fn clean(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if !(cfg!(unix) && name.starts_with(NEW.0) && name.ends_with(NEW.1)) {
            continue;
        }
        let path = entry.path();
        // A file that can't be opened, locked or removed stays: its name marks it as incomplete.
        if let Ok(file) = fs::File::options().write(true).open(&path)
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(&path);
        }
    }
}

/// Writes a file atomically. An existing file with the same bytes isn't touched.
///
/// # Errors
/// If it can't be written.
pub fn keep(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if fs::read(path).is_ok_and(|there| there == bytes) {
        return Ok(());
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    clean(folder);
    let new = new_file(folder)?;
    fs::write(new.path(), bytes)?;
    new.persist(path)?;
    Ok(())
}

/// Gives a new file its name. An existing file with the same bytes isn't touched.
///
/// # Errors
/// If it can't be compared or renamed.
pub fn keep_new(path: &Path, new: NamedTempFile) -> io::Result<()> {
    if !has_same_bytes(path, new.path())? {
        new.persist(path)?;
    }
    Ok(())
}

/// Returns whether a file is there with the bytes of another one.
fn has_same_bytes(path: &Path, new: &Path) -> io::Result<bool> {
    let Ok(there) = fs::File::open(path) else { return Ok(false) };
    let (mut there, mut new) = (BufReader::new(there), BufReader::new(fs::File::open(new)?));
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
