//! SHA-256 of files: the hash that other tools check with.

use sha2::{Digest, Sha256};
use std::path::Path;

/// SHA-256 of a file, hexadecimal.
///
/// # Errors
/// If it can't be read.
pub fn sha256(path: &Path) -> std::io::Result<String> {
    let mut hasher = Sha256::new();
    std::io::copy(&mut std::fs::File::open(path)?, &mut hasher)?;
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}
