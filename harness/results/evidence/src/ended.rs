//! Summary of a run that has ended.
//!
//! A run writes its summary, then its manifest, and its folder loses `.partial` last. A kill may come between any two of
//! these steps, so that a summary alone is no result.

use super::error::ManifestError;
use super::files::MANIFEST;
use super::folder::PARTIAL;
use super::manifest::Manifest;
use super::statements::SUMMARY;
use octant_score::judge::derive;
use octant_score::summary::Summary;
use octant_verdict::Verdict;
use std::path::Path;

/// Reads the summary of a run that has ended; `None` for one that goes on or was killed before its folder was whole.
///
/// The summary has to be the one that the manifest names. A folder `RUN.partial` with a manifest is that of an interrupted
/// run, whose verdict is never a pass: one with a pass was killed before it got its name.
///
/// # Errors
/// If the manifest or the summary can't be read, or the summary isn't the one that the manifest names.
pub fn summary(folder: &Path) -> Result<Option<Summary>, ManifestError> {
    // Also a link or a folder of that name is looked at, and then refused.
    if std::fs::symlink_metadata(folder.join(MANIFEST)).is_err() {
        return Ok(None);
    }
    let bytes = Manifest::read(folder)?.read_file(folder, SUMMARY)?;
    let content = |reason: String| ManifestError::Content { path: folder.join(SUMMARY), reason };
    let text = String::from_utf8(bytes).map_err(|_| content("it isn't UTF-8 text".to_owned()))?;
    let summary = Summary::from_json(&text).map_err(|error| content(error.to_string()))?;
    let passes = derive(&summary).verdict <= Verdict::Pass;
    Ok(Some(summary).filter(|_| !(passes && is_partial(folder))))
}

/// Returns whether a folder has the name of an unfinished one, by whatever path it is given.
#[must_use]
pub fn is_partial(folder: &Path) -> bool {
    let named = |path: &Path| {
        path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(PARTIAL))
    };
    named(folder) || std::fs::canonicalize(folder).is_ok_and(|path| named(&path))
}
