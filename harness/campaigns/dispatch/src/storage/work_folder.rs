//! The local folder in which a command works on a campaign of object storage.

use super::error::StorageError;
use super::layout::{BUNDLE, RESULTS, SegmentName, may_share};
use super::objects::Storage;
use crate::bundle::contents::BundleContents;
use crate::bundle::entry_name::LIST;
use crate::bundle::error::BundleError;
use crate::bundle::unpack::unpack;
use octant_campaign::execute::Shard;
use octant_campaign::store::segment::shards;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::path::{Component, Path, PathBuf};
use tempfile::TempDir;

/// Objects that a command needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorkScope {
    /// The plan and its files.
    Plan,
    /// These, and every result that the worker of a shard can have, or an earlier one in the same folder.
    Shard(Shard),
    /// The plan, its files and every result.
    Results,
    /// These, and every other file of the folder: tables, report, evidence.
    All,
}

/// A folder of the campaign, made from its objects.
#[derive(Debug)]
pub struct WorkFolder {
    path: PathBuf,
    /// The folder, if it goes with this value.
    temporary: Option<TempDir>,
    /// Paths of the files that come from the bundle.
    bundled: BTreeSet<String>,
    /// Segments that are there.
    pub(crate) segments: Vec<SegmentName>,
}

impl WorkFolder {
    /// Makes a folder with what a command needs: the one that is given, or a temporary one that goes with
    /// this value.
    ///
    /// A given folder may have been made from the same bundle before. Its part files stay; its segments are those
    /// of the storage afterwards.
    ///
    /// # Errors
    /// If the storage has no campaign or refuses, if an object is damaged, or if the folder is of another campaign.
    pub fn fetch(
        storage: &Storage,
        given: Option<&Path>,
        scope: WorkScope,
    ) -> Result<Self, StorageError> {
        let absent = || StorageError::Absent { object: storage.address().of(BUNDLE) };
        let bundle = storage.get(BUNDLE)?.ok_or_else(absent)?;
        let (path, temporary) = match given {
            Some(path) => (path.to_owned(), None),
            None => {
                let new = tempfile::Builder::new().prefix("octant-").tempdir();
                let new = new.map_err(StorageError::system("create", &std::env::temp_dir()))?;
                (new.path().join("campaign"), Some(new))
            }
        };
        let contents = unbundle(storage, &bundle, &path)?;
        let bundled = contents.files.into_iter().map(|file| file.path).chain([LIST.to_owned()]);
        let mut work = Self { path, temporary, bundled: bundled.collect(), segments: Vec::new() };
        match scope {
            WorkScope::Plan => {}
            WorkScope::Shard(_) | WorkScope::Results => {
                let listed = storage.list(RESULTS)?;
                work.fetch_segments(storage, &listed, scope)?;
            }
            WorkScope::All => {
                let mut listed = storage.list("")?;
                work.fetch_segments(storage, &listed, scope)?;
                listed.retain(|name, _| name != BUNDLE && SegmentName::parse(name).is_none());
                work.fetch_others(storage, &listed)?;
            }
        }
        Ok(work)
    }

    /// Returns the folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Keeps a temporary folder, and returns its path.
    pub fn keep(&mut self) -> &Path {
        if let Some(temporary) = self.temporary.take() {
            let _ = temporary.keep();
        }
        &self.path
    }

    /// Writes every file of the folder that comes neither from the bundle nor from segments, and returns their
    /// addresses. Part files of workers are left out, which are uploaded as segments.
    ///
    /// # Errors
    /// If the storage refuses, or a file can't be read.
    pub fn put_back(&self, storage: &Storage) -> Result<Vec<String>, StorageError> {
        let mut names = Vec::new();
        files(&self.path, "", &mut names)?;
        names.retain(|name| !self.bundled.contains(name) && !is_result(name));
        names.sort();
        for name in &names {
            let path = self.path.join(name);
            let bytes = std::fs::read(&path).map_err(StorageError::system("read", &path))?;
            storage.put(name, bytes)?;
        }
        Ok(names.iter().map(|name| storage.address().of(name)).collect())
    }

    /// Reads the segments into the folder of results, and removes those that aren't on the storage any more.
    fn fetch_segments(
        &mut self,
        storage: &Storage,
        listed: &BTreeMap<String, u64>,
        scope: WorkScope,
    ) -> Result<(), StorageError> {
        let workers = match scope {
            WorkScope::Shard(shard) => {
                let mut shards = shards(&self.path)?;
                shards.insert(shard);
                Some(shards)
            }
            _ => None,
        };
        let is_needed = |name: &SegmentName| {
            workers.as_ref().is_none_or(|all| all.iter().any(|shard| may_share(name.shard, *shard)))
        };
        let names = listed.keys().filter_map(|name| SegmentName::parse(name));
        self.segments = names.filter(is_needed).collect();
        let folder = self.path.join(octant_campaign::store::writer::FOLDER);
        let files: BTreeMap<String, String> =
            self.segments.iter().map(|name| (name.object(), name.file())).collect();
        let kept: BTreeSet<&String> = files.values().collect();
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if SegmentName::is_file(&name) && !kept.contains(&name) {
                let path = entry.path();
                std::fs::remove_file(&path).map_err(StorageError::system("remove", &path))?;
            }
        }
        let objects: Vec<String> = files.keys().cloned().collect();
        storage.get_all(&objects, |name, bytes| write(&folder.join(&files[name]), &bytes))
    }

    fn fetch_others(
        &self,
        storage: &Storage,
        listed: &BTreeMap<String, u64>,
    ) -> Result<(), StorageError> {
        let mut names = Vec::new();
        for name in listed.keys() {
            let is_inside = !name.is_empty()
                && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
            let is_other = is_result(name) || name.ends_with(&format!("/{BUNDLE}"));
            if !is_inside || self.bundled.contains(name) || is_other {
                return Err(StorageError::Form {
                    object: storage.address().of(name),
                    reason:
                        "found an object that no command of octant writes, expected bundle.zip, \
                             results/K-of-N/NUMBER.octres and files of the campaign's folder"
                            .to_owned(),
                });
            }
            names.push(name.clone());
        }
        storage.get_all(&names, |name, bytes| write(&self.path.join(name), &bytes))
    }
}

/// Returns whether the path of a file is one of stored results.
fn is_result(name: &str) -> bool {
    name.strip_prefix(RESULTS).is_some_and(|rest| rest.starts_with('/'))
}

/// Makes the folder of a campaign from the bytes of its bundle, or checks that it was made from them.
fn unbundle(storage: &Storage, bundle: &[u8], path: &Path) -> Result<BundleContents, StorageError> {
    let there = BundleContents::of_folder(path)?;
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    let parent = parent.unwrap_or(Path::new("."));
    std::fs::create_dir_all(parent).map_err(StorageError::system("create", parent))?;
    let scratch = tempfile::Builder::new().prefix(".octant-").tempdir_in(parent);
    let scratch = scratch.map_err(StorageError::system("create a folder in", parent))?;
    let file = scratch.path().join(BUNDLE);
    write(&file, bundle)?;
    let form = |error: BundleError| StorageError::Form {
        object: storage.address().of(BUNDLE),
        reason: error.to_string(),
    };
    let Some(there) = there else {
        return unpack(&file, path).map_err(|error| match error {
            // The folder is to blame, which is the user's.
            BundleError::Exists { .. } | BundleError::System { .. } => error.into(),
            error => form(error),
        });
    };
    let contents = unpack(&file, &scratch.path().join("new")).map_err(form)?;
    if contents == there {
        return Ok(contents);
    }
    Err(StorageError::Work {
        path: path.to_owned(),
        reason: format!(
            "found a folder of another bundle than {}, expected a new folder or that of this campaign",
            storage.address().of(BUNDLE)
        ),
    })
}

/// Writes a file, which gets its name when it is complete.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), StorageError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(StorageError::system("create", folder))?;
    let write = || -> std::io::Result<()> {
        let mut new = octant_base::whole_file::new_file(folder)?;
        new.write_all(bytes)?;
        new.persist(path)?;
        Ok(())
    };
    write().map_err(StorageError::system("write", path))
}

/// Lists the files in a folder by their paths from it, with forward slashes.
fn files(folder: &Path, from: &str, found: &mut Vec<String>) -> Result<(), StorageError> {
    let read = |error| StorageError::system("read", folder)(error);
    for entry in std::fs::read_dir(folder).map_err(read)? {
        let entry = entry.map_err(read)?;
        let name = entry.file_name();
        let name = name.to_str().ok_or_else(|| StorageError::Work {
            path: entry.path(),
            reason: "found a name that isn't UTF-8, expected one that an object can have"
                .to_owned(),
        })?;
        // Incomplete files of a kill.
        if name.starts_with(".octant-") {
            continue;
        }
        let path = if from.is_empty() { name.to_owned() } else { format!("{from}/{name}") };
        if entry.path().is_dir() {
            files(&entry.path(), &path, found)?;
        } else {
            found.push(path);
        }
    }
    Ok(())
}
