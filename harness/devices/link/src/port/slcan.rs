//! CAN adapters behind a serial line that speak slcan, with a line of text for each frame.
//!
//! `tIIILDD…` is a classic frame, `dIIILDD…` an FD frame and `bIIILDD…` one whose data is faster; each
//! ends with a carriage return. Adapters answer `\r` (done), `\x07` (not done) and `z\r` (sent).

use super::bytes::Bytes;
use super::error::PortError;
use super::frames::{BusEvent, BusTrouble, Frames, HeardFrame};
use super::serial::SerialLine;
use crate::Uri;
use crate::uri::{self, SLCAN_BITRATES};
use octant_wire::can::{BusFrame, CanVersion};
use std::time::{Duration, Instant};

/// An adapter with its channel open.
#[derive(Debug)]
pub struct SlcanPort {
    line: Box<dyn Bytes>,
    slcan: uri::SlcanUri,
    text: Lines,
    buffer: [u8; 512],
    from: usize,
    to: usize,
}

/// Bytes of the longest line: `B`, identifier, length, 64 bytes of data.
const LINE_MAX: usize = 1 + 8 + 1 + 128;

/// Longest wait for an adapter's answer to a command.
const COMMAND_WAIT: Duration = Duration::from_millis(100);

impl SlcanPort {
    /// Opens the line and the channel.
    ///
    /// # Errors
    /// If the line can't be opened, or the adapter refuses its bit rate.
    pub fn open(slcan: &uri::SlcanUri) -> Result<Self, PortError> {
        let line = Box::new(SerialLine::open(&slcan.serial)?);
        Self::over(line, slcan)
    }

    /// Opens the channel of an adapter behind a line.
    ///
    /// # Errors
    /// If the line goes away, or the adapter refuses its bit rate.
    pub fn over(line: Box<dyn Bytes>, slcan: &uri::SlcanUri) -> Result<Self, PortError> {
        let slcan = slcan.clone();
        let text = Lines::default();
        let mut this = Self { line, slcan, text, buffer: [0; 512], from: 0, to: 0 };
        this.set_up()?;
        Ok(this)
    }

    /// Sets the bit rate and opens the channel.
    fn set_up(&mut self) -> Result<(), PortError> {
        let bus = self.slcan.bus;
        // An open channel accepts no bit rate; a closed one may refuse to be closed.
        self.command("C\r")?;
        let code = SLCAN_BITRATES.iter().position(|rate| *rate == bus.nominal_bps);
        let data = bus.data_bps.map(|rate| rate / 1_000_000);
        let commands = [
            code.map(|code| (format!("S{code}\r"), "bit rate")),
            data.map(|code| (format!("Y{code}\r"), "bit rate of data")),
            Some(("O\r".to_owned(), "opening of the channel")),
        ];
        for (command, what) in commands.into_iter().flatten() {
            if !self.command(&command)? {
                let uri = Uri::Slcan(self.slcan.clone());
                return Err(PortError::open(uri, format!("the adapter refuses the {what}")));
            }
        }
        Ok(())
    }

    /// Sends a command; false: the adapter refused it. Many adapters don't answer at all.
    fn command(&mut self, command: &str) -> Result<bool, PortError> {
        self.line.send(command.as_bytes(), COMMAND_WAIT)?;
        let begun = Instant::now();
        let mut answer = [0; 64];
        while begun.elapsed() < COMMAND_WAIT {
            let left = COMMAND_WAIT.saturating_sub(begun.elapsed());
            let count = self.line.receive(&mut answer, left)?;
            for (index, byte) in answer[..count].iter().enumerate() {
                match byte {
                    b'\r' => {
                        // Bytes after the answer are the first frames.
                        let rest = &answer[index + 1..count];
                        self.buffer[..rest.len()].copy_from_slice(rest);
                        (self.from, self.to) = (0, rest.len());
                        return Ok(true);
                    }
                    0x07 => return Ok(false),
                    _ => {}
                }
            }
        }
        Ok(true)
    }
}

impl SlcanPort {
    /// Receives the next frame of any node within a time.
    ///
    /// # Errors
    /// If the port is gone.
    pub fn hear(&mut self, wait: Duration) -> Result<Option<HeardFrame>, PortError> {
        let begun = Instant::now();
        loop {
            while self.from < self.to {
                let byte = self.buffer[self.from];
                self.from += 1;
                if let Some(heard) = self.text.heard(byte) {
                    return Ok(Some(heard));
                }
            }
            let left = wait.saturating_sub(begun.elapsed());
            let count = self.line.receive(&mut self.buffer, left)?;
            if count == 0 {
                return Ok(None);
            }
            (self.from, self.to) = (0, count);
        }
    }
}

impl Drop for SlcanPort {
    fn drop(&mut self) {
        // The adapter may be gone.
        let _ = self.line.send(b"C\r", COMMAND_WAIT);
    }
}

impl Frames for SlcanPort {
    fn send(&mut self, frame: &BusFrame, wait: Duration) -> Result<bool, PortError> {
        let mut line = [0; LINE_MAX + 1];
        let count = write_line(frame, &mut line);
        self.line.send(&line[..count], wait)
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<BusEvent>, PortError> {
        let begun = Instant::now();
        loop {
            while self.from < self.to {
                let byte = self.buffer[self.from];
                self.from += 1;
                if let Some(event) = self.text.push(byte) {
                    return Ok(Some(event));
                }
            }
            let left = wait.saturating_sub(begun.elapsed());
            let count = self.line.receive(&mut self.buffer, left)?;
            if count == 0 {
                return Ok(None);
            }
            (self.from, self.to) = (0, count);
        }
    }

    fn format(&self) -> CanVersion {
        self.slcan.bus.format()
    }

    fn restart(&mut self) -> Result<bool, PortError> {
        self.line.send(b"C\r", COMMAND_WAIT)?;
        self.line.send(b"O\r", COMMAND_WAIT)
    }

    fn close(&mut self) {
        self.line.close();
    }

    fn reopen(&mut self) -> Result<(), PortError> {
        self.line.reopen()?;
        self.text = Lines::default();
        (self.from, self.to) = (0, 0);
        self.set_up()
    }
}

/// Numbers of data bytes, by their length code.
const LENGTHS: [usize; 16] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64];

/// Writes a frame as a line, and returns its number of bytes.
fn write_line(frame: &BusFrame, line: &mut [u8; LINE_MAX + 1]) -> usize {
    const DIGITS: &[u8; 16] = b"0123456789ABCDEF";
    line[0] = match frame.format() {
        CanVersion::Classic => b't',
        CanVersion::Fd => b'b',
    };
    let id = usize::from(frame.id());
    for (i, shift) in [8, 4, 0].into_iter().enumerate() {
        line[1 + i] = DIGITS[id >> shift & 0xF];
    }
    let code = LENGTHS.iter().position(|length| *length == frame.data().len()).unwrap_or(0);
    line[4] = DIGITS[code];
    let mut at = 5;
    for byte in frame.data() {
        line[at] = DIGITS[usize::from(byte >> 4)];
        line[at + 1] = DIGITS[usize::from(byte & 0xF)];
        at += 2;
    }
    line[at] = b'\r';
    at + 1
}

/// Parser of an adapter's output, which finds the frames in it.
#[derive(Debug)]
struct Lines {
    line: [u8; LINE_MAX],
    length: usize,
    /// True if the line is longer than any valid one.
    long: bool,
}

impl Default for Lines {
    fn default() -> Self {
        Self { line: [0; LINE_MAX], length: 0, long: false }
    }
}

/// Unit that a byte completes.
enum Taken {
    /// A line of that many bytes.
    Line(usize),
    /// A line longer than any valid one.
    Long,
    /// The adapter refused a command.
    NotDone,
}

impl Lines {
    fn push(&mut self, byte: u8) -> Option<BusEvent> {
        match self.take(byte)? {
            Taken::Line(length) => read_line(&self.line[..length]),
            Taken::Long => Some(BusEvent::Trouble(BusTrouble::Foreign)),
            Taken::NotDone => Some(BusEvent::Trouble(BusTrouble::Overrun)),
        }
    }

    /// As [`Self::push`], for a listener: frames of any node.
    fn heard(&mut self, byte: u8) -> Option<HeardFrame> {
        match self.take(byte)? {
            Taken::Line(length) => any_frame(&self.line[..length]),
            Taken::Long | Taken::NotDone => None,
        }
    }

    fn take(&mut self, byte: u8) -> Option<Taken> {
        match byte {
            b'\r' => {
                let long = std::mem::take(&mut self.long);
                let length = std::mem::take(&mut self.length);
                Some(if long { Taken::Long } else { Taken::Line(length) })
            }
            // Refused: the channel is closed, or the adapter's queue is full.
            0x07 => {
                self.length = 0;
                self.long = false;
                Some(Taken::NotDone)
            }
            byte => {
                match self.line.get_mut(self.length) {
                    Some(place) => {
                        *place = byte;
                        self.length += 1;
                    }
                    None => self.long = true,
                }
                None
            }
        }
    }
}

/// Parses a line; `None`: it has nothing to do with frames.
fn read_line(line: &[u8]) -> Option<BusEvent> {
    let foreign = Some(BusEvent::Trouble(BusTrouble::Foreign));
    let (first, rest) = line.split_first()?;
    let format = match first {
        b't' => CanVersion::Classic,
        b'd' | b'b' => CanVersion::Fd,
        b'T' | b'r' | b'R' | b'D' | b'B' => return foreign,
        // Status flags of the adapter: bit 7 bus error, 5 passive, 2 warning, 3 overrun.
        b'F' => {
            let [high, low] = rest else { return foreign };
            let flags = digit(*high)? << 4 | digit(*low)?;
            return match flags {
                0 => None,
                flags if flags & 0x20 != 0 => Some(BusEvent::Trouble(BusTrouble::Passive)),
                flags if flags & 0x08 != 0 => Some(BusEvent::Trouble(BusTrouble::Overrun)),
                flags if flags & 0x80 != 0 => Some(BusEvent::Trouble(BusTrouble::ErrorFrame)),
                _ => Some(BusEvent::Trouble(BusTrouble::Warning)),
            };
        }
        // Answers to commands, and commands of another program on the line.
        _ => return None,
    };
    frame(format, rest).map_or(foreign, |frame| Some(BusEvent::Frame(frame)))
}

fn frame(format: CanVersion, rest: &[u8]) -> Option<BusFrame> {
    let heard = identified(3, rest)?;
    BusFrame::new(u16::try_from(heard.id).ok()?, format, heard.data())
}

/// Parses a frame with any identifier; `None`: the line is no frame with data.
fn any_frame(line: &[u8]) -> Option<HeardFrame> {
    let (first, rest) = line.split_first()?;
    let classic = matches!(first, b't' | b'T');
    let heard = match first {
        b't' | b'd' | b'b' => identified(3, rest)?,
        b'T' | b'D' | b'B' => HeardFrame { extended: true, ..identified(8, rest)? },
        _ => return None,
    };
    let most = if heard.extended { 1 << 29 } else { 1 << 11 };
    (heard.id < most && !(classic && heard.data().len() > 8)).then_some(heard)
}

/// Parses an identifier of that many digits, a length and data.
fn identified(digits: usize, rest: &[u8]) -> Option<HeardFrame> {
    let (id, rest) = rest.split_at_checked(digits)?;
    let id = id.iter().try_fold(0, |id, byte| Some(id << 4 | u32::from(digit(*byte)?)))?;
    let (length, data) = rest.split_first()?;
    let length = LENGTHS[usize::from(digit(*length)?)];
    if data.len() != 2 * length {
        return None;
    }
    let mut bytes = [0; 64];
    for (byte, pair) in bytes.iter_mut().zip(data.chunks_exact(2)) {
        *byte = digit(pair[0])? << 4 | digit(pair[1])?;
    }
    Some(HeardFrame::new(id, false, &bytes[..length]))
}

fn digit(byte: u8) -> Option<u8> {
    (byte as char).to_digit(16).map(|digit| digit as u8)
}
