//! Appends records to a part file that no other writer has.

use super::error::{PartError, ResultPlace};
use super::frame::{
    Checksum, FACTS_MAX, MADE_BY, NewRecord, RecordKind, SCHEMA, file_head, record,
};
use super::scan::scan;
use octant_evidence::maker::Maker;
use std::fs::{File, TryLockError};
use std::io::{ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{SystemTime, UNIX_EPOCH};

/// Folder of the part files, in the folder of a campaign.
pub const FOLDER: &str = "results";
/// Extension of a part file.
pub const EXTENSION: &str = "octres";
/// Level of compression, at which a result of 47 kB takes less than a millisecond.
const LEVEL: i32 = 3;

/// Writer of a part file. The file is made with the first record.
#[derive(Debug)]
pub struct PartWriter {
    folder: PathBuf,
    /// Beginning of the file's name.
    stem: String,
    open: Option<OpenPart>,
    is_synced: bool,
}

/// File that is locked for this writer, and its end.
#[derive(Debug)]
struct OpenPart {
    path: PathBuf,
    file: File,
    end: u64,
}

/// Result as it is stored.
#[derive(Clone, Copy, Debug)]
pub(super) struct NewResult<'a> {
    pub(super) case: &'a str,
    pub(super) bytes: &'a [u8],
    pub(super) facts: &'a [u8],
}

impl PartWriter {
    /// Makes a writer for the folder of a campaign. Its file is the first one with this beginning of
    /// its name that no other process writes, or a new one.
    #[must_use]
    pub fn new(folder: &Path, stem: &str) -> Self {
        Self { folder: folder.join(FOLDER), stem: stem.to_owned(), open: None, is_synced: true }
    }

    /// Leaves it to the operating system when records get to the disk: for results that are made
    /// again after a failure.
    #[must_use]
    pub fn unsynced(self) -> Self {
        Self { is_synced: false, ..self }
    }

    /// Returns the file, opened and repaired if it isn't yet, and the byte at which its next record
    /// begins.
    ///
    /// # Errors
    /// If the operating system refuses, or the file is damaged.
    pub fn next_record(&mut self) -> Result<(&Path, u64), PartError> {
        let OpenPart { path, end, .. } = self.opened()?;
        Ok((path, *end))
    }

    /// Appends a result; it is on the disk when this returns. If it can't be written, nothing of it
    /// stays.
    pub(super) fn append(&mut self, new: NewResult<'_>) -> Result<ResultPlace, PartError> {
        let NewResult { case, bytes, facts } = new;
        let facts = if facts.len() > FACTS_MAX { &[] } else { facts };
        let body = zstd::bulk::compress(bytes, LEVEL)
            .map_err(PartError::system("compress a result for", &self.folder))?;
        self.put(&NewRecord {
            kind: RecordKind::Result,
            case,
            facts,
            maker: Maker::bytes_of_this(),
            body: &body,
            raw_bytes: bytes.len(),
            time_ns: now_ns(),
            blake3: *blake3::hash(bytes).as_bytes(),
        })
    }

    /// Appends that a record of a case doesn't count any more.
    pub(super) fn forget(&mut self, case: &str, own: Checksum) -> Result<ResultPlace, PartError> {
        let mut named = [0; 32];
        named[..own.len()].copy_from_slice(&own);
        self.put(&NewRecord {
            kind: RecordKind::Forgotten,
            case,
            facts: &[],
            maker: Maker::bytes_of_this(),
            body: &[],
            raw_bytes: 0,
            time_ns: now_ns(),
            blake3: named,
        })
    }

    fn put(&mut self, new: &NewRecord<'_>) -> Result<ResultPlace, PartError> {
        let is_synced = self.is_synced;
        let OpenPart { path, file, end } = self.opened()?;
        let case = new.case.to_owned();
        let (path, offset) = (path.clone(), *end);
        let Some((bytes, _)) = record(new) else {
            return Err(PartError::TooLarge { path, case, bytes: new.raw_bytes });
        };
        let written = file.write_all(&bytes).and_then(|()| match is_synced {
            true => file.sync_data(),
            false => Ok(()),
        });
        if let Err(source) = written {
            // The disk is full, perhaps: the file ends where it did. If not even that is possible, the
            // next writer cuts it.
            let _ = file.set_len(offset).and_then(|()| file.seek(SeekFrom::Start(offset)));
            return Err(PartError::System { action: "write", path, source });
        }
        *end += bytes.len() as u64;
        Ok(ResultPlace::Record { part: path, offset, case })
    }

    fn opened(&mut self) -> Result<&mut OpenPart, PartError> {
        let open = match self.open.take() {
            Some(open) => open,
            None => self.find()?,
        };
        Ok(self.open.insert(open))
    }

    /// Finds a file that is free.
    fn find(&self) -> Result<OpenPart, PartError> {
        let create = |path: &Path| PartError::system("create", path);
        std::fs::create_dir_all(&self.folder).map_err(create(&self.folder))?;
        for number in 1_u64.. {
            let path = self.folder.join(format!("{}.{number}.{EXTENSION}", self.stem));
            // Without locks nothing tells that another writer has a file: then each is written by the
            // one that made it. On systems other than Unix a lock would keep readers out.
            let made = File::options().read(true).write(true).create_new(true).open(&path);
            let (file, is_new) = match made {
                Ok(file) => (file, true),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                    let file = File::options().read(true).write(true).open(&path);
                    (file.map_err(PartError::system("open", &path))?, false)
                }
                Err(error) => return Err(create(&path)(error)),
            };
            let is_free = match cfg!(unix).then(|| file.try_lock()) {
                Some(Ok(())) => true,
                Some(Err(TryLockError::WouldBlock)) => false,
                Some(Err(TryLockError::Error(_))) | None => is_new,
            };
            // A part of an older program stays as it is.
            if is_free && let Some(open) = open_at_end(path, file)? {
                return Ok(open);
            }
        }
        Err(create(&self.folder)(ErrorKind::AlreadyExists.into()))
    }
}

/// Cuts off a torn end, and goes to the end; `None` for a part of a version whose records don't tell who made them.
fn open_at_end(path: PathBuf, mut file: File) -> Result<Option<OpenPart>, PartError> {
    let mut found = scan(&path, &file, |_| {})?;
    if found.version < MADE_BY {
        return Ok(None);
    }
    let write = |path: &Path| PartError::system("write", path);
    if found.end == 0 {
        file.set_len(0).map_err(write(&path))?;
        file.seek(SeekFrom::Start(0)).map_err(write(&path))?;
        let head = file_head(SCHEMA);
        file.write_all(&head).map_err(write(&path))?;
        found.end = head.len() as u64;
    } else if found.end < found.bytes {
        file.set_len(found.end).map_err(PartError::system("cut off the end of", &path))?;
    }
    file.seek(SeekFrom::Start(found.end)).map_err(write(&path))?;
    Ok(Some(OpenPart { path, file, end: found.end }))
}

fn now_ns() -> u64 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(now.as_nanos()).unwrap_or(u64::MAX)
}
