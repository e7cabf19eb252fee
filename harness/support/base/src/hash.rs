//! SHA-256 of files: the hash that other tools check with.

use sha2::{Digest, Sha256};
use std::io::{self, Read, Write};
use std::path::Path;

/// SHA-256 of a file, hexadecimal.
///
/// # Errors
/// If it can't be read.
pub fn sha256(path: &Path) -> io::Result<String> {
    let mut hasher = Sha256::new();
    io::copy(&mut std::fs::File::open(path)?, &mut hasher)?;
    Ok(hexadecimal(hasher))
}

/// Copies bytes, and returns the SHA-256 of the copied bytes, hexadecimal.
///
/// # Errors
/// If they can't be read or written.
pub fn sha256_of_copy(mut from: impl Read, mut to: impl Write) -> io::Result<String> {
    let mut hasher = Sha256::new();
    let mut buffer = vec![0; 1 << 16];
    loop {
        let count = match from.read(&mut buffer) {
            Ok(0) => return Ok(hexadecimal(hasher)),
            Ok(count) => count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        hasher.update(&buffer[..count]);
        to.write_all(&buffer[..count])?;
    }
}

fn hexadecimal(hasher: Sha256) -> String {
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
