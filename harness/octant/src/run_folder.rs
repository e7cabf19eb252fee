//! Names of run folders, and folders that are in the way.

use octant_evidence::FolderError;
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
