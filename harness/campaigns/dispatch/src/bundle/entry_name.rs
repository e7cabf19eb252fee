//! Names of the entries of a bundle.

use super::error::EntryNameError;
use octant_campaign::plan::FILE_NAME as PLAN;
use std::path::{Component, Path};

/// Name of the list, in a bundle and in the folder that is made from it.
pub const LIST: &str = "bundle.json";
/// Folder of the files, in both.
pub const FILES: &str = "files";

/// Checks the name of an entry: one of the two lists, or a file in the folder of its hash.
///
/// # Errors
/// If it is another name, or leads out of the bundle.
pub fn check(path: &str) -> Result<(), EntryNameError> {
    if path == PLAN || path == LIST {
        return Ok(());
    }
    if path.starts_with(['/', '\\']) || path.get(1..2) == Some(":") {
        return Err(EntryNameError::Absolute);
    }
    if path.split(['/', '\\']).any(|part| part == "..") {
        return Err(EntryNameError::Outside);
    }
    let parts: Vec<&str> = path.split('/').collect();
    let is_hash = |text: &str| {
        text.len() == 64 && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
    };
    match parts[..] {
        [FILES, hash, name] if is_hash(hash) && name == plain(name) => Ok(()),
        _ => Err(EntryNameError::Unknown),
    }
}

/// Returns a name that every system takes as the name of a file in a folder.
#[must_use]
pub fn plain(name: &str) -> String {
    let forbidden = |c: char| {
        c.is_control() || matches!(c, '/' | '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|')
    };
    let name: String = name.chars().map(|c| if forbidden(c) { '_' } else { c }).collect();
    let mut parts = Path::new(&name).components();
    match (parts.next(), parts.next()) {
        (Some(Component::Normal(_)), None) => name,
        _ => "file".to_owned(),
    }
}
