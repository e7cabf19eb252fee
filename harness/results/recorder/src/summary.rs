//! Summary of a recording.

use super::MessageCounts;
use super::altered::AlteredStreams;

/// Summary of a recording.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecorderSummary {
    /// Hash of the whole stream ([`StreamHash`](super::StreamHash)); empty for a recorder without any function.
    pub stream_hash: String,
    /// Number of epochs.
    pub epochs: u64,
    /// Number of aiding messages that reached the core.
    pub aiding: u64,
    /// Number of epochs in which the core received something else than the source delivered.
    pub altered: u64,
    /// Checksums of the streams of the source and the core, if they differ.
    pub altered_streams: Option<AlteredStreams>,
    /// Number of messages in the file, by topic.
    pub messages: MessageCounts,
    /// Size of the file, bytes.
    pub bytes: u64,
}
