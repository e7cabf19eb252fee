//! What is kept of a run: the recording and the hash of its stream.
//!
//! The run loop hands every epoch to a [`Recorder`], which collects them in blocks; a thread of its
//! own hashes the stream, decimates and writes `recording.mcap`. A [`reader`] gives it all back,
//! bit for bit.

mod altered;
mod block;
mod handle;
pub mod message;
pub mod reader;
pub mod records;
mod sink;
mod stream_hash;
mod trouble;
mod writer;

pub use altered::AlteredStreams;
pub use handle::{Recorder, RecorderSummary};
pub use stream_hash::StreamHash;
pub use trouble::Trouble;

use octant_sample::Epoch;
use octant_sample::Output;
use octant_sample::Truth;
use octant_sample::parameters::ParameterEstimate;
use std::collections::BTreeMap;
use std::time::Duration;

/// Version of what stands in a recording: topics, layouts, metadata.
pub const FORMAT_VERSION: u32 = 1;

/// Wall time after which what the recorder was given is handed to the operating system.
pub const FLUSH_INTERVAL: Duration = Duration::from_millis(250);

/// Messages in a file, by topic.
pub type Counts = BTreeMap<&'static str, u64>;

/// Everything of one epoch, as it passes the recorder.
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// What the source delivered.
    pub clean: &'a Epoch,
    /// What reached the endpoint.
    pub faulted: &'a Epoch,
    /// What the core answered.
    pub output: &'a Output,
}

/// What rides along with some frames only.
#[derive(Clone, Copy, Debug)]
// Passed by reference and copied into its own list: a box would be an allocation per second.
#[allow(clippy::large_enum_variant)]
pub enum Extra {
    /// Truth at the stamp of the frame just given.
    Truth(Truth),
    /// The parameters have changed with the frame just given.
    Parameters(ParameterEstimate),
}

/// A rare event, recorded as JSON.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Event {
    /// What happened: `mode`, `fault`, `verdict`, ...
    pub kind: String,
    /// Its details.
    pub detail: serde_json::Value,
}

/// Which samples and outputs are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// Those on the grid of [`Policy::period_ns`].
    Decimated,
    /// Every one: a replay gives the core's outputs bit for bit.
    Full,
}

impl Samples {
    /// The name used in scenarios and recordings.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Decimated => "decimated",
            Self::Full => "full",
        }
    }
}

/// What is kept of a run. Aiding and epochs in which the mode changes are kept always.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Policy {
    /// Which samples and outputs are kept.
    pub samples: Samples,
    /// Period of the grid on which truth, and decimated samples and outputs, are kept, ns. The
    /// first epoch is kept, then the first at or after each multiple of the period.
    pub period_ns: u64,
    /// Period in which the parameters are kept, ns, and at every change of mode and at the end.
    /// With [`Samples::Full`] every change of them is kept.
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

/// How a recorder is set up.
#[derive(Clone, Debug)]
pub struct RecorderOptions {
    /// What is kept.
    pub policy: Policy,
    /// The resolved scenario, stored inside the recording as the attachment `scenario.toml`.
    pub scenario: String,
    /// More to say about the run, stored as metadata `octant.run`.
    pub metadata: BTreeMap<String, String>,
    /// Epochs handed over at a time.
    pub epochs_per_block: usize,
    /// Blocks in circulation; when all are full the run loop waits.
    pub blocks: usize,
    /// What faults do to disk and thread.
    pub trouble: Trouble,
}

impl Default for RecorderOptions {
    fn default() -> Self {
        Self {
            policy: Policy::default(),
            scenario: String::new(),
            metadata: BTreeMap::new(),
            epochs_per_block: 256,
            blocks: 4,
            trouble: Trouble::default(),
        }
    }
}

/// Why a recorder could not go on. What was written before stays readable.
#[derive(Debug, thiserror::Error)]
pub enum RecorderError {
    /// The recording could not be written: disk full, device gone.
    #[error("write the recording after {written_bytes} bytes: {source}")]
    Write {
        /// Bytes that the file took before.
        written_bytes: u64,
        /// What the system said.
        source: std::io::Error,
    },
    /// The recording could not be created.
    #[error("create {path}: {source}")]
    Create {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The container format refused a record.
    #[error("write the recording: {reason}")]
    Format {
        /// What it said.
        reason: String,
    },
    /// The run loop did not hand over the parameters that came with an output.
    #[error(
        "record epoch {sequence}: parameters revision {revision} was announced and did not come"
    )]
    ParametersMissing {
        /// Sequence number of the epoch.
        sequence: u64,
        /// The revision announced.
        revision: u32,
    },
    /// The thread of the recorder ended by itself.
    #[error("hand over to the recorder: its thread is gone")]
    Gone,
}
