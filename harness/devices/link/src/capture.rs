//! Bytes of an instrument that sends on its own, kept as they come: to a file, with the time of arrival before each sentence
//! where that is wanted.

use crate::port::{Bytes, PortError};
use octant_base::utc;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Interval between two writes of what came: a kill costs no more.
const WRITTEN_EVERY: Duration = Duration::from_secs(1);
/// Number of bytes that are received at a time: the longest datagram, of which a shorter room would lose the rest.
const RECEIVED_BYTES: usize = 1 << 16;

/// Form of the time of arrival before a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrivalStamp {
    /// A TAG block with its parameter `c`, before sentences that have none.
    TagBlock,
    /// Date and time of day, as loggers write it, before each sentence, TAG block and header of a datagram.
    Written,
}

/// Writes times of arrival into a stream of sentences, and everything else as it came.
#[derive(Clone, Copy, Debug)]
struct Stamper {
    stamp: ArrivalStamp,
    begins_line: bool,
    /// Time of the last line. Several that came at once have times of their own, in their order.
    last: SystemTime,
}

/// Time between two lines that came at once.
const NEXT: Duration = Duration::from_micros(1);
/// Time up to which a line before the last one came at once with it.
const AT_ONCE: Duration = Duration::from_millis(100);

impl Stamper {
    fn write(&mut self, came: &[u8], at: SystemTime, to: &mut Vec<u8>) {
        for part in came.split_inclusive(|byte| *byte == b'\n') {
            if self.begins_line {
                let is_at_once = self.last.duration_since(at).is_ok_and(|before| before < AT_ONCE);
                // A clock that was set back is left as it is.
                self.last = if is_at_once { self.last + NEXT } else { at };
                self.begin(part, self.last, to);
            }
            to.extend_from_slice(part);
            self.begins_line = part.ends_with(b"\n");
        }
    }

    fn begin(&self, line: &[u8], at: SystemTime, to: &mut Vec<u8>) {
        let is_sentence = matches!(line.first(), Some(b'$' | b'!'));
        match self.stamp {
            ArrivalStamp::TagBlock if is_sentence => {
                let since = at.duration_since(UNIX_EPOCH).unwrap_or_default();
                let fields = format!("c:{}", since.as_millis());
                let sum = fields.bytes().fold(0, |sum, byte| sum ^ byte);
                to.extend_from_slice(format!("\\{fields}*{sum:02X}\\").as_bytes());
            }
            ArrivalStamp::Written
                if is_sentence || line.first() == Some(&b'\\') || line.starts_with(b"UdPbC") =>
            {
                to.extend_from_slice(format!("{} ", utc::nanos(at)).as_bytes());
            }
            ArrivalStamp::TagBlock | ArrivalStamp::Written => {}
        }
    }
}

/// Counts of a capture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CaptureCounts {
    /// Bytes that came.
    pub bytes: u64,
    /// Time from the first byte to the last one.
    pub lasted: Duration,
    /// Longest time without a byte between them.
    pub longest_silence: Duration,
    /// Number of times that the port went away and came back.
    pub reopened: u64,
}

/// A port whose bytes are kept in a file.
#[derive(Debug)]
pub struct LineCapture {
    port: Box<dyn Bytes>,
    file: File,
    path: PathBuf,
    stamper: Option<Stamper>,
    buffer: Box<[u8]>,
    waiting: Vec<u8>,
    written: Instant,
    first: Option<Instant>,
    is_held: bool,
    last: Instant,
    counts: CaptureCounts,
}

impl LineCapture {
    /// Makes a new file for the bytes of a port.
    ///
    /// # Errors
    /// If the file can't be created, or is there already.
    pub fn new(
        port: Box<dyn Bytes>,
        path: &Path,
        stamp: Option<ArrivalStamp>,
    ) -> std::io::Result<Self> {
        let file = OpenOptions::new().write(true).create_new(true).open(path)?;
        let now = Instant::now();
        Ok(Self {
            port,
            file,
            path: path.to_owned(),
            stamper: stamp.map(|stamp| Stamper { stamp, begins_line: true, last: UNIX_EPOCH }),
            buffer: vec![0; RECEIVED_BYTES].into_boxed_slice(),
            waiting: Vec::new(),
            written: now,
            first: None,
            is_held: false,
            last: now,
            counts: CaptureCounts::default(),
        })
    }

    /// Name under which the instrument reaches the port.
    #[must_use]
    pub fn reached_at(&self) -> String {
        self.port.reached_at()
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Counts so far.
    #[must_use]
    pub fn counts(&self) -> CaptureCounts {
        self.counts
    }

    /// Time at which the first byte came.
    #[must_use]
    pub fn first(&self) -> Option<Instant> {
        self.first
    }

    /// Time since the last byte; since the beginning, before the first one.
    #[must_use]
    pub fn silent_for(&self) -> Duration {
        self.last.elapsed()
    }

    /// Begins with a unit that was switched on again: it may send from another port of its own.
    pub fn begin_again(&mut self) {
        self.expect_from_now();
        self.port.hold_peer(false);
        self.is_held = false;
    }

    /// Begins the time without a byte anew: nothing was expected until now.
    pub fn expect_from_now(&mut self) {
        self.last = Instant::now();
    }

    /// Takes what comes within a time; returns the bytes.
    ///
    /// # Errors
    /// If the port is gone.
    pub fn receive(&mut self, wait: Duration) -> Result<&[u8], PortError> {
        let count = self.port.receive(&mut self.buffer, wait)?;
        let came = &self.buffer[..count];
        if count == 0 {
            return Ok(came);
        }
        let now = Instant::now();
        if self.first.is_none() {
            self.first = Some(now);
        } else {
            self.counts.longest_silence = self.counts.longest_silence.max(now - self.last);
        }
        if !std::mem::replace(&mut self.is_held, true) {
            // The first sender on UDP counts, and no other.
            self.port.hold_peer(true);
        }
        self.last = now;
        self.counts.lasted = self.first.map_or(Duration::ZERO, |first| now - first);
        self.counts.bytes += count as u64;
        match &mut self.stamper {
            None => self.waiting.extend_from_slice(came),
            Some(stamper) => {
                stamper.write(came, SystemTime::now(), &mut self.waiting);
                // Two datagrams are two lines, also where a sender ends none.
                if self.port.datagrams() && !stamper.begins_line {
                    self.waiting.push(b'\n');
                    stamper.begins_line = true;
                }
            }
        }
        Ok(came)
    }

    /// Opens a port again that went away; false: it isn't back.
    pub fn reopen(&mut self) -> bool {
        let is_back = self.port.reopen().is_ok();
        self.counts.reopened += u64::from(is_back);
        // A record that was cut off isn't continued.
        if let Some(stamper) =
            self.stamper.as_mut().filter(|stamper| is_back && !stamper.begins_line)
        {
            self.waiting.push(b'\n');
            stamper.begins_line = true;
        }
        is_back
    }

    /// Writes what came to the file, where the last write is long enough ago.
    ///
    /// # Errors
    /// If the file can't be written.
    pub fn write_if_due(&mut self) -> std::io::Result<()> {
        if self.written.elapsed() < WRITTEN_EVERY {
            return Ok(());
        }
        self.write()
    }

    /// Writes what came to the file.
    ///
    /// # Errors
    /// If the file can't be written.
    pub fn write(&mut self) -> std::io::Result<()> {
        self.file.write_all(&self.waiting).and_then(|()| self.file.sync_data())?;
        self.waiting.clear();
        self.written = Instant::now();
        Ok(())
    }
}
