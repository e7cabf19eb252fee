//! Reads a recording that is still being written.
//!
//! The file is opened for each poll and closed after it. A network file system shows the data of
//! other writers only after a file is opened again; and Windows doesn't rename a folder while a
//! file in it is open, which is how a run ends.

use super::place::RunPlace;
use octant_recorder::reader::{Info, Item, ReadError, Recording};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::PathBuf;

/// Reasons why a recording can't be followed.
#[derive(Debug, thiserror::Error)]
pub enum TailError {
    /// The operating system refuses to open the file.
    #[error("open {}: {source}", .path.display())]
    Open {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The file isn't a recording, or is damaged.
    #[error("read {}: {source}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Problem found.
        source: ReadError,
    },
    /// Another file has replaced it.
    #[error(
        "read {} on from byte {position}: another recording has taken its place, of {found} bytes",
        .path.display()
    )]
    Replaced {
        /// The file.
        path: PathBuf,
        /// Number of bytes that were read before.
        position: u64,
        /// Number of bytes that are there now.
        found: u64,
    },
}

/// End of a poll.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PollEnd {
    /// The requested number of messages was read, and more may be there.
    More,
    /// All present data was read.
    Present,
    /// The end of the recording was reached.
    End,
}

/// Reads the present part of a recording, and continues from there the next time.
pub struct Tail {
    place: RunPlace,
    recording: Recording<Growing>,
}

/// File between two polls.
#[derive(Debug, Default)]
struct Growing {
    file: Option<File>,
    position: u64,
    identity: Option<Identity>,
}

impl Read for Growing {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let Some(file) = &mut self.file else { return Ok(0) };
        let n = file.read(buffer)?;
        self.position += n as u64;
        Ok(n)
    }
}

impl Tail {
    /// Creates a reader of a run's recording, which may not be there yet.
    #[must_use]
    pub fn new(place: RunPlace) -> Self {
        Self { place, recording: Recording::growing(Growing::default()) }
    }

    /// Returns the recording's description, once it is there.
    #[must_use]
    pub fn info(&self) -> Option<&Info> {
        Some(self.recording.info()).filter(|info| info.version > 0)
    }

    /// Returns the number of bytes that were read.
    pub fn position(&mut self) -> u64 {
        self.recording.source().position
    }

    /// Reads at most `most` messages, each once and in order. An incomplete record is read at a
    /// later poll.
    ///
    /// # Errors
    /// If the file isn't a recording, is damaged, or was replaced by another one.
    pub fn look(
        &mut self,
        most: usize,
        mut take: impl FnMut(&Info, u64, Item),
    ) -> Result<PollEnd, TailError> {
        if self.recording.ended() {
            return Ok(PollEnd::End);
        }
        let Some(path) = self.place.recording() else { return Ok(PollEnd::Present) };
        if !self.open(&path)? {
            return Ok(PollEnd::Present);
        }
        let mut reached = PollEnd::More;
        for _ in 0..most {
            match self.recording.next_item() {
                Ok(Some((time_ns, item))) => take(self.recording.info(), time_ns, item),
                Ok(None) => {
                    let ended = self.recording.ended();
                    reached = if ended { PollEnd::End } else { PollEnd::Present };
                    break;
                }
                Err(source) => return Err(TailError::Read { path, source }),
            }
        }
        self.recording.source().file = None;
        if reached == PollEnd::End && self.recording.info().version == 0 {
            return Err(TailError::Read { path, source: ReadError::Foreign });
        }
        Ok(reached)
    }

    /// Opens the file where the last poll ended; false if it is being renamed.
    fn open(&mut self, path: &PathBuf) -> Result<bool, TailError> {
        let failed = |source| TailError::Open { path: path.clone(), source };
        let mut file = match File::open(path) {
            Ok(file) => file,
            // Renamed since its path was determined.
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
            Err(error) => return Err(failed(error)),
        };
        let metadata = file.metadata().map_err(failed)?;
        let source = self.recording.source();
        let identity = Identity::of(&metadata);
        let same = *source.identity.get_or_insert(identity) == identity;
        if !same || metadata.len() < source.position {
            return Err(TailError::Replaced {
                path: path.clone(),
                position: source.position,
                found: metadata.len(),
            });
        }
        file.seek(SeekFrom::Start(source.position)).map_err(failed)?;
        source.file = Some(file);
        Ok(true)
    }
}

/// Identity of a file that is kept when it is renamed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Identity(Option<(u64, u64)>);

impl Identity {
    #[cfg(unix)]
    fn of(metadata: &std::fs::Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        Self(Some((metadata.dev(), metadata.ino())))
    }

    #[cfg(not(unix))]
    fn of(_: &std::fs::Metadata) -> Self {
        Self(None)
    }
}
