//! Campaigns: many cases of scenarios, planned, run anywhere, merged and judged.
//!
//! [`mod@file`] is what a user writes, [`plan`] the list of cases that it makes, [`case`] one of them run,
//! [`execute`] all of them, each in a process of its own, [`results`] their tables, [`merge`] those of all
//! shards.

pub mod case;
mod draw;
pub mod emit;
pub mod execute;
pub mod file;
mod make;
pub mod merge;
pub mod plan;
pub mod report;
pub mod requirements;
pub mod results;
pub mod status;
pub mod stop;
pub mod table;
pub mod trace;

/// A file that gets its name when it is whole; what others may read of it is as of any new file.
pub(crate) fn new_file(folder: &std::path::Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".").suffix(".new");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Puts a file in its place in one piece. One that is there already and the same isn't touched.
pub(crate) fn keep(path: &std::path::Path, bytes: &[u8]) -> std::io::Result<()> {
    if std::fs::read(path).is_ok_and(|there| there == bytes) {
        return Ok(());
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let new = new_file(folder.unwrap_or(std::path::Path::new(".")))?;
    std::fs::write(new.path(), bytes)?;
    new.persist(path)?;
    Ok(())
}
