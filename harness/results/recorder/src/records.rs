//! The records of an MCAP file from first to last, in bounded memory.

use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::io::Read;

/// Largest record or chunk that is read, compressed or not. Files that claim larger ones are refused
/// before memory of that size is allocated.
pub const RECORD_BYTES_MAX: usize = 32 * 1024 * 1024;
/// Number of bytes read from the file at a time: memory grows with the data that exists, not with the
/// size that is claimed.
const READ_BYTES: usize = 64 * 1024;

/// Error of a file that can't be read further.
#[derive(Debug, thiserror::Error)]
pub enum RecordsError {
    /// The system failed to read.
    #[error("{0}")]
    Io(std::io::Error),
    /// The file doesn't begin like an MCAP file.
    #[error("not an MCAP file: it does not begin with the magic bytes of MCAP")]
    NotMcap,
    /// A chunk is compressed in a way that this program doesn't read.
    #[error(
        "the chunk before byte {offset} is compressed with {name:?}, expected zstd or none; octant reads \
         lz4 when it is built with the feature `lz4`"
    )]
    Compression {
        /// Number of bytes read up to the end of the chunk's head or later.
        offset: u64,
        /// Name of the compression.
        name: String,
    },
    /// A record is damaged.
    #[error("damaged after byte {offset}: {reason}")]
    Damaged {
        /// Number of bytes read up to the damage.
        offset: u64,
        /// Description of the damage.
        reason: String,
    },
}

/// Damage of a record.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// An attachment has no place for its CRC.
    #[error("an attachment ends within its head")]
    Attachment,
    /// The content can't be parsed.
    #[error(transparent)]
    Content(#[from] mcap::McapError),
}

/// Parses a record.
///
/// # Errors
/// If it is damaged. `mcap` 0.26 slices an attachment without checking that its CRC is still there, and
/// panics if it isn't: so that is checked here.
pub fn parse(opcode: u8, body: &[u8]) -> Result<mcap::records::Record<'_>, RecordError> {
    if opcode == mcap::records::op::ATTACHMENT && !attachment_has_its_crc(body) {
        return Err(RecordError::Attachment);
    }
    Ok(mcap::parse_record(opcode, body)?)
}

/// Checks that an attachment is long enough for its CRC. It consists of log time u64, creation time
/// u64, name and media type (u32 length each), data (u64 length), CRC u32.
fn attachment_has_its_crc(body: &[u8]) -> bool {
    let mut at = 16usize;
    for _ in ["name", "media type"] {
        let Some(length) = body.get(at..).and_then(|rest| rest.first_chunk::<4>()) else {
            return false;
        };
        at = at.saturating_add(4).saturating_add(u32::from_le_bytes(*length) as usize);
    }
    at.saturating_add(8 + 4) <= body.len()
}

/// Reads a file record by record. Chunks are decompressed, and their CRC is checked before any of their
/// records is passed on.
pub struct Records<R> {
    source: R,
    reader: LinearReader,
    offset: u64,
    started: bool,
    /// End of the file, once it was reached.
    end: Option<FileEnd>,
    /// True if the file may still grow.
    grows: bool,
}

/// Kind of a file's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileEnd {
    /// Proper end.
    Whole,
    /// The file ends in the middle: the writer was killed, or the copy is incomplete.
    Truncated,
}

impl<R: Read> Records<R> {
    /// Reads from the start of a file.
    pub fn new(source: R) -> Self {
        let reader = LinearReader::new_with_options(
            LinearReaderOptions::default()
                .with_prevalidate_chunk_crcs(true)
                .with_validate_data_section_crc(true)
                .with_validate_summary_section_crc(true)
                .with_record_length_limit(RECORD_BYTES_MAX),
        );
        Self { source, reader, offset: 0, started: false, end: None, grows: false }
    }

    /// Reads a file while it is being written: if it ends in the middle, [`Records::next`] returns
    /// `None` without an end, and continues there when it is called again.
    pub fn growing(source: R) -> Self {
        Self { grows: true, ..Self::new(source) }
    }

    /// Source of the bytes.
    pub fn source(&mut self) -> &mut R {
        &mut self.source
    }

    /// Kind of the file's end, once [`Records::next`] has returned `None`.
    pub fn end(&self) -> Option<FileEnd> {
        self.end
    }

    /// Number of bytes read from the file so far.
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// Passes the next record (opcode and content) to `take`; `None` at the end of the file, and while
    /// a growing file has no complete further record.
    ///
    /// # Errors
    /// If the file can't be read or is damaged. After an error there are no more records.
    pub fn next<T>(
        &mut self,
        take: impl FnOnce(u8, &[u8]) -> T,
    ) -> Result<Option<T>, RecordsError> {
        while self.end.is_none() {
            let wanted = match self.reader.next_event() {
                Some(Ok(LinearReadEvent::Record { opcode, data })) => {
                    self.started = true;
                    return Ok(Some(take(opcode, data)));
                }
                Some(Ok(LinearReadEvent::ReadRequest(wanted))) => wanted,
                // Behind the magic bytes, which were right, a file is one that ends early.
                Some(Err(mcap::McapError::UnexpectedEof))
                    if self.started || self.offset >= mcap::MAGIC.len() as u64 =>
                {
                    self.end = Some(FileEnd::Truncated);
                    break;
                }
                Some(Err(error)) => {
                    self.end = Some(FileEnd::Truncated);
                    return Err(match error {
                        mcap::McapError::BadMagic | mcap::McapError::UnexpectedEof
                            if !self.started =>
                        {
                            RecordsError::NotMcap
                        }
                        mcap::McapError::UnsupportedCompression(name) => {
                            RecordsError::Compression { offset: self.offset, name }
                        }
                        error => {
                            RecordsError::Damaged { offset: self.offset, reason: error.to_string() }
                        }
                    });
                }
                None => {
                    self.end = Some(FileEnd::Whole);
                    break;
                }
            };
            if !self.fill(wanted)? {
                break;
            }
        }
        Ok(None)
    }

    /// Reads from the file into the reader's buffer; false if a growing file has no more bytes at the
    /// moment.
    fn fill(&mut self, wanted: usize) -> Result<bool, RecordsError> {
        let buffer = self.reader.insert(wanted.clamp(1, READ_BYTES));
        loop {
            match self.source.read(buffer) {
                // The reader isn't told, because it would take this for the end.
                Ok(0) if self.grows => return Ok(false),
                Ok(n) => {
                    self.reader.notify_read(n);
                    self.offset += n as u64;
                    return Ok(true);
                }
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) => {
                    self.end = Some(FileEnd::Truncated);
                    return Err(RecordsError::Io(error));
                }
            }
        }
    }
}
