//! Lines of text, by a description of their columns.
//!
//! A [`LineForm`] says how a line begins, what separates its columns, its checksum and its fields. Lines of other forms
//! pass. A line without a checksum is read where its beginning and its end are known: not what comes before the first
//! end of a line of a port, unless it begins as its form says, and not what follows the last one.

use super::RecordDescriptionError;
use super::field::{FieldMeaning, FieldNumber};
use super::gather::Gather;
use crate::Reading;
use crate::checksum::vectornav;
use crate::framing::{FramingEvent, ReadingCounters, ReadingDefect, UnreadBytes};
use crate::rollover::Rollover;

/// Most bytes of a line.
pub const LINE_BYTES_MAX: usize = 1024;
/// Most forms of lines.
pub const LINES_MAX: usize = 8;
/// Most fields of all forms together.
pub const LINE_FIELDS_MAX: usize = 128;
/// Most bytes of a line's beginning.
pub const BEGINS_BYTES_MAX: usize = 32;
/// Most columns of a line.
const COLUMNS_MAX: usize = LINE_BYTES_MAX;

/// Text between two columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineSeparator {
    /// One character.
    Character(u8),
    /// Any run of blanks and tabs.
    Blanks,
}

/// Checksum of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineChecksum {
    /// None: damage can't be noticed.
    None,
    /// NMEA 0183: an asterisk and two hexadecimal digits, the exclusive or of the characters between the first one and
    /// the asterisk.
    Nmea,
    /// VectorNav: the same, or four digits of their CRC-16.
    VectorNav,
}

/// A field of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineField {
    /// Column, from 1.
    pub column: usize,
    /// Meaning.
    pub meaning: FieldMeaning,
}

/// Lines of a form.
#[derive(Clone, Copy, Debug)]
pub struct LineForm<'a> {
    /// Text of its first columns; empty: any line.
    pub begins: &'a [u8],
    /// Text between two columns.
    pub separator: LineSeparator,
    /// Number of columns.
    pub columns: Option<usize>,
    /// Checksum.
    pub checksum: LineChecksum,
    /// Fields.
    pub fields: &'a [LineField],
}

#[derive(Clone, Copy, Debug)]
struct StoredForm {
    begins: [u8; BEGINS_BYTES_MAX],
    begins_bytes: usize,
    separator: LineSeparator,
    columns: Option<usize>,
    checksum: LineChecksum,
    /// Fields among all.
    fields: (usize, usize),
}

impl StoredForm {
    const NONE: Self = Self {
        begins: [0; BEGINS_BYTES_MAX],
        begins_bytes: 0,
        separator: LineSeparator::Blanks,
        columns: None,
        checksum: LineChecksum::None,
        fields: (0, 0),
    };

    fn begins(&self) -> &[u8] {
        &self.begins[..self.begins_bytes]
    }

    /// True if a line is of the form: it begins so, and a column ends there.
    fn is_of(&self, line: &[u8]) -> bool {
        let Some(rest) = line.strip_prefix(self.begins()) else { return false };
        match (self.begins_bytes, rest.first()) {
            (0, _) | (_, None | Some(b'*')) => true,
            (_, Some(next)) => self.separates(*next),
        }
    }

    fn separates(&self, byte: u8) -> bool {
        match self.separator {
            LineSeparator::Character(character) => byte == character,
            LineSeparator::Blanks => matches!(byte, b' ' | b'\t'),
        }
    }

    /// Columns of a line.
    fn split<'a>(&self, line: &'a [u8]) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let separator = self.separator;
        let of = move |byte: &u8| match separator {
            LineSeparator::Character(character) => *byte == character,
            LineSeparator::Blanks => matches!(*byte, b' ' | b'\t'),
        };
        let runs = separator == LineSeparator::Blanks;
        line.split(of).filter(move |column| !runs || !column.is_empty())
    }
}

/// The lines of a unit.
#[derive(Clone, Debug)]
pub struct LineDescription {
    forms: [StoredForm; LINES_MAX],
    form_count: usize,
    fields: [Option<LineField>; LINE_FIELDS_MAX],
    skip_lines: u64,
    counter: Rollover,
    stamp: Rollover,
}

impl LineDescription {
    /// Puts forms together; of a file, so many lines at its start are skipped. Counter and stamp are continued across
    /// their roll-over, a stamp in ns.
    ///
    /// # Errors
    /// If there are too many.
    pub fn new(
        forms: &[LineForm<'_>],
        skip_lines: u64,
        counter: Rollover,
        stamp: Rollover,
    ) -> Result<Self, RecordDescriptionError> {
        let within = |found, most, what| match found {
            found if (1..=most).contains(&found) => Ok(()),
            found => Err(RecordDescriptionError::Count { found, what, most }),
        };
        within(forms.len(), LINES_MAX, "forms of lines")?;
        let mut all = Self {
            forms: [StoredForm::NONE; LINES_MAX],
            form_count: forms.len(),
            fields: [None; LINE_FIELDS_MAX],
            skip_lines,
            counter,
            stamp,
        };
        let mut used = 0;
        for (stored, form) in all.forms.iter_mut().zip(forms) {
            within(form.begins.len() + 1, BEGINS_BYTES_MAX + 1, "bytes of a line's beginning")?;
            let end = used + form.fields.len();
            within(end, LINE_FIELDS_MAX, "fields")?;
            for (room, field) in all.fields[used..end].iter_mut().zip(form.fields) {
                within(field.column, COLUMNS_MAX, "as the number of a column")?;
                *room = Some(*field);
            }
            stored.begins[..form.begins.len()].copy_from_slice(form.begins);
            stored.begins_bytes = form.begins.len();
            stored.separator = form.separator;
            (stored.columns, stored.checksum) = (form.columns, form.checksum);
            stored.fields = (used, end);
            used = end;
        }
        Ok(all)
    }

    fn forms(&self) -> &[StoredForm] {
        &self.forms[..self.form_count]
    }
}

/// Reads lines.
#[derive(Clone, Debug)]
pub struct LinesDecoder {
    description: LineDescription,
    held: [u8; LINE_BYTES_MAX],
    length: usize,
    /// True for a line whose beginning isn't known, or that is too long: its bytes are lost.
    is_torn: bool,
    /// True for the first line of a port.
    is_first: bool,
    skip_left: u64,
    last_sequence: Option<u64>,
    counters: ReadingCounters,
}

impl LinesDecoder {
    /// Makes a decoder of a file, from its start.
    #[must_use]
    pub fn of_file(description: LineDescription) -> Self {
        Self { is_first: false, skip_left: description.skip_lines, ..Self::of_port(description) }
    }

    /// Makes a decoder of a port, which may be opened within a line.
    #[must_use]
    pub fn of_port(description: LineDescription) -> Self {
        Self {
            description,
            held: [0; LINE_BYTES_MAX],
            length: 0,
            is_torn: false,
            is_first: true,
            skip_left: 0,
            last_sequence: None,
            counters: ReadingCounters::default(),
        }
    }

    /// Counts of the traffic so far. Lines of other forms, and those that are skipped, are other frames.
    #[must_use]
    pub fn counters(&self) -> &ReadingCounters {
        &self.counters
    }

    /// True if every form has a checksum.
    #[must_use]
    pub fn has_checksums(&self) -> bool {
        self.description.forms().iter().all(|form| form.checksum != LineChecksum::None)
    }

    /// Takes bytes up to the end of the next line with an event, and returns the event. Returns `None` when all bytes
    /// are taken: call it until then.
    pub fn next(&mut self, bytes: &mut &[u8]) -> Option<FramingEvent> {
        while !bytes.is_empty() {
            let end = bytes.iter().position(|byte| *byte == b'\n');
            let taken = end.map_or(bytes.len(), |end| end + 1);
            let (line, rest) = bytes.split_at(taken);
            *bytes = rest;
            self.counters.bytes += taken as u64;
            match self.held.get_mut(self.length..self.length + taken) {
                Some(room) if !self.is_torn => {
                    room.copy_from_slice(line);
                    self.length += taken;
                }
                _ => {
                    self.counters.malformed += u64::from(!self.is_torn);
                    self.counters.bytes_lost += (self.length + taken) as u64;
                    (self.length, self.is_torn) = (0, true);
                }
            }
            if end.is_some() {
                let is_torn = core::mem::take(&mut self.is_torn);
                if !is_torn && let Some(event) = self.line() {
                    return Some(event);
                }
            }
        }
        None
    }

    /// Ends the input, also after a long silence. A line without its end is read where its checksum shows that it is
    /// whole; what comes then is no continuation of it.
    pub fn end(&mut self) -> Option<FramingEvent> {
        if self.length == 0 {
            self.is_first |= core::mem::take(&mut self.is_torn);
            return None;
        }
        let line = trimmed(&self.held[..self.length]);
        let form = self.description.forms().iter().find(|form| form.is_of(line));
        if form.is_some_and(|form| form.checksum != LineChecksum::None && digits(line).is_some()) {
            let event = self.line();
            self.is_first = true;
            return event;
        }
        self.counters.bytes_lost += self.length as u64;
        (self.length, self.is_first) = (0, true);
        None
    }

    /// Ends a datagram: a line that is whole by its checksum is read, also without its end. Without checksums a piece of a
    /// line is lost, because what comes may be no continuation of it.
    pub fn end_of_datagram(&mut self) -> Option<FramingEvent> {
        if !self.has_checksums() {
            return self.end();
        }
        let line = trimmed(&self.held[..self.length]);
        let form = self.description.forms().iter().find(|form| form.is_of(line))?;
        if checked(line, form.checksum).is_err() {
            return None;
        }
        self.line()
    }

    /// Notes that what comes next may begin within a line, as behind a new connection.
    pub fn begin_anywhere(&mut self) {
        self.is_first = true;
    }

    /// Reads the line that is held.
    fn line(&mut self) -> Option<FramingEvent> {
        let length = core::mem::take(&mut self.length);
        let is_first = core::mem::take(&mut self.is_first);
        let outcome = if self.skip_left > 0 {
            self.skip_left -= 1;
            Ok(None)
        } else {
            self.read(length, is_first)
        };
        match outcome {
            Ok(reading) => {
                self.counters.bytes_framed += length as u64;
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
                if cause.is_intact() {
                    self.counters.bytes_framed += length as u64;
                } else {
                    self.counters.bytes_lost += length as u64;
                }
                Some(FramingEvent::Lost(UnreadBytes { cause, bytes: length }))
            }
        }
    }

    fn read(&mut self, length: usize, is_first: bool) -> Result<Option<Reading>, ReadingDefect> {
        let line = trimmed(&self.held[..length]);
        if line.is_empty() {
            return Ok(None);
        }
        let Some(form) = self.description.forms().iter().find(|form| form.is_of(line)).copied()
        else {
            return Ok(None);
        };
        if is_first && form.begins_bytes == 0 && form.checksum == LineChecksum::None {
            return Err(ReadingDefect::Malformed);
        }
        let line = checked(line, form.checksum)?;
        let columns = form.split(line).count();
        if form.columns.is_some_and(|expected| expected != columns) {
            return Err(ReadingDefect::Malformed);
        }
        let (from, to) = form.fields;
        let LineDescription { fields, counter, stamp, .. } = &mut self.description;
        // Every field is read before the counter and the clock go on.
        for is_last in [false, true] {
            let mut gather = Gather::new(counter, stamp);
            for LineField { column, meaning } in fields[from..to].iter().flatten() {
                let text = form.split(line).nth(column - 1).ok_or(ReadingDefect::Malformed)?;
                let wrong = ReadingDefect::NoNumber { field: meaning.name() };
                let number = number(text.trim_ascii(), meaning).ok_or(wrong)?;
                if is_last {
                    gather.take(meaning, number);
                }
            }
            if is_last {
                return Ok(gather.end());
            }
        }
        Ok(None)
    }
}

/// A line without its end, and without blanks at both of its ends.
fn trimmed(line: &[u8]) -> &[u8] {
    line.trim_ascii()
}

/// Two or four hexadecimal digits behind an asterisk at the end of a line, and the characters before it.
fn digits(line: &[u8]) -> Option<(&[u8], &[u8])> {
    let at = line.iter().rposition(|byte| *byte == b'*')?;
    let (text, digits) = (&line[..at], &line[at + 1..]);
    let are = matches!(digits.len(), 2 | 4) && digits.iter().all(u8::is_ascii_hexdigit);
    are.then_some((text, digits))
}

/// The columns of a line whose checksum is right.
fn checked(line: &[u8], checksum: LineChecksum) -> Result<&[u8], ReadingDefect> {
    let most = match checksum {
        LineChecksum::None => return Ok(line),
        LineChecksum::Nmea => 2,
        LineChecksum::VectorNav => 4,
    };
    let (text, digits) = digits(line).ok_or(ReadingDefect::Malformed)?;
    if digits.len() > most {
        return Err(ReadingDefect::Malformed);
    }
    let digit = |byte: &u8| char::from(*byte).to_digit(16).unwrap_or(0);
    let found = digits.iter().fold(0, |found, byte| (found << 4) | digit(byte));
    let covered = text.get(1..).unwrap_or_default();
    let computed = if digits.len() == 2 {
        u32::from(covered.iter().fold(0u8, |all, byte| all ^ byte))
    } else {
        u32::from(vectornav(covered))
    };
    if found == computed { Ok(text) } else { Err(ReadingDefect::Checksum { found, computed }) }
}

/// Number of a column.
fn number(text: &[u8], meaning: &FieldMeaning) -> Option<FieldNumber> {
    let text = core::str::from_utf8(text).ok()?;
    match meaning {
        FieldMeaning::Counter | FieldMeaning::Flags { .. } => {
            let raw = match text.strip_prefix("0x").or(text.strip_prefix("0X")) {
                Some(digits) => u64::from_str_radix(digits, 16).ok()?,
                None => text.parse().ok()?,
            };
            Some(FieldNumber { value: raw as f64, raw, is_integer: true })
        }
        FieldMeaning::Stamp(size_ns) => {
            let raw = nanoseconds(text, *size_ns)?;
            Some(FieldNumber { value: raw as f64, raw, is_integer: false })
        }
        _ => Some(FieldNumber { value: text.parse().ok()?, raw: 0, is_integer: false }),
    }
}

/// Time of so many units, a decimal number, ns: exact to half a nanosecond where a unit is a whole number of ns.
fn nanoseconds(text: &str, size_ns: f64) -> Option<u64> {
    let value: f64 = text.parse().ok()?;
    if !(0.0..1.8e19).contains(&(value * size_ns)) {
        return None;
    }
    let whole_ns = size_ns as u64;
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let whole = whole.strip_prefix('+').unwrap_or(whole);
    if whole_ns as f64 != size_ns || !digits(whole) || !digits(fraction) || fraction.len() > 18 {
        return Some(libm::round(value * size_ns) as u64);
    }
    let part = |text: &str| if text.is_empty() { Some(0) } else { text.parse::<u128>().ok() };
    let (one, size) = (10u128.pow(fraction.len() as u32), u128::from(whole_ns));
    let ns = part(whole)? * size + (part(fraction)? * size + one / 2) / one;
    u64::try_from(ns).ok()
}
