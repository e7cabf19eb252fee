//! Parts of a run's stream that are kept.

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
