//! An MCAP file that octant did not write, as a source: a mapping names topic and fields.

use super::counting::{Counting, Measured};
use super::fields::{Definition, FieldDecoder, FieldPath, Number};
use super::{Epoch, SourceError};
use mcap::records::{Record, op};
use octant_recorder::records::{FileEnd, Records};
use octant_scenario::recorded::{MappedField, MappedStamp, McapMapping, TimeUnit};
use std::collections::{BTreeSet, HashMap};
use std::io::Read;

/// Field paths in the order of the decoded numbers: gyro, accelerometer, gimbal, stamp.
struct Plan {
    paths: Vec<FieldPath>,
    /// Offset and scale of each value. The stamp's paths follow these values and have no scale.
    scales: Vec<(f64, f64)>,
}

impl Plan {
    fn new(mapping: &McapMapping) -> Result<Self, String> {
        let fields: Vec<&MappedField> = mapping
            .gyro
            .iter()
            .chain(&mapping.accelerometer)
            .chain(mapping.gimbal.iter().flatten())
            .collect();
        let mut paths = fields
            .iter()
            .map(|field| FieldPath::parse(&field.path))
            .collect::<Result<Vec<_>, _>>()?;
        if let MappedStamp::Field { path, nanoseconds, .. } = &mapping.stamp {
            paths.push(FieldPath::parse(path)?);
            if let Some(nanoseconds) = nanoseconds {
                paths.push(FieldPath::parse(nanoseconds)?);
            }
        }
        let scales = fields.iter().map(|field| (field.offset, field.scale)).collect();
        Ok(Self { paths, scales })
    }
}

/// One record of the container, reduced to the parts that this reader needs.
enum Step {
    Nothing,
    Schema { id: u16, name: String, encoding: String, text: Vec<u8> },
    Channel { id: u16, schema: u16, topic: String, encoding: String },
    Message { log_ns: u64, publish_ns: u64, numbers: Result<Vec<Number>, String> },
    Damaged(String),
}

/// Streams a foreign MCAP file.
pub(super) struct Foreign<R> {
    path: String,
    records: Records<R>,
    mapping: McapMapping,
    plan: Plan,
    schemas: HashMap<u16, (String, String, Vec<u8>)>,
    decoders: HashMap<u16, FieldDecoder>,
    topics: BTreeSet<String>,
    counting: Counting,
    messages: u64,
}

impl<R: Read> Foreign<R> {
    pub(super) fn new(source: R, path: &str, mapping: McapMapping) -> Result<Self, SourceError> {
        let fail = |reason: String| SourceError::Read { path: path.into(), reason };
        let plan = Plan::new(&mapping).map_err(fail)?;
        let nominal_ns = super::nominal_period_ns(mapping.nominal_rate_hz).map_err(fail)?;
        Ok(Self {
            path: path.into(),
            records: Records::new(source),
            counting: Counting::new(mapping.quantity, nominal_ns, mapping.split).map_err(fail)?,
            mapping,
            plan,
            schemas: HashMap::new(),
            decoders: HashMap::new(),
            topics: BTreeSet::new(),
            messages: 0,
        })
    }

    pub(super) fn truncated(&self) -> bool {
        self.records.end() == Some(FileEnd::Truncated)
    }

    pub(super) fn saturated(&self) -> u64 {
        self.counting.saturated()
    }

    pub(super) fn next(&mut self) -> Result<Option<Epoch>, SourceError> {
        self.advance().map_err(|reason| SourceError::Read { path: self.path.clone(), reason })
    }

    fn advance(&mut self) -> Result<Option<Epoch>, String> {
        loop {
            if let Some(sample) = self.counting.next() {
                return Ok(Some(Epoch { sample, aiding: None }));
            }
            let (decoders, plan) = (&self.decoders, &self.plan);
            let step = self
                .records
                .next(|opcode, data| read_step(decoders, plan, opcode, data))
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
                    if topic == self.mapping.topic {
                        let decoder = self.decoder(schema, &encoding)?;
                        self.decoders.insert(id, decoder);
                    } else if self.topics.len() < 20 {
                        self.topics.insert(topic);
                    }
                }
                Some(Step::Message { log_ns, publish_ns, numbers }) => {
                    self.messages += 1;
                    numbers.and_then(|numbers| self.take(log_ns, publish_ns, &numbers)).map_err(
                        |reason| {
                            format!("message {} on {}: {reason}", self.messages, self.mapping.topic)
                        },
                    )?;
                }
            }
        }
    }

    fn topic_missing(&self) -> String {
        let found: Vec<&str> = self.topics.iter().map(String::as_str).collect();
        format!(
            "no topic {:?}; the file has {}",
            self.mapping.topic,
            if found.is_empty() { "none".into() } else { found.join(", ") }
        )
    }

    fn decoder(&self, schema: u16, encoding: &str) -> Result<FieldDecoder, String> {
        let topic = &self.mapping.topic;
        match (encoding, self.schemas.get(&schema)) {
            ("json", _) => Ok(FieldDecoder::Json),
            ("cdr", Some((name, schema_encoding, text))) if schema_encoding == "ros2msg" => {
                let text = std::str::from_utf8(text)
                    .map_err(|error| format!("schema of {topic}: {error}"))?;
                Definition::parse(name, text).map(FieldDecoder::Cdr)
            }
            ("cdr", Some((_, schema_encoding, _))) => {
                Err(format!("topic {topic} has a schema in {schema_encoding}, expected ros2msg"))
            }
            ("cdr", None) => Err(format!("topic {topic} has no schema, expected ros2msg")),
            (other, _) => Err(format!("topic {topic} is in {other}, expected json or cdr")),
        }
    }

    /// Passes a message to the counting.
    fn take(&mut self, log_ns: u64, publish_ns: u64, numbers: &[Number]) -> Result<(), String> {
        // The plan has nine paths or more, in this order.
        let value = |i: usize| {
            let (offset, scale) = self.plan.scales[i];
            (numbers[i].real() - offset) * scale
        };
        for (i, path) in self.plan.paths.iter().enumerate().take(self.plan.scales.len()) {
            if !value(i).is_finite() {
                return Err(format!(
                    "field {path} is {}, expected a finite number",
                    numbers[i].real()
                ));
            }
        }
        let stamps = &numbers[self.plan.scales.len()..];
        let time_ns = match self.mapping.stamp {
            MappedStamp::LogTime => log_ns,
            MappedStamp::PublishTime => publish_ns,
            MappedStamp::Field { unit, .. } => stamp_ns(stamps, unit)?,
        };
        let row = Measured {
            time_ns,
            gyro: [value(0), value(1), value(2)],
            accel: [value(3), value(4), value(5)],
            gimbal_rad: self.mapping.gimbal.is_some().then(|| [value(6), value(7)]),
        };
        self.counting.begin(row)
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

fn read_step(decoders: &HashMap<u16, FieldDecoder>, plan: &Plan, opcode: u8, data: &[u8]) -> Step {
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
                numbers: decoder.numbers(&plan.paths, &data),
            },
        },
        Ok(_) => Step::Nothing,
    }
}
