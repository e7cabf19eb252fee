//! Readings from CAN messages.

use super::signal::{Extract, Named};
use super::{Database, DbcProblem, One, SignalMapping, Three};
use crate::rollover::Rollover;
use crate::units::Quantity;
use crate::{MeasuredTriad, Reading, ReadingKind, Stamp, StampClock};
use can_dbc::MessageId;
use octant_sample::{GimbalAngles, Status};
use std::format;
use std::string::String;
use std::vec::Vec;

/// A frame from a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CanFrame<'a> {
    /// Identifier.
    pub id: u32,
    /// True for an identifier of 29 bits.
    pub extended: bool,
    /// Data.
    pub data: &'a [u8],
}

/// Counts of the traffic so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CanCounters {
    /// All frames.
    pub frames: u64,
    /// Frames with messages that the mapping doesn't name.
    pub other: u64,
    /// Readings.
    pub readings: u64,
    /// Frames shorter than their message.
    pub short: u64,
    /// Readings with a missing message.
    pub incomplete: u64,
    /// Messages whose reading had not begun, or was given up.
    pub orphaned: u64,
    /// Readings whose messages had different counters.
    pub mixed: u64,
    /// Missing readings, from gaps in their sequence.
    pub missing: u64,
    /// Readings repeated or too late, or restarts of the unit.
    pub behind: u64,
}

impl CanCounters {
    /// True if nothing was lost, damaged, missing or repeated.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        let Self { frames, other, readings, .. } = *self;
        *self == Self { frames, other, readings, ..Self::default() }
    }
}

/// Destination of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Channel {
    Rotation(usize),
    Velocity(usize),
    Azimuth,
    Roll,
    Sequence,
    Stamp,
    Interval,
    Temperature,
    Valid,
    Counter,
}

#[derive(Clone, Debug)]
struct Source {
    id: MessageId,
    bytes: usize,
    values: Vec<(Channel, Extract)>,
}

/// Time of a counter.
#[derive(Clone, Copy, Debug)]
struct Ticks {
    counter: Rollover,
    tick_ns: f64,
}

impl Ticks {
    fn ns(&mut self, raw: u64) -> u64 {
        let ticks = self.counter.continued(raw);
        let whole = libm::rint(self.tick_ns);
        // A whole number of nanoseconds stays exact for any length of time.
        if (whole - self.tick_ns).abs() < 1e-9 * whole && whole >= 1.0 {
            ticks.saturating_mul(whole as u64)
        } else {
            libm::rint(ticks as f64 * self.tick_ns) as u64
        }
    }
}

/// Gathers readings from messages. Receiving allocates nothing.
#[derive(Clone, Debug)]
pub struct Gatherer {
    sources: Vec<Source>,
    rotation: (ReadingKind, Option<f64>),
    velocity: (ReadingKind, Option<f64>),
    valid_equals: u64,
    sequence: Option<Rollover>,
    stamp: Option<Ticks>,
    /// Index of the next message expected.
    next: usize,
    /// Values of the reading so far.
    reading: Reading,
    gimbal: [Option<f64>; 2],
    counter: Option<u64>,
    mixed: bool,
    last_sequence: Option<u64>,
    counters: CanCounters,
}

/// A mapping with the signals looked up so far.
struct Lookup<'a> {
    database: &'a Database,
    mapping: &'a SignalMapping,
    sources: Vec<Source>,
    names: Vec<(MessageId, &'a str)>,
}

impl<'a> Lookup<'a> {
    fn find(&self, key: &str, name: &str) -> Result<Named<'a>, DbcProblem> {
        Named::find(self.database, self.mapping, key, name)
    }

    fn add(&mut self, channel: Channel, named: &Named<'a>) {
        let message = named.message;
        let value = (channel, named.extract);
        match self.sources.iter_mut().find(|source| source.id == message.id) {
            Some(source) => source.values.push(value),
            None => {
                let bytes = message.size as usize;
                self.sources.push(Source { id: message.id, bytes, values: [value].into() });
                self.names.push((message.id, &message.name));
            }
        }
    }

    fn three(
        &mut self,
        key: &str,
        three: &Three,
        kinds: [Quantity; 2],
        channel: fn(usize) -> Channel,
    ) -> Result<(ReadingKind, Option<f64>), DbcProblem> {
        let (mut found, mut lsb) = (None, None);
        let axes = [("x", &three.x), ("y", &three.y), ("z", &three.z)];
        for (axis, (letter, name)) in axes.into_iter().enumerate() {
            let key = format!("{key}.{letter}");
            let mut named = self.find(&key, name)?;
            let quantity = named.in_unit(three.unit.as_deref(), &kinds)?;
            let scale = three.scale.unwrap_or(1.0);
            if !(scale.is_finite() && scale != 0.0) {
                let place = format!("{}: {key}", self.mapping.file);
                let what = format!("scale {scale} makes no value, expected is another than zero");
                return Err(DbcProblem { place, what });
            }
            named.extract.factor *= scale;
            named.extract.offset *= scale;
            match found {
                Some(first) if first != quantity => {
                    let place = format!("{}: {key}", self.mapping.file);
                    let what = format!(
                        "signal `{name}` ({}) is another quantity than that of x: \
                         all are increments, or all are rates",
                        named.place
                    );
                    return Err(DbcProblem { place, what });
                }
                _ => found = Some(quantity),
            }
            let own = named.extract.lsb();
            lsb = if axis == 0 { own } else { lsb.filter(|lsb| Some(*lsb) == own) };
            self.add(channel(axis), &named);
        }
        let kind = if found == Some(kinds[0]) { ReadingKind::Increment } else { ReadingKind::Mean };
        Ok((kind, lsb))
    }

    fn one(
        &mut self,
        key: &str,
        one: &One,
        kind: Quantity,
        channel: Channel,
    ) -> Result<Named<'a>, DbcProblem> {
        let mut named = self.find(key, &one.signal)?;
        named.in_unit(one.unit.as_deref(), &[kind])?;
        self.add(channel, &named);
        Ok(named)
    }

    /// Sorts the messages by their order on the bus.
    fn in_order(&mut self) -> Result<(), DbcProblem> {
        let Some(order) = &self.mapping.order else {
            // The lower identifier comes first; of equal numbers the one with 11 bits.
            self.sources.sort_by_key(|source| match source.id {
                MessageId::Standard(id) => (u32::from(id) << 18, false),
                MessageId::Extended(id) => (id, true),
            });
            return Ok(());
        };
        let wrong =
            |what: String| Err(DbcProblem { place: format!("{}: order", self.mapping.file), what });
        let mut sources = Vec::new();
        for name in order {
            let named = self.names.iter().find(|(_, other)| other == name);
            let Some(index) =
                named.and_then(|(id, _)| self.sources.iter().position(|one| one.id == *id))
            else {
                return wrong(format!(
                    "`{name}` is no message of which a signal is mapped, or stands here twice"
                ));
            };
            sources.push(self.sources.remove(index));
        }
        if let Some(left) = self.sources.first() {
            let name = self.names.iter().find(|(id, _)| *id == left.id).map_or("", |named| named.1);
            return wrong(format!("message `{name}` isn't in it, but a signal of it is mapped"));
        }
        self.sources = sources;
        Ok(())
    }
}

impl Gatherer {
    /// Makes a gatherer for a database and a mapping.
    ///
    /// # Errors
    /// If a message or signal doesn't exist, a signal doesn't fit its message, or a unit is missing, is
    /// unsuitable or contradicts the database.
    pub fn new(database: &Database, mapping: &SignalMapping) -> Result<Self, DbcProblem> {
        let mut lookup = Lookup { database, mapping, sources: Vec::new(), names: Vec::new() };
        let kinds = [Quantity::Angle, Quantity::AngularRate];
        let rotation = lookup.three("rotation", &mapping.rotation, kinds, Channel::Rotation)?;
        let kinds = [Quantity::Velocity, Quantity::Acceleration];
        let velocity = lookup.three("velocity", &mapping.velocity, kinds, Channel::Velocity)?;
        if let Some(gimbal) = &mapping.gimbal {
            for (key, signal, channel) in [
                ("gimbal.azimuth", &gimbal.azimuth, Channel::Azimuth),
                ("gimbal.roll", &gimbal.roll, Channel::Roll),
            ] {
                let one = One { signal: signal.clone(), unit: gimbal.unit.clone() };
                lookup.one(key, &one, Quantity::Angle, channel)?;
            }
        }
        let mut sequence = None;
        if let Some(one) = &mapping.sequence {
            let named = lookup.find("sequence", &one.signal)?;
            named.counter()?;
            lookup.add(Channel::Sequence, &named);
            sequence = Some(Rollover::new(named.extract.size));
        }
        let mut stamp = None;
        if let Some(one) = &mapping.stamp {
            let named = lookup.one("stamp", one, Quantity::Time, Channel::Stamp)?;
            named.counter()?;
            let counter = Rollover::new(named.extract.size);
            stamp = Some(Ticks { counter, tick_ns: named.extract.factor * 1e9 });
        }
        if let Some(one) = &mapping.interval {
            lookup.one("interval", one, Quantity::Time, Channel::Interval)?;
        }
        if let Some(one) = &mapping.temperature {
            lookup.one("temperature", one, Quantity::Temperature, Channel::Temperature)?;
        }
        if let Some(valid) = &mapping.valid {
            let named = lookup.find("valid", &valid.signal)?;
            lookup.add(Channel::Valid, &named);
        }
        for name in &mapping.counters {
            let named = lookup.find("counters", name)?;
            named.counter()?;
            lookup.add(Channel::Counter, &named);
        }
        lookup.in_order()?;
        Ok(Self {
            sources: lookup.sources,
            rotation,
            velocity,
            valid_equals: mapping.valid.as_ref().map_or(0, |valid| valid.equals),
            sequence,
            stamp,
            next: 0,
            reading: Reading::NOTHING,
            gimbal: [None; 2],
            counter: None,
            mixed: false,
            last_sequence: None,
            counters: CanCounters::default(),
        })
    }

    /// Identifiers of the messages, and true for 29 bits: the filter of the bus has to pass them.
    pub fn identifiers(&self) -> impl Iterator<Item = (u32, bool)> + '_ {
        self.sources.iter().map(|source| match source.id {
            MessageId::Standard(id) => (id.into(), false),
            MessageId::Extended(id) => (id, true),
        })
    }

    /// Counts of the traffic so far.
    #[must_use]
    pub fn counters(&self) -> &CanCounters {
        &self.counters
    }

    /// Takes a frame, and returns the reading that it completes.
    pub fn receive(&mut self, frame: &CanFrame<'_>) -> Option<Reading> {
        self.counters.frames += 1;
        let found = self.sources.iter().position(|source| match source.id {
            MessageId::Standard(id) => !frame.extended && u32::from(id) == frame.id,
            MessageId::Extended(id) => frame.extended && id == frame.id,
        });
        let Some(index) = found else {
            self.counters.other += 1;
            return None;
        };
        if frame.data.len() < self.sources[index].bytes {
            self.counters.short += 1;
            self.give_up();
            return None;
        }
        if index == 0 {
            self.give_up();
            self.reading = Reading::NOTHING;
            (self.gimbal, self.counter, self.mixed) = ([None; 2], None, false);
            for (measured, (kind, lsb)) in [
                (&mut self.reading.rotation, self.rotation),
                (&mut self.reading.velocity, self.velocity),
            ] {
                *measured = Some(MeasuredTriad { kind, value: [0.0; 3], lsb });
            }
        } else if index != self.next {
            self.counters.orphaned += 1;
            self.give_up();
            return None;
        }
        self.next = index + 1;
        self.read(index, frame.data);
        if self.next < self.sources.len() {
            return None;
        }
        self.next = 0;
        if self.mixed {
            self.counters.mixed += 1;
            return None;
        }
        Some(self.complete())
    }

    /// Drops an incomplete reading.
    fn give_up(&mut self) {
        if self.next > 0 {
            self.counters.incomplete += 1;
        }
        self.next = 0;
    }

    fn read(&mut self, index: usize, data: &[u8]) {
        let reading = &mut self.reading;
        for (channel, extract) in &self.sources[index].values {
            match channel {
                Channel::Rotation(axis) => {
                    if let Some(rotation) = &mut reading.rotation {
                        rotation.value[*axis] = extract.value(data);
                    }
                }
                Channel::Velocity(axis) => {
                    if let Some(velocity) = &mut reading.velocity {
                        velocity.value[*axis] = extract.value(data);
                    }
                }
                Channel::Azimuth => self.gimbal[0] = Some(extract.value(data)),
                Channel::Roll => self.gimbal[1] = Some(extract.value(data)),
                // The raw number is continued when the reading is complete: a dropped reading moves no
                // counter.
                Channel::Sequence => reading.sequence = Some(extract.raw(data)),
                Channel::Stamp => {
                    reading.stamp =
                        Some(Stamp { ns: extract.raw(data), clock: StampClock::Startup });
                }
                Channel::Interval => reading.interval_s = Some(extract.value(data)),
                Channel::Temperature => reading.temperature_c = Some(extract.value(data) as f32),
                Channel::Valid => {
                    let raw = extract.raw(data);
                    reading.status_word = u32::try_from(raw).ok();
                    reading.status.set(Status::INERTIAL_INVALID, raw != self.valid_equals);
                }
                Channel::Counter => {
                    let raw = extract.raw(data);
                    self.mixed |= *self.counter.get_or_insert(raw) != raw;
                }
            }
        }
    }

    fn complete(&mut self) -> Reading {
        let mut reading = self.reading;
        if let (Some(raw), Some(counter)) = (reading.sequence, &mut self.sequence) {
            reading.sequence = Some(counter.continued(raw));
        }
        if let (Some(stamp), Some(ticks)) = (&mut reading.stamp, &mut self.stamp) {
            stamp.ns = ticks.ns(stamp.ns);
        }
        if let [Some(azimuth), Some(roll)] = self.gimbal {
            reading.gimbal = Some(GimbalAngles::from_rad(azimuth, roll));
        }
        let counters = &mut self.counters;
        counters.readings += 1;
        if let Some(sequence) = reading.sequence {
            match self.last_sequence {
                Some(last) if sequence > last => counters.missing += sequence - last - 1,
                Some(_) => counters.behind += 1,
                None => {}
            }
            self.last_sequence = Some(sequence);
        }
        reading
    }
}
