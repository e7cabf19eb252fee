//! Recording of a run, and the hash of its stream.
//!
//! The run loop hands every epoch to a [`Recorder`], which collects them in blocks; a separate thread
//! hashes the stream, decimates and writes `recording.mcap`. A [`reader`] returns everything bit for
//! bit.

mod altered;
mod block;
mod cdr;
pub mod concluded;
mod digest;
pub mod event;
pub mod further;
mod handle;
mod item;
pub mod message;
mod published;
pub mod reader;
pub mod records;
mod sink;
mod stream_hash;
mod topic;
mod trouble;
mod writer;

pub use altered::AlteredStreams;
pub use digest::RecorderSummary;
pub use event::Event;
pub use further::Publishing;
pub use handle::Recorder;
pub use stream_hash::StreamHash;
pub use trouble::RecorderTrouble;

use octant_sample::Epoch;
use octant_sample::Output;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Innovation, NavigationCovariance, Truth};
use std::collections::BTreeMap;
use std::time::Duration;

/// Version of the recording format: topics, layouts, metadata.
pub const FORMAT_VERSION: u32 = 1;

/// Wall time after which recorded data is handed to the operating system.
pub const FLUSH_INTERVAL: Duration = Duration::from_millis(250);

/// Number of messages in a file, by topic.
pub type MessageCounts = BTreeMap<&'static str, u64>;

/// All parts of one epoch.
#[derive(Clone, Copy, Debug)]
pub struct EpochFrame<'a> {
    /// Epoch that the source delivered.
    pub clean: &'a Epoch,
    /// Epoch that reached the core.
    pub faulted: &'a Epoch,
    /// Output of the core.
    pub output: &'a Output,
}

/// Additions of some frames.
#[derive(Clone, Copy, Debug)]
// The value is passed by reference and copied into its own list: a box would be an allocation a second.
#[allow(clippy::large_enum_variant)]
pub enum Extra {
    /// Truth at the stamp of the last frame.
    Truth(Truth),
    /// Innovation of the measurement whose NIS the last frame's output has.
    Innovation(Innovation),
    /// Covariance of the solution after the same measurement.
    Covariance(NavigationCovariance),
    /// Parameters that changed with the last frame.
    Parameters(ParameterEstimate),
}

/// Selection of samples and outputs that are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// Samples on the grid of [`Policy::period_ns`].
    Decimated,
    /// All samples: a replay gives the core's outputs bit for bit.
    Full,
}

impl Samples {
    /// Name used in scenarios and recordings.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Decimated => "decimated",
            Self::Full => "full",
        }
    }
}

/// Selection of a run's data that is kept. Aiding, and epochs in which the mode changes, are always
/// kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Policy {
    /// Selection of samples and outputs.
    pub samples: Samples,
    /// Period of the grid on which truth, and decimated samples and outputs, are kept, ns. The
    /// first epoch is kept, then the first at or after each multiple of the period.
    pub period_ns: u64,
    /// Period in which the parameters are kept, ns; they are also kept at every change of mode and at
    /// the end. With [`Samples::Full`] every change of them is kept.
    pub parameters_period_ns: u64,
}

impl Default for Policy {
    /// Once a second; parameters every 10 s.
    fn default() -> Self {
        Self {
            samples: Samples::Decimated,
            period_ns: 1_000_000_000,
            parameters_period_ns: 10_000_000_000,
        }
    }
}

/// Options of a recorder.
#[derive(Clone, Debug)]
pub struct RecorderOptions {
    /// Selection of data that is kept.
    pub policy: Policy,
    /// The resolved scenario, stored inside the recording as the attachment `scenario.toml`.
    pub scenario: String,
    /// Further information about the run, stored as metadata `octant.run`.
    pub metadata: BTreeMap<String, String>,
    /// Number of epochs in a block.
    pub epochs_per_block: usize,
    /// Number of blocks; when all are full the run loop waits.
    pub blocks: usize,
    /// Faults of disk and thread.
    pub trouble: RecorderTrouble,
    /// Further topics for other tools, if any.
    pub publishing: Option<Publishing>,
}

impl Default for RecorderOptions {
    fn default() -> Self {
        Self {
            policy: Policy::default(),
            scenario: String::new(),
            metadata: BTreeMap::new(),
            epochs_per_block: 1024,
            blocks: 4,
            trouble: RecorderTrouble::default(),
            publishing: None,
        }
    }
}

/// Error of a recorder that can't continue. Data written before stays readable.
#[derive(Debug, thiserror::Error)]
pub enum RecorderError {
    /// The recording could not be written: disk full, device gone.
    #[error("write the recording after {written_bytes} bytes: {source}")]
    Write {
        /// Number of bytes written before.
        written_bytes: u64,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The recording could not be created.
    #[error("create {path}: {source}")]
    Create {
        /// The file.
        path: String,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The container format refused a record.
    #[error("write the recording: {reason}")]
    Format {
        /// Error of the container's writer.
        reason: String,
    },
    /// The run loop didn't hand over the parameters that an output announced.
    #[error(
        "record epoch {sequence}: parameters revision {revision} was announced and did not come"
    )]
    ParametersMissing {
        /// Sequence number of the epoch.
        sequence: u64,
        /// Revision announced.
        revision: u32,
    },
    /// The thread of the recorder ended unexpectedly.
    #[error("hand over to the recorder: its thread is gone")]
    Gone,
}
