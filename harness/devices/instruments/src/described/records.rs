//! Records of one length that follow each other in a file, without bytes that they begin with.
//!
//! Nothing in such a file tells where a record begins: with a wrong length every number after the first record is
//! made of pieces of others. So the values are looked at, and the first one that no sensor gives, or a stamp that isn't
//! after the one before it, ends the reading with the number of its record.

use super::{
    FRAME_BYTES_MAX, FieldMeaning, FrameChecksum, FrameField, Gather, RecordDescriptionError,
};
use crate::framing::{FramingEvent, ReadingCounters, ReadingDefect, UnreadBytes};
use crate::record_defect::{FoundNumber, RecordDefect};
use crate::rollover::Rollover;
use crate::{Reading, ReadingKind};

/// Most fields of a record.
pub const RECORD_FIELDS_MAX: usize = 64;

/// Largest rate of rotation of any gyro, rad/s, and force of any accelerometer, m/s²: well above those of a shell.
const MEANS_MAX: (f64, f64) = (1e4, 1e7);
/// Largest increments of any unit, rad and m/s: 16 turns, and 100 g for a second.
const INCREMENTS_MAX: (f64, f64) = (100.0, 1e3);

/// Records of one length.
#[derive(Clone, Debug)]
pub struct FixedRecords {
    skip: u64,
    bytes: usize,
    checksum: Option<FrameChecksum>,
    fields: [Option<FrameField>; RECORD_FIELDS_MAX],
    counter: Rollover,
    stamp: Rollover,
}

impl FixedRecords {
    /// Describes records of so many bytes, behind `skip` bytes of the file.
    ///
    /// # Errors
    /// If there are too many fields, or a number is outside of the record.
    pub fn new(
        skip: u64,
        bytes: usize,
        checksum: Option<FrameChecksum>,
        fields: &[FrameField],
        counter: Rollover,
        stamp: Rollover,
    ) -> Result<Self, RecordDescriptionError> {
        let counts = [
            (bytes, FRAME_BYTES_MAX, "bytes of a record"),
            (fields.len(), RECORD_FIELDS_MAX, "fields"),
        ];
        for (found, most, what) in counts {
            if !(1..=most).contains(&found) {
                return Err(RecordDescriptionError::Count { found, what, most });
            }
        }
        let numbers = fields.iter().map(|field| &field.number);
        for number in numbers.chain(checksum.as_ref().map(|check| &check.number)) {
            if number.at.saturating_add(number.number.bytes()) > bytes {
                return Err(RecordDescriptionError::Outside { frame: 1, at: number.at, bytes });
            }
        }
        let mut all = [None; RECORD_FIELDS_MAX];
        for (room, field) in all.iter_mut().zip(fields) {
            *room = Some(*field);
        }
        Ok(Self { skip, bytes, checksum, fields: all, counter, stamp })
    }
}

/// Reads records from the start of a file.
#[derive(Clone, Debug)]
pub struct RecordsDecoder {
    records: FixedRecords,
    skip_left: u64,
    held: [u8; FRAME_BYTES_MAX],
    length: usize,
    /// Number of records so far.
    number: u64,
    /// Stamp of the last record, ns.
    last_stamp_ns: Option<u64>,
    last_sequence: Option<u64>,
    is_damaged: bool,
    counters: ReadingCounters,
}

impl RecordsDecoder {
    /// Makes a decoder that has received nothing.
    #[must_use]
    pub fn new(records: FixedRecords) -> Self {
        Self {
            skip_left: records.skip,
            records,
            held: [0; FRAME_BYTES_MAX],
            length: 0,
            number: 0,
            last_stamp_ns: None,
            last_sequence: None,
            is_damaged: false,
            counters: ReadingCounters::default(),
        }
    }

    /// Counts of the traffic so far. Bytes that are skipped by the description count as framed.
    #[must_use]
    pub fn counters(&self) -> &ReadingCounters {
        &self.counters
    }

    /// Takes bytes up to the end of the next record with an event, and returns the event. Returns `None` when all
    /// bytes are taken: call it until then.
    #[inline]
    pub fn next(&mut self, bytes: &mut &[u8]) -> Option<FramingEvent> {
        if self.skip_left > 0 {
            let skipped = bytes.len().min(usize::try_from(self.skip_left).unwrap_or(usize::MAX));
            self.skip_left -= skipped as u64;
            self.counters.bytes += skipped as u64;
            self.counters.bytes_framed += skipped as u64;
            *bytes = &bytes[skipped..];
        }
        loop {
            let more = (self.records.bytes - self.length).min(bytes.len());
            self.held[self.length..self.length + more].copy_from_slice(&bytes[..more]);
            self.length += more;
            self.counters.bytes += more as u64;
            *bytes = &bytes[more..];
            if self.length < self.records.bytes {
                return None;
            }
            self.length = 0;
            self.number += 1;
            if let Some(event) = self.record() {
                return Some(event);
            }
        }
    }

    /// Ends the input: the bytes of an incomplete record are lost.
    pub fn end(&mut self) -> Option<FramingEvent> {
        self.counters.bytes_lost += self.length as u64;
        self.length = 0;
        None
    }

    fn record(&mut self) -> Option<FramingEvent> {
        let bytes = self.records.bytes;
        match self.read() {
            Ok(reading) => {
                self.counters.bytes_framed += bytes as u64;
                self.is_damaged = false;
                let Some(reading) = reading else {
                    self.counters.other += 1;
                    return None;
                };
                self.counters.readings += 1;
                self.counters.in_sequence(&mut self.last_sequence, reading.sequence);
                Some(FramingEvent::Reading(reading))
            }
            Err(cause) => {
                self.counters.cause(cause);
                self.counters.bytes_lost += bytes as u64;
                self.is_damaged = true;
                Some(FramingEvent::Lost(UnreadBytes { cause, bytes }))
            }
        }
    }

    fn read(&mut self) -> Result<Option<Reading>, ReadingDefect> {
        let wrong = |cause| ReadingDefect::Record { number: self.number, cause };
        let bytes = &self.held[..self.records.bytes];
        if let Some(checksum) = &self.records.checksum {
            let (found, computed) = checksum.found_and_computed(bytes);
            if found != computed {
                let defect = ReadingDefect::Checksum { found, computed };
                return Err(if self.is_damaged { wrong(RecordDefect::Checksums) } else { defect });
            }
        }
        let FixedRecords { fields, counter, stamp, .. } = &mut self.records;
        let mut gather = Gather::new(counter, stamp);
        for FrameField { number, meaning } in fields.iter().flatten() {
            believable(meaning, number.value(bytes)).map_err(wrong)?;
            gather.take(meaning, FrameField { number: *number, meaning: *meaning }.number(bytes));
        }
        let stamp_ns = gather.reading.stamp.map(|stamp| stamp.ns);
        if let (Some(now_ns), Some(before_ns)) = (stamp_ns, self.last_stamp_ns)
            && now_ns <= before_ns
        {
            return Err(wrong(RecordDefect::Stamp { now_ns, before_ns }));
        }
        self.last_stamp_ns = stamp_ns;
        Ok(gather.end())
    }
}

/// Checks that a field may have a value.
#[inline]
fn believable(meaning: &FieldMeaning, value: f64) -> Result<(), RecordDefect> {
    let field = meaning.name();
    // A thermometer that isn't there is often no number.
    if !value.is_finite() && !matches!(meaning, FieldMeaning::Temperature { .. }) {
        return Err(RecordDefect::NotFinite { field, found: FoundNumber::of(value) });
    }
    let (kind, zero, scale, is_gyro) = match *meaning {
        FieldMeaning::Rotation { kind, zero, scale, .. } => (kind, zero, scale, true),
        FieldMeaning::Velocity { kind, zero, scale, .. } => (kind, zero, scale, false),
        _ => return Ok(()),
    };
    let (gyro_max, accel_max) = match kind {
        ReadingKind::Mean => MEANS_MAX,
        ReadingKind::Increment => INCREMENTS_MAX,
    };
    let found = (value - zero) * scale;
    if found.abs() > if is_gyro { gyro_max } else { accel_max } {
        return Err(RecordDefect::Beyond { field, found: FoundNumber::of(found) });
    }
    Ok(())
}
