//! Names of run folders, folders that are in the way, and runs that are named by a folder or a recording.

use crate::failure::Failure;
use octant_evidence::FolderError;
use octant_watch::place::RunPlace;
use std::path::{Path, PathBuf};

/// Describes why the folder can't be made, with the option that replaces the existing one.
pub(crate) fn in_the_way(error: &FolderError) -> String {
    match error {
        FolderError::Finished { .. } | FolderError::Unfinished { .. } => {
            format!("{error}; --out DIR --force replaces it")
        }
        _ => error.to_string(),
    }
}

/// Returns an unused folder in ./runs.
pub(crate) fn free_name(scenario: &Path) -> PathBuf {
    let stem = scenario.file_stem().map_or("run".into(), |stem| stem.to_string_lossy());
    let name = |n: u32| {
        Path::new("runs").join(if n == 1 { stem.to_string() } else { format!("{stem}-{n}") })
    };
    let taken = |path: &PathBuf| {
        let mut partial = path.clone().into_os_string();
        partial.push(".partial");
        path.exists() || Path::new(&partial).exists()
    };
    (1..).map(name).find(|path| !taken(path)).unwrap_or_else(|| name(1))
}

/// Returns the recording of a run that is named by its folder or by a recording.
pub(crate) fn recording_of(run: &Path) -> Result<PathBuf, Failure> {
    // A recording may have any name.
    if run.is_file() {
        return Ok(run.to_owned());
    }
    let place = RunPlace::of(run).map_err(|error| Failure::input(error).failed())?;
    place.recording().ok_or_else(|| {
        Failure::input(format!("{}: nothing is recorded yet", place.folder().display()))
    })
}

/// Returns the folder of a run that is named by its folder or by a recording in it.
pub(crate) fn folder_of(run: &Path) -> &Path {
    if !(run.is_file() && run.extension().is_some_and(|extension| extension == "mcap")) {
        return run;
    }
    match run.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
