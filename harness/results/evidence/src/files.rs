//! Lists a folder of evidence: regular files with their hashes, and everything that doesn't belong
//! there.
//!
//! Only regular files are ever opened: a FIFO would wait for a writer for ever, a device may do
//! anything, and a link leads to content elsewhere.

use super::error::ManifestError;
pub(crate) use octant_base::regular::open;
pub use octant_base::regular::read;
use octant_base::regular::what;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read};
use std::path::Path;

/// Name of the manifest in a run folder.
pub const MANIFEST: &str = "manifest.json";
/// Name of the signature beside a manifest.
pub const SIGNATURE: &str = "manifest.json.minisig";
/// Name of the second person's signature beside the dispositions of a campaign.
pub const SECOND: &str = "dispositions.toml.minisig";
/// Lock file, held while a run is written; removed before the folder gets its name.
pub const LOCK: &str = ".writing";

/// A file with its hashes.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FileHash {
    /// Path in the folder, with `/`.
    pub path: String,
    /// Size.
    pub bytes: u64,
    /// BLAKE3, hexadecimal.
    pub blake3: String,
    /// SHA-256, hexadecimal.
    pub sha256: String,
}

/// Entries of a folder, by path with `/`; without the manifest, its signature, the second person's
/// signature, and the lock of a running run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Entries {
    /// Regular files.
    pub files: BTreeSet<String>,
    /// Empty folders.
    pub empty: BTreeSet<String>,
    /// Links, devices and the like, with their kind.
    pub others: BTreeMap<String, &'static str>,
    /// True if the lock is there: a run is in progress, or was killed.
    pub locked: bool,
}

impl Entries {
    /// Lists a folder and its subfolders. Links are not followed.
    pub(crate) fn of(folder: &Path) -> Result<Self, ManifestError> {
        let mut found = Self::default();
        let mut open = vec![String::new()];
        while let Some(prefix) = open.pop() {
            let path = folder.join(&prefix);
            let mut entries = 0;
            for entry in system("list", &path, std::fs::read_dir(&path))? {
                let entry = system("list", &path, entry)?;
                let kind = system("list", &path, entry.file_type())?;
                entries += 1;
                let name = entry.file_name();
                let Some(text) = name.to_str() else {
                    let name = format!("{prefix}{}", name.to_string_lossy());
                    found.others.insert(name, "a name that is no text");
                    continue;
                };
                let name = format!("{prefix}{text}");
                if kind.is_dir() {
                    open.push(format!("{name}/"));
                } else if !kind.is_file() {
                    found.others.insert(name, what(kind));
                } else if name == LOCK {
                    found.locked = true;
                } else if ![MANIFEST, SIGNATURE, SECOND].contains(&name.as_str()) {
                    found.files.insert(name);
                }
            }
            if entries == 0 && !prefix.is_empty() {
                found.empty.insert(prefix.trim_end_matches('/').to_owned());
            }
        }
        Ok(found)
    }
}

/// Hashes a file of a folder.
pub(crate) fn hash(folder: &Path, path: &str) -> Result<FileHash, ManifestError> {
    let full = folder.join(path);
    let mut file = system("read", &full, open(&full))?;
    let (mut blake3, mut sha256, mut bytes) = (blake3::Hasher::new(), Sha256::new(), 0);
    let mut buffer = vec![0; 1 << 17];
    loop {
        let n = system("read", &full, file.read(&mut buffer))?;
        if n == 0 {
            break;
        }
        bytes += n as u64;
        blake3.update(&buffer[..n]);
        sha256.update(&buffer[..n]);
    }
    Ok(FileHash {
        path: path.into(),
        bytes,
        blake3: blake3.finalize().to_hex().to_string(),
        sha256: sha256.finalize().iter().map(|byte| format!("{byte:02x}")).collect(),
    })
}

pub(super) fn system<T>(
    action: &'static str,
    path: &Path,
    result: io::Result<T>,
) -> Result<T, ManifestError> {
    result.map_err(|source| ManifestError::System { action, path: path.into(), source })
}
