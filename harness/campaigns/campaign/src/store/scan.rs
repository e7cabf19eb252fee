//! Finds the records of a part file, and tells a torn end from damage.
//!
//! A writer appends one record after another, each whole on the disk before the next one begins. After
//! a kill or a power failure at most the last record is incomplete: a torn end, which counts as absent.
//! Anything after an incomplete record, even one more byte where its length is known, shows that it is
//! damage.

use super::error::PartError;
use super::frame::{
    self, CHECK, Checksum, FILE_HEAD, FIXED, FileHead, MARKER, RecordHead, SCHEMA, checksum,
    read_file_head,
};
use std::fs::File;
use std::io;
use std::path::Path;

/// Number of bytes that are searched for a record at a time.
const SEARCHED: usize = 1 << 20;
/// Number of bytes that are read at a time where few are needed.
const WINDOW: usize = 4096;

/// A record in a file.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub(super) head: RecordHead,
    /// Byte at which it begins.
    pub(super) offset: u64,
    /// Byte after it.
    pub(super) next: u64,
    /// Checksum at its end, which names it.
    pub(super) own: Checksum,
}

/// Records of a file, up to the byte from which the end is torn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Scanned {
    /// End of the last whole record, or of the file's head; 0 without a whole head.
    pub(super) end: u64,
    /// Length of the file.
    pub(super) bytes: u64,
    /// Version of the file.
    pub(super) version: u32,
}

/// Reads the heads of all records, and calls `each` with them. Only the content of the last one is
/// read, which may be torn.
pub(super) fn scan(
    path: &Path,
    file: &File,
    each: impl FnMut(Found),
) -> Result<Scanned, PartError> {
    scan_from(path, file, FILE_HEAD as u64, each)
}

/// Reads the heads of the records from a byte on at which one begins, as [`scan`] does.
pub(super) fn scan_from(
    path: &Path,
    file: &File,
    from: u64,
    mut each: impl FnMut(Found),
) -> Result<Scanned, PartError> {
    let system = |source| PartError::System { action: "read", path: path.to_owned(), source };
    let bytes = file.metadata().map_err(system)?.len();
    let mut reader = Source::of(file, bytes);
    let mut first = vec![0; FILE_HEAD.min(usize::try_from(bytes).unwrap_or(FILE_HEAD))];
    reader.exact(0, &mut first).map_err(system)?;
    let version = match read_file_head(&first) {
        FileHead::Whole(found) => found,
        FileHead::Torn => return Ok(Scanned { end: 0, bytes, version: SCHEMA }),
        FileHead::Version(found) => {
            return Err(PartError::Version { path: path.to_owned(), found });
        }
        FileHead::Foreign => return Err(PartError::Foreign { path: path.to_owned() }),
    };
    let mut end = from;
    while end < bytes {
        match reader.record(end).map_err(system)? {
            At::Record(found) => {
                end = found.next;
                each(found);
            }
            At::Torn => break,
            At::Damaged { found, expected } => {
                let path = path.to_owned();
                return Err(PartError::Damaged { path, offset: end, found, expected });
            }
        }
    }
    Ok(Scanned { end, bytes, version })
}

/// Reads the head of the record at a byte of a file.
pub(super) fn read_head(path: &Path, file: &File, offset: u64) -> Result<RecordHead, PartError> {
    let bytes = file.metadata().map_err(PartError::system("read", path))?.len();
    let head = Source::of(file, bytes).head(offset);
    head.map_err(PartError::system("read", path))?.ok_or_else(|| no_head(path, offset))
}

/// Reads the checksum of the record at a byte of a file.
pub(super) fn read_checksum(path: &Path, file: &File, offset: u64) -> Result<Checksum, PartError> {
    let bytes = file.metadata().map_err(PartError::system("read", path))?.len();
    let mut source = Source::of(file, bytes);
    let head = source.head(offset).map_err(PartError::system("read", path))?;
    let head = head.ok_or_else(|| no_head(path, offset))?;
    let mut own = [0; CHECK];
    let at = offset + head.bytes() + u64::from(head.body_bytes);
    source.exact(at, &mut own).map_err(PartError::system("read", path))?;
    Ok(own)
}

/// Reads the record at a byte, and returns its head and its result.
pub(super) fn read_whole(
    path: &Path,
    file: &File,
    offset: u64,
) -> Result<(RecordHead, Vec<u8>), PartError> {
    let bytes = file.metadata().map_err(PartError::system("read", path))?.len();
    let whole = Source::of(file, bytes).whole(offset);
    let whole = whole.map_err(PartError::system("read", path))?;
    let (head, body, own) = whole.ok_or_else(|| no_head(path, offset))?;
    let damaged = |found: String, expected: String| PartError::Damaged {
        path: path.to_owned(),
        offset,
        found,
        expected,
    };
    let now = checksum(&[&head.check, &body]);
    if now != own {
        let found = format!("content with checksum {}", hex(&now));
        return Err(damaged(found, hex(&own)));
    }
    let raw = zstd::bulk::decompress(&body, head.raw_bytes as usize).map_err(|error| {
        damaged(format!("no content of Zstandard: {error}"), format!("{} bytes", head.raw_bytes))
    })?;
    let hash = blake3::hash(&raw);
    if *hash.as_bytes() != head.blake3 {
        let found = format!("a result with BLAKE3 {hash}");
        return Err(damaged(found, hex(&head.blake3)));
    }
    Ok((head, raw))
}

/// A record that was there when the file was scanned.
fn no_head(path: &Path, offset: u64) -> PartError {
    PartError::Damaged {
        path: path.to_owned(),
        offset,
        found: "no whole record".to_owned(),
        expected: "the record that was there before".to_owned(),
    }
}

enum At {
    Record(Found),
    Torn,
    Damaged { found: String, expected: String },
}

/// Writes bytes as hexadecimal digits.
pub(super) fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::new(), |mut text, byte| {
        _ = write!(text, "{byte:02x}");
        text
    })
}

/// Reads bytes at a place of a file.
#[cfg(unix)]
fn read_at(file: &File, at: u64, buffer: &mut [u8]) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, buffer, at)
}

#[cfg(not(unix))]
fn read_at(mut file: &File, at: u64, buffer: &mut [u8]) -> io::Result<()> {
    use std::io::{Read, Seek, SeekFrom};
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(buffer)
}

/// A file that is read at given bytes.
struct Source<'a> {
    file: &'a File,
    /// Length of the file.
    bytes: u64,
    /// Bytes that were read last, the first `filled` of it, and where they begin.
    window: Vec<u8>,
    filled: usize,
    start: u64,
}

impl Source<'_> {
    fn of(file: &File, bytes: u64) -> Source<'_> {
        Source { file, bytes, window: Vec::new(), filled: 0, start: 0 }
    }

    /// Reads bytes at a place. Small reads are served from a window, which holds the end of a record with
    /// the head of the next one.
    fn exact(&mut self, at: u64, buffer: &mut [u8]) -> io::Result<()> {
        if buffer.len() > WINDOW {
            return read_at(self.file, at, buffer);
        }
        let end = at + buffer.len() as u64;
        if at < self.start || end > self.start + self.filled as u64 {
            if end > self.bytes {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            // Zeros from the allocator, and once: filling the window anew for each of a million records takes
            // longer than reading them.
            if self.window.is_empty() {
                self.window = vec![0; WINDOW];
            }
            let length = (self.bytes - at).min(WINDOW as u64);
            let length = usize::try_from(length).unwrap_or(WINDOW);
            self.filled = 0;
            read_at(self.file, at, &mut self.window[..length])?;
            (self.filled, self.start) = (length, at);
        }
        let from = usize::try_from(at - self.start).unwrap_or(0);
        buffer.copy_from_slice(&self.window[from..from + buffer.len()]);
        Ok(())
    }

    /// Reads the content of a record that begins at a byte: its head, its body and its checksum.
    fn whole(&mut self, offset: u64) -> io::Result<Option<(RecordHead, Vec<u8>, Checksum)>> {
        let Some(head) = self.head(offset)? else { return Ok(None) };
        let body = offset + head.bytes();
        if body + u64::from(head.body_bytes) + CHECK as u64 > self.bytes {
            return Ok(None);
        }
        let (mut content, mut own) = (vec![0; head.body_bytes as usize], [0; CHECK]);
        self.exact(body, &mut content)?;
        self.exact(body + u64::from(head.body_bytes), &mut own)?;
        Ok(Some((head, content, own)))
    }

    /// Reads the head of a record; `None` if there is none, or not all of it.
    fn head(&mut self, at: u64) -> io::Result<Option<RecordHead>> {
        let rest = self.bytes.saturating_sub(at);
        let mut fixed = [0; FIXED];
        if rest < FIXED as u64 {
            return Ok(None);
        }
        self.exact(at, &mut fixed)?;
        let Some(lengths) = frame::lengths(&fixed) else { return Ok(None) };
        let mut named = vec![0; lengths.named() + CHECK];
        if rest - (FIXED as u64) < named.len() as u64 {
            return Ok(None);
        }
        self.exact(at + FIXED as u64, &mut named)?;
        Ok(frame::head(&fixed, lengths, &named))
    }

    /// Reads the record at a byte before the end of the file.
    fn record(&mut self, offset: u64) -> io::Result<At> {
        let Some(head) = self.head(offset)? else {
            return Ok(match self.next_head(offset + 1)? {
                None => At::Torn,
                Some(next) => At::Damaged {
                    found: format!("no whole head, and another record at byte {next}"),
                    expected: "the head of a record".to_owned(),
                },
            });
        };
        let body = offset + head.bytes();
        let check = body + u64::from(head.body_bytes);
        let next = check + CHECK as u64;
        if next > self.bytes {
            return Ok(At::Torn);
        }
        let mut own = [0; CHECK];
        self.exact(check, &mut own)?;
        // A record without content costs nothing to check.
        let is_looked_at = next == self.bytes || head.body_bytes == 0;
        if is_looked_at && !self.is_whole(&head, body, own)? {
            return Ok(match next == self.bytes {
                true => At::Torn,
                false => At::Damaged {
                    found: format!("checksum {}", hex(&own)),
                    expected: hex(&checksum(&[&head.check])),
                },
            });
        }
        Ok(At::Record(Found { head, offset, next, own }))
    }

    fn is_whole(&mut self, head: &RecordHead, body: u64, own: Checksum) -> io::Result<bool> {
        let mut content = vec![0; head.body_bytes as usize];
        self.exact(body, &mut content)?;
        Ok(checksum(&[&head.check, &content]) == own)
    }

    /// Searches for the head of a record.
    fn next_head(&mut self, from: u64) -> io::Result<Option<u64>> {
        let mut at = from;
        let mut window = Vec::new();
        while at + (FIXED as u64) < self.bytes {
            let length = (self.bytes - at).min(SEARCHED as u64);
            window.resize(usize::try_from(length).unwrap_or(SEARCHED), 0);
            self.exact(at, &mut window)?;
            let marked = window.windows(MARKER.len()).enumerate();
            let places = marked.filter(|(_, bytes)| *bytes == MARKER).map(|(place, _)| place);
            for place in places.collect::<Vec<_>>() {
                let place = at + place as u64;
                if self.head(place)?.is_some() {
                    return Ok(Some(place));
                }
            }
            // A marker may lie across two windows.
            at += length - (MARKER.len() as u64 - 1).min(length - 1);
            if length < SEARCHED as u64 {
                break;
            }
        }
        Ok(None)
    }
}
