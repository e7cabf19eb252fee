//! The secret that two ends share, in a file.

use super::seal::SECRET_LEN_MIN;

/// Reads a secret: the bytes of a file, without the end of its last line.
///
/// # Errors
/// In words, if the file can't be read, can be read by others than its owner, or has too few bytes.
pub(super) fn secret_in(file: &str) -> Result<Vec<u8>, String> {
    let cant = |error: std::io::Error| format!("read the secret in {file}: {error}");
    let mut secret = std::fs::read(file).map_err(cant)?;
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        let mode = std::fs::metadata(file).map_err(cant)?.permissions().mode() & 0o777;
        if mode & 0o077 != 0 {
            return Err(format!(
                "the secret in {file} is open to other users, found mode {mode:03o}, expected 600"
            ));
        }
    }
    while matches!(secret.last(), Some(b'\n' | b'\r')) {
        secret.pop();
    }
    if secret.len() < SECRET_LEN_MIN {
        return Err(format!(
            "the secret in {file} has {} bytes, expected {SECRET_LEN_MIN} or more",
            secret.len()
        ));
    }
    Ok(secret)
}
