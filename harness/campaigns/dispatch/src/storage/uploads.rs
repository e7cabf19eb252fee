//! Uploads of a worker's results, as numbered segments.
//!
//! A worker appends to its part files. Whenever enough is there, or enough time has passed, the records
//! that the storage doesn't have become the next segment; so do those that an earlier worker of another shard left in
//! the folder. It is written only if nothing has its name. If something has,
//! another worker of the same shard is there: its segment is taken over, and the next number is tried.

use super::error::StorageError;
use super::layout::SegmentName;
use super::objects::{PutOutcome, Storage};
use super::work_folder::{WorkFolder, write};
use octant_campaign::execute::Shard;
use octant_campaign::store::segment::SegmentSource;
use octant_campaign::store::writer::FOLDER;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time between two looks at the part files.
const LOOK: Duration = Duration::from_millis(200);

/// Limits of what a kill can lose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UploadLimits {
    /// Time after which a result is on the storage.
    pub every: Duration,
    /// Bytes of results from which they are uploaded at once, and largest length of a segment with more than one
    /// result.
    pub bytes: u64,
}

impl Default for UploadLimits {
    fn default() -> Self {
        Self { every: Duration::from_secs(20), bytes: 8 << 20 }
    }
}

/// Uploads of the worker of a shard.
#[derive(Debug)]
pub struct SegmentUploads<'a> {
    storage: &'a Storage,
    shard: Shard,
    limits: UploadLimits,
    /// Folder of the results.
    folder: PathBuf,
    source: SegmentSource,
    /// Number of the next segment.
    next: u32,
    /// Results and segments that were uploaded.
    uploaded: (usize, usize),
}

impl<'a> SegmentUploads<'a> {
    /// Begins with a working folder: what its segments hold is on the storage.
    ///
    /// # Errors
    /// If a segment is damaged.
    pub fn of(
        storage: &'a Storage,
        work: &WorkFolder,
        shard: Shard,
        limits: UploadLimits,
    ) -> Result<Self, StorageError> {
        let source = SegmentSource::of(work.path());
        let folder = work.path().join(FOLDER);
        let mut uploads =
            Self { storage, shard, limits, folder, source, next: 1, uploaded: (0, 0) };
        for name in &work.segments {
            uploads.take_over(*name)?;
        }
        Ok(uploads)
    }

    /// Uploads now and then until `is_done` is set, and what is left then. `is_done` isn't waited for if the storage
    /// fails; `failed` is called then.
    ///
    /// # Errors
    /// If the storage refuses or can't be reached in time, or a part file is damaged.
    pub fn follow(&mut self, is_done: &AtomicBool, failed: impl Fn()) -> Result<(), StorageError> {
        let mut since = Instant::now();
        let mut follow = || -> Result<(), StorageError> {
            while !is_done.load(Ordering::Relaxed) {
                std::thread::sleep(LOOK);
                let waiting = self.source.waiting_bytes()?;
                if waiting == 0 {
                    since = Instant::now();
                }
                if waiting >= self.limits.bytes || since.elapsed() >= self.limits.every {
                    self.upload()?;
                    since = Instant::now();
                }
            }
            self.upload()
        };
        follow().inspect_err(|_| failed())
    }

    /// Uploads every result that the storage doesn't have.
    ///
    /// # Errors
    /// As [`SegmentUploads::follow`].
    pub fn upload(&mut self) -> Result<(), StorageError> {
        while let Some(segment) = self.source.next(self.limits.bytes)? {
            let name = SegmentName { shard: self.shard, number: self.next };
            match self.storage.put_new(&name.object(), &segment.bytes)? {
                PutOutcome::New | PutOutcome::Same => {
                    self.uploaded.0 += segment.records;
                    self.uploaded.1 += 1;
                    self.source.stored(segment);
                }
                PutOutcome::Other(bytes) => {
                    write(&self.folder.join(name.file()), &bytes)?;
                    self.take_over(name)?;
                }
            }
            self.next = name.number.checked_add(1).ok_or_else(|| StorageError::Taken {
                object: self.storage.address().of(&name.object()),
                reason: "found the last number of a segment in use, expected a free one".to_owned(),
            })?;
        }
        Ok(())
    }

    /// Returns how many results were uploaded, and in how many segments.
    #[must_use]
    pub fn uploaded(&self) -> (usize, usize) {
        self.uploaded
    }

    fn take_over(&mut self, name: SegmentName) -> Result<(), StorageError> {
        let path = self.folder.join(name.file());
        self.source.take_over(&path).map_err(|error| StorageError::Form {
            object: self.storage.address().of(&name.object()),
            reason: error.to_string(),
        })?;
        if name.shard == self.shard {
            self.next = self.next.max(name.number.saturating_add(1));
        }
        Ok(())
    }
}
