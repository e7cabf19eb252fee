//! Reading of recordings: message by message, or epoch by epoch for replay and scoring.

pub use super::item::Item;
use super::message::{MessageError, Topic};
use super::records::{FileEnd, Records, RecordsError};
use super::writer::{FORMAT_METADATA, RUN_METADATA, SCENARIO_ATTACHMENT};
use super::{Event, FORMAT_VERSION, Samples, StreamHash};
use mcap::records::{Record, op};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Aiding, Innovation, NavigationCovariance, Output, Sample, Truth};
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Recorded data of one epoch. With decimation any part can be missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RecordedEpoch {
    /// Simulated time, ns.
    pub time_ns: u64,
    /// Sample that reached the core.
    pub sample: Option<Sample>,
    /// Aiding that reached the core.
    pub aiding: Option<Aiding>,
    /// Sample that the source delivered, if it differs from `sample`; without `sample` if it didn't
    /// reach the core in its step.
    pub clean_sample: Option<Sample>,
    /// Aiding that the source delivered (`Some(None)`: none), if it differs from `aiding`.
    pub clean_aiding: Option<Option<Aiding>>,
    /// Output.
    pub output: Option<Output>,
    /// Innovation of the measurement.
    pub innovation: Option<Innovation>,
    /// Covariance of the solution after the measurement.
    pub covariance: Option<NavigationCovariance>,
    /// Parameters recorded with this epoch.
    pub parameters: Option<ParameterEstimate>,
    /// Truth.
    pub truth: Option<Truth>,
    /// Events since the epoch before, up to this one.
    pub events: Vec<Event>,
}

/// Error of reading a recording.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file can't be opened.
    #[error("{0}")]
    Open(std::io::Error),
    /// The container is damaged, or is no MCAP file.
    #[error(transparent)]
    Records(#[from] RecordsError),
    /// The file is an MCAP file of another program.
    #[error(
        "MCAP file without the metadata `{FORMAT_METADATA}`: not a recording of octant (to use its \
         messages as a source, name topic and fields in a mapping)"
    )]
    Foreign,
    /// The recording was written by a later version of Octant.
    #[error(
        "recording of format version {found}, this octant reads versions up to {FORMAT_VERSION}: \
         read it with the octant that wrote it or a later one"
    )]
    NewerVersion {
        /// The version found.
        found: u32,
    },
    /// The metadata lacks a value, or has an invalid one.
    #[error("metadata `{FORMAT_METADATA}`: {key} is {found}, expected {expected}")]
    Metadata {
        /// The key.
        key: &'static str,
        /// Value found.
        found: String,
        /// Value expected.
        expected: &'static str,
    },
    /// A message doesn't fit its topic.
    #[error("message on {topic} at {log_time_ns} ns: {source}")]
    Message {
        /// The topic.
        topic: &'static str,
        /// Log time of the message.
        log_time_ns: u64,
        /// Error in the message.
        source: MessageError,
    },
}

/// Head of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Info {
    /// Version of the format.
    pub version: u32,
    /// Version of the Octant that wrote it.
    pub octant: String,
    /// Selection of samples and outputs that it keeps.
    pub samples: Samples,
    /// Period of truth and of decimated samples and outputs, ns.
    pub period_ns: u64,
    /// The resolved scenario, TOML.
    pub scenario: String,
    /// Metadata of the run.
    pub run: BTreeMap<String, String>,
}

/// Meaning of one record of the container.
enum Step {
    Nothing,
    Metadata(BTreeMap<String, String>),
    Run(BTreeMap<String, String>),
    Scenario(String),
    Channel { id: u16, topic: Option<Topic> },
    Message { time_ns: u64, item: Result<Option<Item>, (Topic, MessageError)> },
    Damaged(String),
}

/// A recording, read from first to last in bounded memory.
pub struct Recording<R> {
    records: Records<R>,
    info: Info,
    channels: HashMap<u16, Option<Topic>>,
    /// Message that was read while looking for the head.
    pending: Option<(u64, Item)>,
}

impl Recording<BufReader<File>> {
    /// Opens a recording and reads its head.
    ///
    /// # Errors
    /// If it is no recording, or has a newer version.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Self::new(BufReader::new(File::open(path).map_err(ReadError::Open)?))
    }
}

impl<R: Read> Recording<R> {
    /// Reads the head of a recording.
    ///
    /// # Errors
    /// If it is no recording, or has a newer version.
    pub fn new(source: R) -> Result<Self, ReadError> {
        let mut recording = Self::of(Records::new(source));
        // The head ends with the first message, or with the file.
        recording.pending = recording.advance()?;
        if recording.info.version == 0 {
            return Err(ReadError::Foreign);
        }
        Ok(recording)
    }

    /// Reads a recording while it is being written, from its first byte on. Its head is complete as
    /// soon as [`Recording::info`] has a version other than 0. [`Recording::next_item`] returns `None`
    /// while there is no complete further message, and continues when it is called again;
    /// [`Recording::ended`] tells the end.
    pub fn growing(source: R) -> Self {
        Self::of(Records::growing(source))
    }

    fn of(records: Records<R>) -> Self {
        Self {
            records,
            info: Info {
                version: 0,
                octant: String::new(),
                samples: Samples::Decimated,
                period_ns: 0,
                scenario: String::new(),
                run: BTreeMap::new(),
            },
            channels: HashMap::new(),
            pending: None,
        }
    }

    /// Source of the bytes.
    pub fn source(&mut self) -> &mut R {
        self.records.source()
    }

    /// True if the recording was read to a proper end.
    pub fn ended(&self) -> bool {
        self.records.end() == Some(FileEnd::Whole)
    }

    /// Head of the recording.
    pub fn info(&self) -> &Info {
        &self.info
    }

    /// True if the recording ends in the middle (killed, or an incomplete copy). Known once
    /// [`Recording::next_item`] has returned `None`.
    pub fn truncated(&self) -> bool {
        self.records.end() == Some(FileEnd::Truncated)
    }

    /// Reads the next message with its log time (simulated time, ns); `None` at the end.
    ///
    /// # Errors
    /// If the file is damaged or a message doesn't fit its topic.
    pub fn next_item(&mut self) -> Result<Option<(u64, Item)>, ReadError> {
        match self.pending.take() {
            Some(item) => Ok(Some(item)),
            None => self.advance(),
        }
    }

    fn advance(&mut self) -> Result<Option<(u64, Item)>, ReadError> {
        loop {
            let channels = &self.channels;
            let step = self.records.next(|opcode, data| read_step(channels, opcode, data))?;
            match step {
                None => return Ok(None),
                Some(Step::Nothing) => {}
                Some(Step::Metadata(metadata)) => self.head(&metadata)?,
                Some(Step::Run(run)) => self.info.run = run,
                Some(Step::Scenario(scenario)) => self.info.scenario = scenario,
                Some(Step::Channel { id, topic }) => {
                    self.channels.insert(id, topic);
                }
                Some(Step::Damaged(reason)) => {
                    return Err(
                        RecordsError::Damaged { offset: self.records.offset(), reason }.into()
                    );
                }
                Some(Step::Message { .. }) if self.info.version == 0 => {
                    return Err(ReadError::Foreign);
                }
                Some(Step::Message { time_ns, item }) => match item {
                    Ok(Some(item)) => return Ok(Some((time_ns, item))),
                    // The topic was added by another program.
                    Ok(None) => {}
                    Err((topic, source)) => {
                        return Err(ReadError::Message {
                            topic: topic.name(),
                            log_time_ns: time_ns,
                            source,
                        });
                    }
                },
            }
        }
    }

    fn head(&mut self, metadata: &BTreeMap<String, String>) -> Result<(), ReadError> {
        let get = |key: &'static str| metadata.get(key).map_or("", String::as_str);
        let wrong = |key: &'static str, expected: &'static str| ReadError::Metadata {
            key,
            found: metadata.get(key).map_or("missing".into(), |found| format!("{found:?}")),
            expected,
        };
        // The version is checked first: nothing else can be relied on in a newer one.
        let version: u32 =
            get("version").parse().map_err(|_| wrong("version", "a number from 1"))?;
        if version > FORMAT_VERSION {
            return Err(ReadError::NewerVersion { found: version });
        }
        if version == 0 {
            return Err(wrong("version", "a number from 1"));
        }
        self.info.samples = match get("samples") {
            "full" => Samples::Full,
            "decimated" => Samples::Decimated,
            _ => return Err(wrong("samples", "full or decimated")),
        };
        self.info.period_ns =
            get("period_ns").parse().map_err(|_| wrong("period_ns", "nanoseconds"))?;
        self.info.octant = get("octant").into();
        self.info.version = version;
        Ok(())
    }
}

fn read_step(channels: &HashMap<u16, Option<Topic>>, opcode: u8, data: &[u8]) -> Step {
    // The indexes repeat other records; only these kinds matter, and most records are messages.
    match opcode {
        op::MESSAGE | op::METADATA | op::ATTACHMENT | op::CHANNEL => {}
        _ => return Step::Nothing,
    }
    match crate::records::parse(opcode, data) {
        Err(error) => Step::Damaged(error.to_string()),
        Ok(Record::Metadata(record)) if record.name == FORMAT_METADATA => {
            Step::Metadata(record.metadata)
        }
        Ok(Record::Metadata(record)) if record.name == RUN_METADATA => Step::Run(record.metadata),
        Ok(Record::Attachment { header, data, .. }) if header.name == SCENARIO_ATTACHMENT => {
            match std::str::from_utf8(&data) {
                Ok(text) => Step::Scenario(text.into()),
                Err(error) => Step::Damaged(format!("scenario.toml: {error}")),
            }
        }
        Ok(Record::Channel(channel)) => {
            Step::Channel { id: channel.id, topic: Topic::from_name(&channel.topic) }
        }
        Ok(Record::Message { header, data }) => match channels.get(&header.channel_id) {
            None => Step::Damaged(format!("message of unknown channel {}", header.channel_id)),
            Some(topic) => Step::Message {
                time_ns: header.log_time,
                item: topic
                    .map(|topic| Item::decode(topic, &data).map_err(|error| (topic, error)))
                    .transpose(),
            },
        },
        Ok(_) => Step::Nothing,
    }
}

/// Epochs of a recording in order: time, truth, output and parameters for scoring, samples and aiding
/// for replay. Events after the last epoch are available as [`Epochs::last_event`] only.
pub struct Epochs<R> {
    recording: Recording<R>,
    /// First message of the next epoch.
    next: Option<(u64, Item)>,
    last_event: Option<Event>,
    /// Events of the next epoch.
    events: Vec<Event>,
}

impl<R: Read> Epochs<R> {
    /// Groups the messages of a recording.
    pub fn new(recording: Recording<R>) -> Self {
        Self { recording, next: None, last_event: None, events: Vec::new() }
    }

    /// Recording that the epochs are read from.
    pub fn recording(&self) -> &Recording<R> {
        &self.recording
    }

    /// Last event so far: at the end of a run the conclusion of its calibration, if the end of the
    /// stream concluded it.
    pub fn last_event(&self) -> Option<&Event> {
        self.last_event.as_ref()
    }

    /// Reads the next epoch that has recorded data; `None` at the end.
    ///
    /// # Errors
    /// As [`Recording::next_item`].
    pub fn next_epoch(&mut self) -> Result<Option<RecordedEpoch>, ReadError> {
        let mut epoch = RecordedEpoch::default();
        let mut last: Option<Topic> = None;
        loop {
            let Some((time_ns, item)) = (match self.next.take() {
                Some(item) => Some(item),
                None => self.recording.next_item()?,
            }) else {
                return Ok(last.map(|_| epoch));
            };
            let topic = item.topic();
            if let Item::Event(event) = item {
                self.last_event = Some(event.clone());
                self.events.push(event);
                continue;
            }
            if last.is_some_and(|last| time_ns != epoch.time_ns || topic <= last) {
                self.next = Some((time_ns, item));
                return Ok(Some(epoch));
            }
            if last.is_none() {
                epoch.events = std::mem::take(&mut self.events);
            }
            last = Some(topic);
            epoch.time_ns = time_ns;
            match item {
                Item::CleanSample(sample) => epoch.clean_sample = Some(sample),
                Item::CleanAiding(aiding) => epoch.clean_aiding = Some(aiding),
                Item::Aiding(aiding) => epoch.aiding = Some(aiding),
                Item::Sample(sample) => epoch.sample = Some(sample),
                Item::Output(output) => epoch.output = Some(output),
                Item::Innovation(_, innovation) => epoch.innovation = Some(innovation),
                Item::Covariance(_, covariance) => epoch.covariance = Some(covariance),
                Item::Parameters(_, estimate) => epoch.parameters = Some(*estimate),
                Item::Truth(truth) => epoch.truth = Some(truth),
                Item::Event(_) => {}
            }
        }
    }
}

/// Counts of a recording's contents.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contents {
    /// Head of the recording.
    pub info: Info,
    /// Number of messages, by topic.
    pub messages: BTreeMap<&'static str, u64>,
    /// True if the recording ends in the middle.
    pub truncated: bool,
}

/// Reads a recording from memory to its end, and checks every CRC and message. Never panics, and
/// allocates at most a constant and a small multiple of the bytes given.
///
/// # Errors
/// If it is no recording, or damaged.
pub fn read_bytes(bytes: &[u8]) -> Result<Contents, ReadError> {
    contents(Recording::new(bytes)?)
}

/// Reads a recording to its end, and checks every CRC and message.
///
/// # Errors
/// If the recording is damaged.
pub fn contents<R: Read>(mut recording: Recording<R>) -> Result<Contents, ReadError> {
    let mut counts = [0u64; Topic::ALL.len()];
    while let Some((_, item)) = recording.next_item()? {
        counts[item.topic() as usize] += 1;
    }
    Ok(Contents {
        truncated: recording.truncated(),
        info: recording.info,
        messages: Topic::ALL.iter().map(|topic| (topic.name(), counts[*topic as usize])).collect(),
    })
}

/// Stream hash of a full recording, computed from its messages; `None` for a decimated one, which
/// doesn't contain the stream.
///
/// # Errors
/// If the recording is damaged.
pub fn stream_hash<R: Read>(recording: Recording<R>) -> Result<Option<String>, ReadError> {
    if recording.info.samples != Samples::Full {
        return Ok(None);
    }
    let mut epochs = Epochs::new(recording);
    let mut hash = StreamHash::new();
    while let Some(epoch) = epochs.next_epoch()? {
        if let (Some(sample), Some(output)) = (&epoch.sample, &epoch.output) {
            hash.epoch(sample, epoch.aiding.as_ref(), output);
        }
        if let Some(estimate) = &epoch.parameters {
            hash.parameters(estimate);
        }
    }
    Ok(Some(hash.hex()))
}
