//! Makes the folder of a campaign from a bundle.

use super::contents::{BundleContents, BundledFile};
use super::entry_name::{self, LIST};
use super::error::BundleError;
use octant_campaign::plan::{FILE_NAME as PLAN, Plan, short};
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;
use zip::ZipArchive;
use zip::result::ZipError;

/// Largest list of a bundle.
const LIST_BYTES: u64 = 256 << 20;

/// Unpacks a bundle into a new folder, and checks every file. The folder gets its name when it is
/// complete.
///
/// # Errors
/// If the bundle is damaged, of a newer version, or has an entry that isn't in its list or outside of its folder;
/// if something is in the folder; or if the operating system refuses. Then nothing is left under its
/// name.
pub fn unpack(bundle: &Path, folder: &Path) -> Result<BundleContents, BundleError> {
    let there =
        |reason: &str| BundleError::Exists { path: folder.to_owned(), reason: reason.to_owned() };
    match std::fs::read_dir(folder) {
        Ok(mut entries) => {
            if entries.next().is_some() {
                return Err(there("the folder isn't empty, expected a new one"));
            }
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
            return Err(there("a file is there, expected a new folder"));
        }
        Err(error) => return Err(BundleError::system("read", folder)(error)),
    }
    let file = File::open(bundle).map_err(BundleError::system("read", bundle))?;
    let mut archive = ZipArchive::new(BufReader::new(file)).map_err(|error| match error {
        ZipError::Io(source) if source.kind() != io::ErrorKind::UnexpectedEof => {
            BundleError::system("read", bundle)(source)
        }
        error => BundleError::Form {
            path: bundle.to_owned(),
            reason: format!("it is no whole bundle: {error}"),
        },
    })?;
    let contents = list(bundle, &mut archive)?;
    // Beside the folder: what is moved there is complete.
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty());
    let parent = parent.unwrap_or(Path::new("."));
    std::fs::create_dir_all(parent).map_err(BundleError::system("create", parent))?;
    let new = octant_base::whole_file::new_folder(parent)
        .map_err(BundleError::system("create a folder in", parent))?;
    for listed in &contents.files {
        extract(bundle, &mut archive, listed, new.path())?;
    }
    let list = new.path().join(LIST);
    std::fs::write(&list, contents.to_json()).map_err(BundleError::system("write", list))?;
    let plan = Plan::read(&new.path().join(PLAN))?;
    contents.check_plan(bundle, &plan, new.path())?;
    // The hashes of the plan are those of the files.
    plan.check_files()?;
    // An empty folder is replaced.
    let _ = std::fs::remove_dir(folder);
    std::fs::rename(new.path(), folder).map_err(BundleError::system("write", folder))?;
    // It has another name now.
    let _ = new.keep();
    Ok(contents)
}

type Archive = ZipArchive<BufReader<File>>;

fn wrong(bundle: &Path, entry: &str, reason: impl Into<String>) -> BundleError {
    BundleError::Entry { path: bundle.to_owned(), entry: entry.to_owned(), reason: reason.into() }
}

/// Reads the list, and checks that it lists the entries.
fn list(bundle: &Path, archive: &mut Archive) -> Result<BundleContents, BundleError> {
    let mut names = BTreeSet::new();
    for name in archive.file_names_raw() {
        let name = String::from_utf8_lossy(name).into_owned();
        entry_name::check(&name).map_err(|error| wrong(bundle, &name, error.to_string()))?;
        names.insert(name);
    }
    if !names.remove(LIST) {
        return Err(BundleError::Form {
            path: bundle.to_owned(),
            reason: format!(
                "found a ZIP archive without {LIST}, expected a bundle of octant campaign bundle"
            ),
        });
    }
    let mut bytes = Vec::new();
    let damaged =
        |error: &dyn std::fmt::Display| wrong(bundle, LIST, format!("is damaged: {error}"));
    let entry = archive.by_name(LIST).map_err(|error| damaged(&error))?;
    entry.take(LIST_BYTES).read_to_end(&mut bytes).map_err(|error| damaged(&error))?;
    let contents = BundleContents::from_json(bundle, &bytes)?;
    for file in &contents.files {
        if !names.remove(&file.path) {
            return Err(wrong(bundle, &file.path, "is listed and not there"));
        }
    }
    match names.first() {
        None => Ok(contents),
        Some(extra) => Err(wrong(bundle, extra, format!("is not in the list, {LIST}"))),
    }
}

/// Writes a file, and checks its content.
fn extract(
    bundle: &Path,
    archive: &mut Archive,
    listed: &BundledFile,
    folder: &Path,
) -> Result<(), BundleError> {
    let damaged =
        |error: &dyn std::fmt::Display| wrong(bundle, &listed.path, format!("is damaged: {error}"));
    let path = folder.join(&listed.path);
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent).map_err(BundleError::system("create", parent))?;
    }
    let mut file = File::create_new(&path).map_err(BundleError::system("create", &path))?;
    let mut entry = archive.by_name(&listed.path).map_err(|error| damaged(&error))?;
    let mut hasher = blake3::Hasher::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let count = entry.read(&mut buffer).map_err(|error| damaged(&error))?;
        let read = buffer.get(..count).unwrap_or_default();
        if read.is_empty() {
            break;
        }
        hasher.update(read);
        // Headers can lie about lengths: nothing beyond the list's is written.
        if hasher.count() > listed.bytes {
            let reason = format!("is longer than the list says, {} bytes", listed.bytes);
            return Err(wrong(bundle, &listed.path, reason));
        }
        file.write_all(read).map_err(BundleError::system("write", &path))?;
    }
    let found = hasher.finalize().to_hex();
    if found.as_str() != listed.blake3 {
        return Err(wrong(
            bundle,
            &listed.path,
            format!(
                "was changed: found BLAKE3 {}, expected {}",
                short(&found),
                short(&listed.blake3)
            ),
        ));
    }
    file.sync_all().map_err(BundleError::system("write", &path))
}
