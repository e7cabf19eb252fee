//! What a kill leaves beside the folder of a run, and how the next run goes on from it.
//!
//! A run is written in `RUN.partial` with a lock in it, and gets its name last. A run that it replaces is put
//! aside under a hidden name first, and removed after that. So a kill leaves one of: `RUN.partial` with its
//! lock; without it and empty; without it and whole; a hidden folder `.octant-RUN.replaced…`, beside `RUN` or
//! without it. Older versions put aside to `RUN.replaced` and removed a partial folder in its place.

use super::folder::{FolderError, system};
use super::manifest;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

/// Start of the names of what is only there until it is removed.
const HIDDEN: &str = ".octant-";
/// What a run that another replaces has in its name.
const REPLACED: &str = ".replaced";
/// Files that runs write first, or alone: a folder with others is no run.
const OF_RUNS: [&str; 12] = [
    "scenario.toml",
    "recording.mcap",
    "baseline.mcap",
    "summary.json",
    "junit.xml",
    "report.html",
    "calibration.octcal",
    "baseline.octcal",
    "manifest.json",
    "manifest.json.minisig",
    "values.csv",
    "messages.txt",
];

/// What a partial folder without a lock is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leftover {
    /// Nothing is in it.
    Empty,
    /// A run with its manifest, that lacks its name.
    Whole,
    /// Some files of a run.
    Parts,
    /// Something else.
    Foreign,
}

/// Looks at a partial folder without a lock.
pub(super) fn look(partial: &Path) -> Result<Leftover, FolderError> {
    let mut found = Leftover::Empty;
    for entry in system("list", partial, fs::read_dir(partial))? {
        let entry = system("list", partial, entry)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if name == manifest::FILE_NAME && is_file {
            return Ok(Leftover::Whole);
        }
        let is_new = name.starts_with(HIDDEN) && name.ends_with(".new");
        if found != Leftover::Foreign {
            let is_ours = is_file && (is_new || OF_RUNS.contains(&name.as_str()));
            found = if is_ours { Leftover::Parts } else { Leftover::Foreign };
        }
    }
    Ok(found)
}

/// A hidden name beside a folder: `.octant-RUN.replaced`, with a number where it is taken.
fn hidden(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let mut name = OsString::from(HIDDEN);
    name.push(folder.file_name().unwrap_or_default());
    name.push(REPLACED);
    (0..1000).map(move |n| {
        let mut name = name.clone();
        if n > 0 {
            name.push(format!(".{n}"));
        }
        folder.with_file_name(name)
    })
}

/// Gives a folder a hidden name, under which everybody knows it as something to be removed.
pub(super) fn put_aside(folder: &Path) -> Result<PathBuf, FolderError> {
    let aside = hidden(folder).find(|path| fs::symlink_metadata(path).is_err());
    let aside = aside.unwrap_or_else(|| folder.with_extension("octant-replaced"));
    system("rename", folder, fs::rename(folder, &aside))?;
    Ok(aside)
}

/// Removes a folder: in one step for whoever looks for it.
pub(super) fn discard(folder: &Path) -> Result<(), FolderError> {
    let aside = put_aside(folder)?;
    // What can't be removed now is tried again by the next run.
    let _ = fs::remove_dir_all(aside);
    Ok(())
}

/// Brings the folder of a run into one of the states that a run may begin in, after a kill at any time.
pub(super) fn clean(run: &Path) -> Result<(), FolderError> {
    let mut partial = run.as_os_str().to_owned();
    partial.push(".partial");
    let partial = PathBuf::from(partial);
    let mut old = run.as_os_str().to_owned();
    old.push(REPLACED);
    let old = PathBuf::from(old);
    // Of somebody else, where it has no manifest.
    let is_run = |path: &Path| path.join(manifest::FILE_NAME).is_file();
    let asides = hidden(run).take_while(|path| fs::symlink_metadata(path).is_ok());
    let asides: Vec<PathBuf> = asides.chain(is_run(&old).then_some(old)).collect();
    if asides.is_empty() {
        return Ok(());
    }
    // The kill came between the two names: the new run is whole, or the one before comes back.
    if !run.exists() {
        let is_new = !partial.join(super::LOCK).exists() && is_run(&partial);
        let from = if is_new { Some(&partial) } else { asides.iter().find(|path| is_run(path)) };
        if let Some(from) = from {
            system("rename", from, fs::rename(from, run))?;
        }
    }
    for aside in asides {
        if fs::symlink_metadata(&aside).is_ok() {
            let _ = fs::remove_dir_all(aside);
        }
    }
    Ok(())
}
