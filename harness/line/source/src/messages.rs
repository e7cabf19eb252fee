//! Numbers of the messages on one topic of an MCAP file that octant did not write.

use super::definition::{Definition, Wire};
use super::fields::{FieldDecoder, FieldPath, Number};
use mcap::records::{Record, op};
use octant_account::OutsideClock;
use octant_instruments::align::ClockAlignment;
use octant_recorder::records::{FileEnd, Records};
use octant_scenario::recorded::{MappedStamp, TimeUnit};
use std::collections::{BTreeSet, HashMap};
use std::io::Read;

/// One message.
#[derive(Clone, Debug)]
pub(super) struct TopicMessage {
    /// Stamp, ns.
    pub(super) time_ns: u64,
    /// Numbers, in the order of the paths.
    pub(super) numbers: Vec<Number>,
}

/// Streams the messages on a topic.
pub(super) struct TopicMessages<R> {
    records: Records<R>,
    topic: String,
    /// Paths of the numbers, then those of the stamp.
    paths: Vec<FieldPath>,
    values: usize,
    stamp: MappedStamp,
    schemas: HashMap<u16, (String, String, Vec<u8>)>,
    decoders: HashMap<u16, FieldDecoder>,
    topics: BTreeSet<String>,
    messages: u64,
    /// Stamps against the times at which the messages were logged.
    logged: Box<ClockAlignment>,
    /// True once a stamp isn't the time of its log.
    has_own_stamps: bool,
}

/// One record of the container, reduced to the parts that this reader needs.
enum Step {
    Nothing,
    Schema { id: u16, name: String, encoding: String, text: Vec<u8> },
    Channel { id: u16, schema: u16, topic: String, encoding: String },
    Message { log_ns: u64, publish_ns: u64, numbers: Result<Vec<Number>, String> },
    Damaged(String),
}

impl<R: Read> TopicMessages<R> {
    /// Makes a reader of the fields at `paths`.
    pub(super) fn new<'a>(
        source: R,
        topic: &str,
        paths: impl Iterator<Item = &'a str>,
        stamp: &MappedStamp,
    ) -> Result<Self, String> {
        let mut paths = paths.map(FieldPath::parse).collect::<Result<Vec<_>, _>>()?;
        let values = paths.len();
        if let MappedStamp::Field { path, nanoseconds, .. } = stamp {
            paths.push(FieldPath::parse(path)?);
            if let Some(nanoseconds) = nanoseconds {
                paths.push(FieldPath::parse(nanoseconds)?);
            }
        }
        Ok(Self {
            records: Records::new(source),
            topic: topic.into(),
            paths,
            values,
            stamp: stamp.clone(),
            schemas: HashMap::new(),
            decoders: HashMap::new(),
            topics: BTreeSet::new(),
            messages: 0,
            logged: Box::new(ClockAlignment::new()),
            has_own_stamps: false,
        })
    }

    pub(super) fn truncated(&self) -> bool {
        self.records.end() == Some(FileEnd::Truncated)
    }

    /// Path of the field with this index.
    pub(super) fn path(&self, index: usize) -> &FieldPath {
        &self.paths[index]
    }

    /// Topic.
    pub(super) fn topic(&self) -> &str {
        &self.topic
    }

    /// Adds the place of the last message to a reason.
    pub(super) fn in_message(&self, reason: &str) -> String {
        self.in_message_number(self.messages, reason)
    }

    /// Adds the place of a message that was read before to a reason.
    pub(super) fn in_message_number(&self, number: u64, reason: &str) -> String {
        format!("message {number} on {}: {reason}", self.topic)
    }

    /// Describes a topic without a message.
    pub(super) fn no_message(&self) -> String {
        format!("no message on {}, expected those of the instrument", self.topic)
    }

    /// Number of the last message, from 1.
    pub(super) const fn number(&self) -> u64 {
        self.messages
    }

    /// Returns the next message; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<TopicMessage>, String> {
        loop {
            let (decoders, paths) = (&self.decoders, &self.paths);
            let step = self
                .records
                .next(|opcode, data| read_step(decoders, paths, opcode, data))
                .map_err(|error| error.to_string())?;
            match step {
                None if self.decoders.is_empty() => return Err(self.topic_missing()),
                None => return Ok(None),
                Some(Step::Nothing) => {}
                Some(Step::Damaged(reason)) => return Err(reason),
                Some(Step::Schema { id, name, encoding, text }) => {
                    self.schemas.insert(id, (name, encoding, text));
                }
                Some(Step::Channel { id, schema, topic, encoding }) => {
                    if topic == self.topic {
                        let decoder = self.decoder(schema, &encoding)?;
                        self.decoders.insert(id, decoder);
                    } else if self.topics.len() < 20 {
                        self.topics.insert(topic);
                    }
                }
                Some(Step::Message { log_ns, publish_ns, numbers }) => {
                    self.messages += 1;
                    let read = numbers
                        .and_then(|numbers| self.take(log_ns, publish_ns, numbers))
                        .map_err(|reason| self.in_message(&reason))?;
                    return Ok(Some(read));
                }
            }
        }
    }

    /// Clock of the stamps against the one that logged them; `None` where they are one.
    pub(super) fn outside(&self) -> Option<OutsideClock> {
        let estimate = self.logged.estimate().filter(|_| self.has_own_stamps)?;
        Some(OutsideClock {
            name: "the times of the log".to_owned(),
            fast_ppm: -1e6 * estimate.skew?,
            // A corner of the hull may be as late as the others are.
            sigma_ppm: Some(1e-3 * estimate.late_mean_ns / estimate.span_s),
        })
    }

    fn take(
        &mut self,
        log_ns: u64,
        publish_ns: u64,
        mut numbers: Vec<Number>,
    ) -> Result<TopicMessage, String> {
        let stamps = numbers.split_off(self.values);
        let time_ns = match self.stamp {
            MappedStamp::LogTime => log_ns,
            MappedStamp::PublishTime => publish_ns,
            MappedStamp::Field { unit, .. } => stamp_ns(&stamps, unit)?,
        };
        if matches!(self.stamp, MappedStamp::Field { .. }) {
            self.has_own_stamps |= time_ns != log_ns;
            self.logged.add(time_ns, log_ns);
        }
        Ok(TopicMessage { time_ns, numbers })
    }

    fn topic_missing(&self) -> String {
        let found: Vec<&str> = self.topics.iter().map(String::as_str).collect();
        let found = if found.is_empty() { "none".into() } else { found.join(", ") };
        if self.truncated() {
            return format!(
                "the file is truncated: it ends before its index, and the part that is there has no topic {:?}, \
                 but {found}; what its writer left can be restored by mcap recover",
                self.topic
            );
        }
        format!("no topic {:?}; the file has {found}", self.topic)
    }

    fn decoder(&self, schema: u16, encoding: &str) -> Result<FieldDecoder, String> {
        let topic = &self.topic;
        let expected = match encoding {
            "json" => return Ok(FieldDecoder::Json),
            "cdr" => "ros2msg or ros2idl",
            "ros1" => "ros1msg",
            other => {
                return Err(format!("topic {topic} is in {other}, expected json, cdr or ros1"));
            }
        };
        let Some((name, schema_encoding, text)) = self.schemas.get(&schema) else {
            return Err(format!("topic {topic} has no schema, expected {expected}"));
        };
        let text = std::str::from_utf8(text);
        let text = || text.map_err(|error| format!("schema of {topic}: {error}"));
        let definition = match (encoding, schema_encoding.as_str()) {
            ("cdr", "ros2msg") => Definition::parse(name, text()?, Wire::Cdr),
            ("cdr", "ros2idl") => Definition::parse_idl(name, text()?),
            ("ros1", "ros1msg") => Definition::parse(name, text()?, Wire::Ros1),
            (_, found) => {
                Err(format!("topic {topic} has a schema in {found:?}, expected {expected}"))
            }
        };
        definition.map(FieldDecoder::Ros)
    }
}

/// Computes a stamp, ns, from a number in `unit` and an optional second number of whole
/// nanoseconds.
fn stamp_ns(stamps: &[Number], unit: TimeUnit) -> Result<u64, String> {
    let unit_ns = 10i128.pow(unit.nanosecond_exponent().unsigned_abs());
    let mut ns = match stamps.first() {
        Some(Number::Integer(value)) => value.saturating_mul(unit_ns),
        Some(Number::Real(value)) if value.is_finite() => (value * unit_ns as f64).round() as i128,
        other => return Err(format!("stamp is {other:?}, expected a number")),
    };
    match stamps.get(1) {
        None => {}
        Some(Number::Integer(value)) => ns = ns.saturating_add(*value),
        other => return Err(format!("nanoseconds are {other:?}, expected a whole number")),
    }
    u64::try_from(ns).map_err(|_| format!("stamp is {ns} ns, expected 0 to 2^64 ns"))
}

fn read_step(
    decoders: &HashMap<u16, FieldDecoder>,
    paths: &[FieldPath],
    opcode: u8,
    data: &[u8],
) -> Step {
    if !matches!(opcode, op::SCHEMA | op::CHANNEL | op::MESSAGE) {
        return Step::Nothing;
    }
    match octant_recorder::records::parse(opcode, data) {
        Err(error) => Step::Damaged(error.to_string()),
        Ok(Record::Schema { header, data }) => Step::Schema {
            id: header.id,
            name: header.name,
            encoding: header.encoding,
            text: data.into_owned(),
        },
        Ok(Record::Channel(channel)) => Step::Channel {
            id: channel.id,
            schema: channel.schema_id,
            topic: channel.topic,
            encoding: channel.message_encoding,
        },
        Ok(Record::Message { header, data }) => match decoders.get(&header.channel_id) {
            None => Step::Nothing,
            Some(decoder) => Step::Message {
                log_ns: header.log_time,
                publish_ns: header.publish_time,
                numbers: decoder.numbers(paths, &data),
            },
        },
        Ok(_) => Step::Nothing,
    }
}
