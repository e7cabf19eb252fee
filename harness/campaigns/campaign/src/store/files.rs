//! Results in files of their own, as versions before part files wrote them.

use super::error::ResultPlace;
use std::path::{Path, PathBuf};

/// Folder of the files, in the folder of a campaign.
pub(super) const FOLDER: &str = "cases";

/// Returns the result file of a case in the folder of its campaign, as versions before part files wrote it.
#[must_use]
pub fn file(folder: &Path, id: &str) -> PathBuf {
    folder.join(FOLDER).join(id.get(..2).unwrap_or("")).join(format!("{id}.json"))
}

/// Lists the results: each with its case, and whether it is a second one, stored beside another.
pub(super) fn all(folder: &Path) -> Vec<(String, bool, ResultPlace)> {
    let read = |folder: PathBuf| std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut found: Vec<_> = read(folder.join(FOLDER))
        .flat_map(|part| read(part.path()))
        .filter_map(|entry| {
            let name = entry.file_name().to_string_lossy().into_owned();
            let name = name.strip_suffix(".json")?;
            let (id, rest) = name.split_once('.').unwrap_or((name, ""));
            let is_second = rest.starts_with("differs-");
            (is_second || rest.is_empty() && !id.is_empty())
                .then(|| (id.to_owned(), is_second, ResultPlace::File(entry.path())))
        })
        .collect();
    found.sort();
    found
}
