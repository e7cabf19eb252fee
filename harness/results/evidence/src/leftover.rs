//! Remains of a kill beside the folder of a run, and the recovery by the next run.
//!
//! A run is written in `RUN.partial` with a lock in it, and gets its name last. A run that it
//! replaces is first put aside under a hidden name, and then removed. A kill therefore leaves one
//! of these: `RUN.partial` with its lock; without lock and empty; without lock and complete; a
//! hidden folder `.octant-RUN.replaced…`, with or without `RUN` beside it. Older versions put aside
//! to `RUN.replaced` and removed a partial folder in place.

use super::error::FolderError;
use super::files::{LOCK, MANIFEST};
use std::ffi::OsString;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Prefix of the names of folders that await removal.
const HIDDEN: &str = ".octant-";
/// Part of the name of a run that another one replaces.
const REPLACED: &str = ".replaced";
/// Files that runs write first, or as their only file: a folder with other files isn't a run.
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

/// Content of a partial folder without a lock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leftover {
    /// The folder is empty.
    Empty,
    /// Complete run with its manifest, without its name.
    Whole,
    /// Some files of a run.
    Parts,
    /// Anything else.
    Foreign,
}

pub(super) fn system<T>(
    action: &'static str,
    path: &Path,
    result: io::Result<T>,
) -> Result<T, FolderError> {
    result.map_err(|source| FolderError::System { action, path: path.into(), source })
}

/// Classifies a partial folder without a lock.
pub(super) fn look(partial: &Path) -> Result<Leftover, FolderError> {
    let mut found = Leftover::Empty;
    for entry in system("list", partial, fs::read_dir(partial))? {
        let entry = system("list", partial, entry)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if name == MANIFEST && is_file {
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

/// Lists hidden names beside a folder: `.octant-RUN.replaced`, with a number if it is taken.
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

/// Renames a folder to a hidden name, which marks it for removal.
///
/// # Errors
/// If the operating system refuses.
pub fn put_aside(folder: &Path) -> Result<PathBuf, FolderError> {
    let aside = hidden(folder).find(|path| fs::symlink_metadata(path).is_err());
    let aside = aside.unwrap_or_else(|| folder.with_extension("octant-replaced"));
    system("rename", folder, fs::rename(folder, &aside))?;
    Ok(aside)
}

/// Replaces the folder of a run by another, which takes its name.
///
/// # Errors
/// If the operating system refuses. The previous run is back under its name then, or where the error says.
pub fn replace(folder: &Path, new: &Path) -> Result<(), FolderError> {
    let aside = put_aside(folder)?;
    if let Err(source) = fs::rename(new, folder) {
        let back = fs::rename(&aside, folder).is_ok();
        let old = if back { folder.to_owned() } else { aside };
        return Err(FolderError::NotReplaced { new: new.into(), path: folder.into(), old, source });
    }
    // The run is there under its name: remains of the previous one are not its failure, and the
    // next run removes them.
    let _ = fs::remove_dir_all(aside);
    Ok(())
}

/// Removes a folder; its name disappears in one step.
pub(super) fn discard(folder: &Path) -> Result<(), FolderError> {
    let aside = put_aside(folder)?;
    // If it can't be removed now, the next run tries again.
    let _ = fs::remove_dir_all(aside);
    Ok(())
}

/// Restores a state in which a run may begin, after a kill at any time.
pub(super) fn clean(run: &Path) -> Result<(), FolderError> {
    let mut partial = run.as_os_str().to_owned();
    partial.push(".partial");
    let partial = PathBuf::from(partial);
    let mut old = run.as_os_str().to_owned();
    old.push(REPLACED);
    let old = PathBuf::from(old);
    // A folder without a manifest is foreign.
    let is_run = |path: &Path| path.join(MANIFEST).is_file();
    let asides = hidden(run).take_while(|path| fs::symlink_metadata(path).is_ok());
    let asides: Vec<PathBuf> = asides.chain(is_run(&old).then_some(old)).collect();
    if asides.is_empty() {
        return Ok(());
    }
    // The kill came between the two renames: the new run is complete, or the previous one comes
    // back.
    if !run.exists() {
        let is_new = !partial.join(LOCK).exists() && is_run(&partial);
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
