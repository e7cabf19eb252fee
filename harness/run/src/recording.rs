//! Parts of a run's stream that are kept.

use octant_recorder::{Recorder, RecorderError, RecorderOptions};
use std::path::Path;

/// Parts of a method's stream that are kept.
#[derive(Clone, Copy, Debug)]
pub enum StreamKeeping<'a> {
    /// A file, by the scenario's policy.
    File(&'a Path),
    /// Hash of the stream and those of altered streams, and the trace for the comparison with a
    /// twin.
    Hash,
    /// Hash of the stream alone, for a run that isn't compared with another.
    HashAlone,
    /// Nothing, for ensembles.
    None,
}

impl StreamKeeping<'_> {
    /// Starts the recorder.
    pub(super) fn start(self, options: &RecorderOptions) -> Result<Recorder, RecorderError> {
        Ok(match self {
            Self::File(path) => Recorder::to_file(path, options)?,
            Self::Hash => Recorder::hash_only(options),
            Self::HashAlone => Recorder::stream_hash_only(options),
            Self::None => Recorder::none(),
        })
    }
}
