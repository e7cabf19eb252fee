//! One run at a time works on the cases of a folder: a second one would do the same work again, perhaps by another program.

use super::execution::ExecuteError;
use crate::plan::FILE_NAME;
use crate::plan::shard::Shard;
use std::fs::{File, TryLockError};
use std::path::Path;

/// The right to work on the cases of a shard, until it is dropped. A process that is killed loses it.
#[derive(Debug)]
pub(super) struct Running(#[expect(dead_code, reason = "its lock ends with it")] Option<File>);

impl Running {
    /// Takes the right to work on a shard: shards may be worked on at once, each by one run, and nothing beside a whole
    /// campaign. Where the file system has no locks nothing tells of another run.
    pub(super) fn begin(folder: &Path, shard: Shard) -> Result<Self, ExecuteError> {
        // On systems other than Unix a lock would keep readers out.
        let plan = cfg!(unix).then(|| File::open(folder.join(FILE_NAME)).ok()).flatten();
        let Some(plan) = plan else { return Ok(Self(None)) };
        let is_whole = shard == Shard::WHOLE;
        let lock = if is_whole { plan.try_lock() } else { plan.try_lock_shared() };
        match lock {
            Err(TryLockError::WouldBlock) => {
                Err(ExecuteError::Running { folder: folder.to_owned() })
            }
            // A file system without locks doesn't tell.
            Ok(()) | Err(TryLockError::Error(_)) => Ok(Self(Some(plan))),
        }
    }
}
