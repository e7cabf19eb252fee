//! Writing of blocks of epochs to an MCAP file, on the recorder's thread.
//!
//! # Recovery model
//!
//! - The file is append-only: header, metadata (`octant.recording`, `octant.run`), the scenario,
//!   then chunks, and at the end of a run the summary with its indexes.
//! - A chunk is built in memory and handed to the operating system whole, with a CRC over its content.
//!   So a killed process leaves a sequence of whole records and at most one torn one at the end; a
//!   reader takes everything before it.
//! - The open chunk is closed when it is large, and whenever [`FLUSH_INTERVAL`] of wall time has
//!   passed: data that the run loop handed over earlier than that is in the file. The loop is asked for
//!   its unfinished block at the same interval (see the handle), so that a kill costs less than a
//!   second of a stepping loop.
//! - The operating system's cache survives the kill of a process, but not of the machine: the file is
//!   synced to the disk once, at the end.
//! - After a failed write nothing more is written; data before the failure is readable.

use super::block::Block;
use super::item::Item;
use super::message::{self, Topic};
use super::published::{Published, next_on_grid};
use super::sink::{Container, Sink};
use super::{
    Event, FLUSH_INTERVAL, FORMAT_VERSION, MessageCounts, Policy, RecorderError, RecorderOptions,
    Samples,
};
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Aiding, Epoch, Mode, NavigationCovariance, Output, Sample};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{BufWriter, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Name of the metadata record with the format version.
pub(super) const FORMAT_METADATA: &str = "octant.recording";
/// Name of the metadata record about the run.
pub(super) const RUN_METADATA: &str = "octant.run";
/// Name of the attachment with the resolved scenario.
pub(super) const SCENARIO_ATTACHMENT: &str = "scenario.toml";
/// Size at which a chunk is closed, uncompressed.
const CHUNK_BYTES: u64 = 512 * 1024;

/// File side of a recorder.
pub(super) struct RecordingWriter<W: Write> {
    mcap: Container<W>,
    written: Arc<AtomicU64>,
    channels: [u16; Topic::ALL.len()],
    counts: [u64; Topic::ALL.len()],
    policy: Policy,
    bytes: Vec<u8>,
    last_flush: Instant,
    dirty: bool,
    /// Mode of the last output; `None` before the first.
    mode: Option<Mode>,
    /// Revision of the parameters in the last output.
    revision: u32,
    /// Log time and sequence number of the last frame.
    last_time_ns: u64,
    last_sequence: u64,
    /// True if the last frame's output is in the file.
    last_kept: bool,
    /// Last parameters, until they are in the file.
    unwritten_parameters: Option<(u64, ParameterEstimate)>,
    next_parameters_ns: u64,
    /// Further topics, if any.
    published: Option<Published>,
}

/// A frame of a block, without its additions.
struct BlockFrame<'a> {
    sample: &'a Sample,
    output: &'a Output,
    /// Epoch of the source, if another one reached the core.
    clean: Option<&'a Epoch>,
    aiding: Option<&'a Aiding>,
    on_grid: bool,
    /// True if nothing reached the core.
    is_lost: bool,
    /// Time of the step, if another frame of it came before.
    step_ns: Option<u64>,
}

impl<W: Write> RecordingWriter<W> {
    /// Writes everything that comes before the first epoch.
    pub(super) fn new(inner: W, options: &RecorderOptions) -> Result<Self, RecorderError> {
        let (sink, written) = Sink::new(inner);
        let fail = |error| error_of(error, &written);
        let mut mcap = mcap::WriteOptions::new()
            .profile("octant")
            .library(concat!("octant ", env!("CARGO_PKG_VERSION")))
            // At level 1, Zstandard takes 15 % more time than LZ4 for files that are 15 % smaller.
            .compression(Some(mcap::Compression::Zstd))
            .compression_level(1)
            // The bytes differ with the number of threads; 0 compresses on this thread.
            .compression_threads(0)
            .chunk_size(Some(CHUNK_BYTES))
            // Without seeking, a chunk is buffered and written whole: see the recovery model.
            .disable_seeking(true)
            .create(NoSeek::new(BufWriter::new(sink)))
            .map_err(fail)?;
        mcap.write_metadata(&Metadata {
            name: FORMAT_METADATA.into(),
            metadata: format_metadata(options),
        })
        .map_err(fail)?;
        mcap.write_metadata(&Metadata {
            name: RUN_METADATA.into(),
            metadata: options.metadata.clone(),
        })
        .map_err(fail)?;
        mcap.attach(&mcap::Attachment {
            log_time: 0,
            create_time: 0,
            name: SCENARIO_ATTACHMENT.into(),
            media_type: "application/toml".into(),
            data: Cow::Borrowed(options.scenario.as_bytes()),
        })
        .map_err(fail)?;
        let mut channels = [0; Topic::ALL.len()];
        for topic in Topic::ALL {
            let (schema_encoding, message_encoding) = topic.encodings();
            let schema = mcap
                .add_schema(topic.schema_name(), schema_encoding, topic.schema().as_bytes())
                .map_err(fail)?;
            channels[topic as usize] = mcap
                .add_channel(schema, topic.name(), message_encoding, &BTreeMap::new())
                .map_err(fail)?;
        }
        let publishing = options.publishing.as_ref();
        let published = publishing.map(|publishing| Published::begin(publishing, &mut mcap));
        let published = published.transpose().map_err(fail)?;
        let mut writer = Self {
            mcap,
            written,
            channels,
            counts: [0; Topic::ALL.len()],
            policy: options.policy,
            bytes: Vec::with_capacity(1024),
            last_flush: Instant::now(),
            dirty: false,
            mode: None,
            last_time_ns: 0,
            last_sequence: 0,
            last_kept: false,
            revision: 0,
            unwritten_parameters: None,
            next_parameters_ns: 0,
            published,
        };
        writer.put_published()?;
        writer.mcap.flush().map_err(|error| error_of(error, &writer.written))?;
        writer.dirty = false;
        Ok(writer)
    }

    /// Writes the data of a block that the policy keeps.
    pub(super) fn block(&mut self, block: &Block) -> Result<(), RecorderError> {
        let mut aiding = block.aiding.iter().peekable();
        let mut altered = block.altered.iter().peekable();
        let mut due = block.due.iter().peekable();
        let mut innovations = block.innovations.iter().peekable();
        let mut covariances = block.covariances.iter().peekable();
        let mut truth = block.truth.iter().peekable();
        let mut parameters = block.parameters.iter().peekable();
        let mut events = block.events.iter().peekable();
        let mut lost = block.lost.iter().peekable();
        let mut added = block.added.iter().peekable();
        let mut position = 0;
        loop {
            // First the additions to the frame before, in the order of the topics.
            while let Some((_, innovation)) = innovations.next_if(|(at, _)| *at == position) {
                if self.last_kept {
                    message::encode_innovation(self.last_sequence, innovation, &mut self.bytes);
                    self.put(Topic::Innovation)?;
                    self.tell(|sequence| Item::Innovation(sequence, *innovation))?;
                }
            }
            while let Some((_, covariance)) = covariances.next_if(|(at, _)| *at == position) {
                self.covariance(covariance)?;
            }
            while let Some((_, estimate)) = parameters.next_if(|(at, _)| *at == position) {
                self.parameters_changed(estimate)?;
            }
            while let Some((_, truth)) = truth.next_if(|(at, _)| *at == position) {
                message::encode_truth(truth, &mut self.bytes);
                self.put(Topic::Truth)?;
                self.tell(|_| Item::Truth(*truth))?;
            }
            while let Some((_, event)) = events.next_if(|(at, _)| *at == position) {
                self.event(event)?;
            }
            self.end_epoch()?;
            let index = position as usize;
            let (Some(sample), Some(output)) = (block.samples.get(index), block.outputs.get(index))
            else {
                break;
            };
            self.frame(&BlockFrame {
                sample,
                output,
                clean: altered.next_if(|(at, _)| *at == position).map(|(_, epoch)| epoch),
                aiding: aiding.next_if(|(at, _)| *at == position).map(|(_, aiding)| aiding),
                on_grid: due.next_if(|at| **at == position).is_some(),
                is_lost: lost.next_if(|at| **at == position).is_some(),
                step_ns: added.next_if(|(at, _)| *at == position).map(|(_, step_ns)| *step_ns),
            })?;
            position += 1;
            if self.policy.samples == Samples::Full {
                continue;
            }
            // Frames with nothing of their own leave nothing in the file: a change of mode is due.
            let next = [
                head(&mut aiding),
                head(&mut altered),
                due.peek().map(|at| **at),
                head(&mut innovations),
                head(&mut covariances),
                head(&mut truth),
                head(&mut parameters),
                head(&mut events),
                lost.peek().map(|at| **at),
                head(&mut added),
            ];
            let next = next.into_iter().flatten().fold(block.len() as u32, u32::min);
            if position < next {
                self.end_epoch()?;
                self.pass_over(block, next as usize - 1);
                position = next;
            }
        }
        Ok(())
    }

    /// Passes over frames up to this one of a block, of which the file keeps nothing.
    fn pass_over(&mut self, block: &Block, last: usize) {
        if let (Some(sample), Some(output)) = (block.samples.get(last), block.outputs.get(last)) {
            self.last_time_ns = sample.device_time.ns;
            self.last_sequence = sample.sequence;
            self.last_kept = false;
            self.revision = output.parameters_revision;
        }
    }

    /// Writes the data of a frame that the policy keeps, without its additions.
    #[inline]
    fn frame(&mut self, frame: &BlockFrame<'_>) -> Result<(), RecorderError> {
        let BlockFrame { sample, output, clean, aiding, on_grid, is_lost, step_ns } = *frame;
        let keep = on_grid || self.policy.samples == Samples::Full;
        self.last_time_ns =
            step_ns.unwrap_or_else(|| clean.map_or(sample, |epoch| &epoch.sample).device_time.ns);
        self.last_sequence = sample.sequence;
        self.last_kept = keep;
        if let Some(epoch) = clean {
            if keep && (is_lost || epoch.sample != *sample) {
                message::encode_sample(&epoch.sample, &mut self.bytes);
                self.put(Topic::ImuClean)?;
            }
            if epoch.aiding.as_ref().map(message::aiding_bits) != aiding.map(message::aiding_bits) {
                message::encode_aiding(epoch.aiding.as_ref(), &mut self.bytes);
                self.put(Topic::AidingClean)?;
            }
        }
        if is_lost {
            return Ok(());
        }
        if let Some(aiding) = aiding {
            message::encode_aiding(Some(aiding), &mut self.bytes);
            self.put(Topic::Aiding)?;
        }
        let changes_mode = self.mode != Some(output.mode);
        if keep {
            if let Some(published) = &mut self.published {
                published.decide(self.last_time_ns, on_grid, changes_mode);
            }
            message::encode_sample(sample, &mut self.bytes);
            self.put(Topic::Imu)?;
            self.tell(|_| Item::Sample(*sample))?;
            message::encode_output(output, &mut self.bytes);
            self.put(Topic::Output)?;
            self.tell(|_| Item::Output(*output))?;
        }
        if changes_mode {
            self.mode_changed(output)?;
        }
        self.revision = output.parameters_revision;
        Ok(())
    }

    fn parameters_changed(&mut self, estimate: &ParameterEstimate) -> Result<(), RecorderError> {
        self.unwritten_parameters = Some((self.last_sequence, *estimate));
        if self.policy.samples == Samples::Full || self.last_time_ns >= self.next_parameters_ns {
            self.write_parameters()?;
        }
        Ok(())
    }

    fn write_parameters(&mut self) -> Result<(), RecorderError> {
        if let Some((sequence, estimate)) = self.unwritten_parameters.take() {
            message::encode_parameters(sequence, &estimate, &mut self.bytes);
            self.put(Topic::Parameters)?;
            self.tell(|_| Item::Parameters(sequence, Box::new(estimate)))?;
            self.next_parameters_ns =
                next_on_grid(self.last_time_ns, self.policy.parameters_period_ns);
        }
        Ok(())
    }

    fn mode_changed(&mut self, output: &Output) -> Result<(), RecorderError> {
        let from = self.mode.replace(output.mode);
        if output.parameters_revision == self.revision {
            self.write_parameters()?;
        } else {
            // The change of mode brings new parameters, which are kept instead of those before.
            self.unwritten_parameters = None;
            self.next_parameters_ns = 0;
        }
        self.event(&Event::Mode {
            from: from.map(|mode| mode.name().to_owned()),
            sequence: output.sequence,
            to: output.mode.name().to_owned(),
        })
    }

    fn event(&mut self, event: &Event) -> Result<(), RecorderError> {
        self.bytes.clear();
        serde_json::to_writer(&mut self.bytes, event)
            .map_err(|error| RecorderError::Format { reason: error.to_string() })?;
        self.put(Topic::Event)?;
        self.tell(|_| Item::Event(event.clone()))
    }

    /// Writes the covariance with the further topics, which state it too.
    fn covariance(&mut self, covariance: &NavigationCovariance) -> Result<(), RecorderError> {
        if self.published.as_ref().is_some_and(Published::is_due) {
            message::encode_covariance(self.last_sequence, covariance, &mut self.bytes);
            self.put(Topic::Covariance)?;
            self.tell(|sequence| Item::Covariance(sequence, *covariance))?;
        }
        Ok(())
    }

    /// Writes the message in `self.bytes`.
    fn put(&mut self, topic: Topic) -> Result<(), RecorderError> {
        let header = self.header(self.channels[topic as usize]);
        self.mcap
            .write_to_known_channel(&header, &self.bytes)
            .map_err(|error| error_of(error, &self.written))?;
        self.counts[topic as usize] += 1;
        self.dirty = true;
        Ok(())
    }

    /// Header of a message of the last frame's epoch.
    fn header(&self, channel_id: u16) -> MessageHeader {
        MessageHeader {
            channel_id,
            // The sequence number of MCAP has 32 bits and is only informative.
            sequence: self.last_sequence as u32,
            log_time: self.last_time_ns,
            publish_time: self.last_time_ns,
        }
    }

    /// Passes a message of the last frame's epoch on to the further topics, with its sequence number.
    fn tell(&mut self, item: impl FnOnce(u64) -> Item) -> Result<(), RecorderError> {
        let Some(published) = &mut self.published else { return Ok(()) };
        published.take(self.last_time_ns, &item(self.last_sequence));
        self.put_published()
    }

    /// Ends the last frame's epoch for the further topics.
    fn end_epoch(&mut self) -> Result<(), RecorderError> {
        let Some(published) = &mut self.published else { return Ok(()) };
        published.end_epoch();
        self.put_published()
    }

    /// Writes the messages on further topics.
    fn put_published(&mut self) -> Result<(), RecorderError> {
        let header = self.header(0);
        if let Some(published) = &mut self.published {
            let put = published.put(&mut self.mcap, header);
            self.dirty |= put.map_err(|error| error_of(error, &self.written))?;
        }
        Ok(())
    }

    /// Hands the open chunk to the operating system if it has been open for long.
    pub(super) fn flush_if_due(&mut self) -> Result<(), RecorderError> {
        if self.last_flush.elapsed() >= FLUSH_INTERVAL {
            if self.dirty {
                self.mcap.flush().map_err(|error| error_of(error, &self.written))?;
                self.dirty = false;
            }
            self.last_flush = Instant::now();
        }
        Ok(())
    }

    /// Writes the summary. Returns the number of messages by topic, and the size of the file in bytes.
    pub(super) fn finish(mut self) -> Result<(MessageCounts, u64), RecorderError> {
        if let Some(published) = &mut self.published {
            published.decide_last();
        }
        self.write_parameters()?;
        self.end_epoch()?;
        self.mcap.finish().map_err(|error| error_of(error, &self.written))?;
        let counts =
            Topic::ALL.iter().map(|topic| (topic.name(), self.counts[*topic as usize])).collect();
        let written = Arc::clone(&self.written);
        let mut buffer = self.mcap.into_inner().into_inner();
        buffer.flush().map_err(|source| RecorderError::Write {
            written_bytes: written.load(Ordering::Relaxed),
            source,
        })?;
        Ok((counts, written.load(Ordering::Relaxed)))
    }
}

/// Position of the next entry of a list of parts.
#[inline]
fn head<'a, T: 'a>(
    parts: &mut std::iter::Peekable<impl Iterator<Item = &'a (u32, T)>>,
) -> Option<u32> {
    parts.peek().map(|(at, _)| *at)
}

/// Metadata about the format of a recording.
fn format_metadata(options: &RecorderOptions) -> BTreeMap<String, String> {
    let policy = &options.policy;
    let mut metadata = BTreeMap::from([
        ("version".into(), FORMAT_VERSION.to_string()),
        ("octant".into(), env!("CARGO_PKG_VERSION").into()),
        ("samples".into(), policy.samples.name().into()),
        ("period_ns".into(), policy.period_ns.to_string()),
        ("parameters_period_ns".into(), policy.parameters_period_ns.to_string()),
        ("log_time".into(), "simulated time, ns since the start of the run".into()),
        (
            "clean".into(),
            "/imu/clean and /aiding/clean hold only what differs from /imu and /aiding".into(),
        ),
    ]);
    if let Some(publishing) = &options.publishing {
        metadata.insert("topics_period_ns".into(), publishing.period_ns.to_string());
    }
    metadata
}

fn error_of(error: mcap::McapError, written: &AtomicU64) -> RecorderError {
    let written_bytes = written.load(Ordering::Relaxed);
    match error {
        mcap::McapError::Io(source) => RecorderError::Write { written_bytes, source },
        other => RecorderError::Format { reason: other.to_string() },
    }
}
