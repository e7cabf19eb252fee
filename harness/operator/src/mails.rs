//! Folder of requests and replies, held open.
//!
//! Whoever may write into the run's folder may plant links there. On Unix the folder itself is held, its files are named from
//! it and opened without following links, and a new file never takes the place of another: nothing outside is read or
//! written, whatever is planted at any moment.

use octant_base::regular::refuse_other;
use serde::Serialize;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Most bytes of a request or a reply.
const LARGEST: u64 = 1 << 16;

/// Folder of requests and replies.
#[derive(Debug)]
pub(crate) struct Mails {
    folder: PathBuf,
    #[cfg(unix)]
    held: std::os::fd::OwnedFd,
}

impl Mails {
    /// Opens the folder.
    ///
    /// # Errors
    /// If it isn't there, or something else has its name.
    pub(crate) fn open(folder: &Path) -> io::Result<Self> {
        let kind = std::fs::symlink_metadata(folder)?.file_type();
        if !kind.is_dir() {
            let what = if kind.is_symlink() { "a link" } else { "no folder" };
            let reason = format!("it is {what}, expected a folder");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
        Ok(Self {
            #[cfg(unix)]
            held: unix::folder(folder)?,
            folder: folder.to_owned(),
        })
    }

    /// Lists the names in the folder.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub(crate) fn names(&self) -> io::Result<Vec<String>> {
        #[cfg(unix)]
        return unix::names(&self.held);
        #[cfg(not(unix))]
        {
            let entries = std::fs::read_dir(&self.folder)?;
            Ok(entries.flatten().map(|e| e.file_name().to_string_lossy().into_owned()).collect())
        }
    }

    /// Reads a file.
    ///
    /// # Errors
    /// If it isn't there, is no regular file, is too long, or isn't UTF-8.
    pub(crate) fn read(&self, name: &str) -> io::Result<String> {
        #[cfg(unix)]
        let file = unix::open(&self.held, name)?;
        #[cfg(not(unix))]
        let file = octant_base::regular::open(&self.folder.join(name))?;
        let mut text = String::new();
        file.take(LARGEST + 1).read_to_string(&mut text)?;
        if text.len() as u64 > LARGEST {
            let reason = format!("it is longer than {LARGEST} bytes");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
        Ok(text)
    }

    /// Writes a file whole.
    ///
    /// # Errors
    /// If something has the name of its draft, or the operating system refuses.
    pub(crate) fn put(&self, name: &str, content: &impl Serialize) -> io::Result<()> {
        let text = serde_json::to_string(content)?;
        let draft = format!(".{name}");
        let mut file = self.make(&draft)?;
        let written = file.write_all(text.as_bytes()).and_then(|()| self.rename(&draft, name));
        if written.is_err() {
            let _ = self.remove(&draft);
        }
        written
    }

    /// Removes an entry; of a link, the link.
    ///
    /// # Errors
    /// If it isn't there, or the operating system refuses.
    pub(crate) fn remove(&self, name: &str) -> io::Result<()> {
        #[cfg(unix)]
        return Ok(rustix::fs::unlinkat(&self.held, name, rustix::fs::AtFlags::empty())?);
        #[cfg(not(unix))]
        std::fs::remove_file(self.folder.join(name))
    }

    /// Returns whether the folder is still there.
    pub(crate) fn is_there(&self) -> bool {
        std::fs::symlink_metadata(&self.folder).is_ok_and(|found| found.is_dir())
    }

    fn make(&self, name: &str) -> io::Result<File> {
        #[cfg(unix)]
        return unix::make(&self.held, name);
        #[cfg(not(unix))]
        File::create_new(self.folder.join(name))
    }

    fn rename(&self, from: &str, to: &str) -> io::Result<()> {
        #[cfg(unix)]
        return Ok(rustix::fs::renameat(&self.held, from, &self.held, to)?);
        #[cfg(not(unix))]
        std::fs::rename(self.folder.join(from), self.folder.join(to))
    }
}

#[cfg(unix)]
mod unix {
    use super::{File, Path, io, refuse_other};
    use rustix::fs::{Dir, Mode, OFlags, openat};
    use std::os::fd::OwnedFd;

    pub(super) fn folder(path: &Path) -> io::Result<OwnedFd> {
        let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::NOFOLLOW | OFlags::CLOEXEC;
        Ok(rustix::fs::open(path, flags, Mode::empty())?)
    }

    pub(super) fn names(held: &OwnedFd) -> io::Result<Vec<String>> {
        let mut all = Vec::new();
        for entry in Dir::read_from(held)? {
            all.push(entry?.file_name().to_string_lossy().into_owned());
        }
        Ok(all)
    }

    pub(super) fn open(held: &OwnedFd, name: &str) -> io::Result<File> {
        let flags =
            OFlags::RDONLY | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
        let opened = openat(held, name, flags, Mode::empty()).map_err(|error| match error {
            rustix::io::Errno::LOOP => {
                io::Error::new(io::ErrorKind::InvalidInput, "it is a link, expected a regular file")
            }
            error => error.into(),
        })?;
        let file = File::from(opened);
        refuse_other(file.metadata()?.file_type())?;
        Ok(file)
    }

    pub(super) fn make(held: &OwnedFd, name: &str) -> io::Result<File> {
        let flags =
            OFlags::WRONLY | OFlags::CREATE | OFlags::EXCL | OFlags::NOFOLLOW | OFlags::CLOEXEC;
        Ok(File::from(openat(held, name, flags, Mode::from_raw_mode(0o666))?))
    }
}
