//! Folder of requests and replies, held open.
//!
//! Anyone who may write into the run's folder may plant links there. On Unix the folder itself is held, its files are named from
//! it and opened without following links, and a new file never takes the place of another: nothing outside is read or
//! written, whatever is planted at any moment.

#[cfg(unix)]
use octant_base::regular::refuse_other;
#[cfg(unix)]
use rustix::fs::{AtFlags, Dir, Mode, OFlags, openat, renameat, unlinkat};
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
    held: Held,
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
        Ok(Self { held: Held::of(folder)?, folder: folder.to_owned() })
    }

    /// Lists the names in the folder.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub(crate) fn names(&self) -> io::Result<Vec<String>> {
        self.held.names()
    }

    /// Reads a file.
    ///
    /// # Errors
    /// If it isn't there, is no regular file, is too long, or isn't UTF-8.
    pub(crate) fn read(&self, name: &str) -> io::Result<String> {
        let mut text = String::new();
        self.held.open(name)?.take(LARGEST + 1).read_to_string(&mut text)?;
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
        let mut file = self.held.make(&draft)?;
        let written = file.write_all(text.as_bytes()).and_then(|()| self.held.rename(&draft, name));
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
        self.held.remove(name)
    }

    /// Returns whether the folder is still there.
    pub(crate) fn is_there(&self) -> bool {
        std::fs::symlink_metadata(&self.folder).is_ok_and(|found| found.is_dir())
    }
}

/// The folder by its open handle, which stays the same whatever takes its name.
#[cfg(unix)]
#[derive(Debug)]
struct Held(std::os::fd::OwnedFd);

#[cfg(unix)]
impl Held {
    fn of(folder: &Path) -> io::Result<Self> {
        let flags = OFlags::RDONLY | OFlags::DIRECTORY | OFlags::NOFOLLOW | OFlags::CLOEXEC;
        Ok(Self(rustix::fs::open(folder, flags, Mode::empty())?))
    }

    fn names(&self) -> io::Result<Vec<String>> {
        let mut all = Vec::new();
        for entry in Dir::read_from(&self.0)? {
            all.push(entry?.file_name().to_string_lossy().into_owned());
        }
        Ok(all)
    }

    fn open(&self, name: &str) -> io::Result<File> {
        let flags =
            OFlags::RDONLY | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::NOCTTY | OFlags::CLOEXEC;
        let opened = openat(&self.0, name, flags, Mode::empty()).map_err(|error| match error {
            rustix::io::Errno::LOOP => {
                io::Error::new(io::ErrorKind::InvalidInput, "it is a link, expected a regular file")
            }
            error => error.into(),
        })?;
        let file = File::from(opened);
        refuse_other(file.metadata()?.file_type())?;
        Ok(file)
    }

    fn make(&self, name: &str) -> io::Result<File> {
        let flags =
            OFlags::WRONLY | OFlags::CREATE | OFlags::EXCL | OFlags::NOFOLLOW | OFlags::CLOEXEC;
        Ok(File::from(openat(&self.0, name, flags, Mode::from_raw_mode(0o666))?))
    }

    fn rename(&self, from: &str, to: &str) -> io::Result<()> {
        Ok(renameat(&self.0, from, &self.0, to)?)
    }

    fn remove(&self, name: &str) -> io::Result<()> {
        Ok(unlinkat(&self.0, name, AtFlags::empty())?)
    }
}

/// The folder by its path.
#[cfg(not(unix))]
#[derive(Debug)]
struct Held(PathBuf);

#[cfg(not(unix))]
impl Held {
    fn of(folder: &Path) -> io::Result<Self> {
        Ok(Self(folder.to_owned()))
    }

    fn names(&self) -> io::Result<Vec<String>> {
        let entries = std::fs::read_dir(&self.0)?.flatten();
        Ok(entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect())
    }

    fn open(&self, name: &str) -> io::Result<File> {
        octant_base::regular::open(&self.0.join(name))
    }

    fn make(&self, name: &str) -> io::Result<File> {
        File::create_new(self.0.join(name))
    }

    fn rename(&self, from: &str, to: &str) -> io::Result<()> {
        std::fs::rename(self.0.join(from), self.0.join(to))
    }

    fn remove(&self, name: &str) -> io::Result<()> {
        std::fs::remove_file(self.0.join(name))
    }
}
