//! Regular files, opened as nothing else.
//!
//! Others may write into a folder that is read here. A link leads to content elsewhere, a FIFO waits for a writer for ever, a
//! device may do anything.

use std::fs::{File, FileType};
use std::io::{self, Read};
use std::path::Path;

/// Opens a regular file and nothing else, even if the entry is replaced at this moment.
///
/// # Errors
/// If it is no regular file, or can't be opened.
pub fn open(path: &Path) -> io::Result<File> {
    refuse_other(std::fs::symlink_metadata(path)?.file_type())?;
    let mut options = File::options();
    options.read(true);
    #[cfg(unix)]
    {
        use rustix::fs::OFlags;
        use std::os::unix::fs::OpenOptionsExt;
        let flags = OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::NOCTTY;
        options.custom_flags(i32::try_from(flags.bits()).unwrap_or(0));
    }
    let file = options.open(path)?;
    refuse_other(file.metadata()?.file_type())?;
    Ok(file)
}

/// Reads a regular file.
///
/// # Errors
/// As [`open`], and if it can't be read.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Refuses what is no regular file.
///
/// # Errors
/// If it isn't one: what was found.
pub fn refuse_other(kind: FileType) -> io::Result<()> {
    if kind.is_file() {
        return Ok(());
    }
    let what = if kind.is_dir() { "a folder" } else { what(kind) };
    let reason = format!("it is {what}, expected a regular file");
    Err(io::Error::new(io::ErrorKind::InvalidInput, reason))
}

/// Names the kind of an entry that is neither a file nor a folder.
#[must_use]
pub fn what(kind: FileType) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return "a FIFO";
        }
        if kind.is_socket() {
            return "a socket";
        }
        if kind.is_block_device() || kind.is_char_device() {
            return "a device";
        }
    }
    if kind.is_symlink() { "a link" } else { "no regular file" }
}
