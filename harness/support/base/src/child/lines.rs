//! Output of a program that isn't Octant's own, passed on to the terminal: line by line, each with the name of its
//! origin, escaped, and only as much as is allowed.

use crate::printable::printable;
use std::io::{self, Read, Write};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Longest line, bytes; a longer one is broken.
const LINE_BYTES_MAX: usize = 1000;
/// Bytes that have to be allowed after something was dropped, before more is passed on: a flood shows as whole lines
/// from time to time.
const RESUME_BYTES: u64 = 4 << 10;
/// Interval at which the end of a thread is looked for.
const LOOK: Duration = Duration::from_millis(1);

/// Limit of what is passed on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputLimit {
    /// Bytes that are passed on at once.
    pub bytes: u64,
    /// Bytes for each further second.
    pub bytes_per_s: u64,
}

/// Lines of a program, on their way to the terminal.
#[derive(Debug)]
pub struct ForeignLines<W> {
    origin: String,
    limit: OutputLimit,
    /// Bytes that may be passed on now.
    left: u64,
    /// Time up to which `left` is counted.
    counted: Instant,
    /// Bytes that were dropped since the last line that was passed on.
    dropped: u64,
    dropped_in_all: u64,
    /// Beginning of a line whose end hasn't come.
    line: Vec<u8>,
    to: W,
}

impl<W: Write> ForeignLines<W> {
    /// Passes on to a writer. `origin` stands at the beginning of each line.
    pub fn new(origin: &str, limit: OutputLimit, to: W) -> Self {
        Self {
            origin: printable(origin).into_owned(),
            limit,
            left: limit.bytes,
            counted: Instant::now(),
            dropped: 0,
            dropped_in_all: 0,
            line: Vec::new(),
            to,
        }
    }

    /// Takes what the program wrote.
    pub fn take(&mut self, bytes: &[u8]) {
        self.allow();
        let waits = self.dropped > 0 && self.left < RESUME_BYTES.min(self.limit.bytes);
        let left = if waits { 0 } else { self.left };
        let room = usize::try_from(left).unwrap_or(usize::MAX).min(bytes.len());
        let (taken, rest) = bytes.split_at(room);
        self.left -= room as u64;
        if room > 0 {
            self.tell_dropped();
        }
        for piece in taken.split_inclusive(|byte| *byte == b'\n') {
            self.line.extend_from_slice(piece);
            while self.line.len() > LINE_BYTES_MAX {
                let whole = whole_characters(&self.line[..LINE_BYTES_MAX]);
                let broken: Vec<u8> = self.line.drain(..whole).collect();
                self.pass(&broken);
            }
            if self.line.ends_with(b"\n") {
                let line = std::mem::take(&mut self.line);
                self.pass(&line);
            }
        }
        if !rest.is_empty() {
            // Its end is among the bytes that are dropped.
            self.flush();
            self.dropped += rest.len() as u64;
            self.dropped_in_all += rest.len() as u64;
        }
    }

    /// Passes on a line without an end. Returns the number of bytes that were dropped in all.
    pub fn end(&mut self) -> u64 {
        self.flush();
        self.dropped_in_all
    }

    fn flush(&mut self) {
        let line = std::mem::take(&mut self.line);
        if !line.is_empty() {
            self.pass(&line);
        }
    }

    /// Adds what the time since the last call allows.
    fn allow(&mut self) {
        let passed = self.counted.elapsed();
        let more = u64::try_from(passed.as_millis()).unwrap_or(u64::MAX);
        let more = more.saturating_mul(self.limit.bytes_per_s) / 1000;
        // A time that allows nothing yet goes on.
        if more > 0 {
            self.left = self.left.saturating_add(more).min(self.limit.bytes);
            self.counted += passed;
        }
    }

    fn tell_dropped(&mut self) {
        let dropped = std::mem::take(&mut self.dropped);
        if dropped > 0 {
            self.pass(format!("({dropped} bytes of its output were dropped)").as_bytes());
        }
    }

    fn pass(&mut self, line: &[u8]) {
        let line = line.strip_suffix(b"\n").unwrap_or(line);
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        let text = String::from_utf8_lossy(line);
        let line = format!("{}: {}\n", self.origin, printable(&text));
        // A terminal that has gone is no failure of the program.
        let _ = self.to.write_all(line.as_bytes());
    }
}

/// Number of bytes before a character that is cut at the end; all, if none is.
fn whole_characters(bytes: &[u8]) -> usize {
    match std::str::from_utf8(bytes) {
        Err(error) if error.error_len().is_none() && error.valid_up_to() > 0 => error.valid_up_to(),
        _ => bytes.len(),
    }
}

/// Thread that passes on a pipe of a program to standard error, for as long as the pipe is open.
#[derive(Debug)]
pub struct PassedOn {
    thread: JoinHandle<u64>,
    origin: String,
}

impl PassedOn {
    /// Begins to pass on.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn start(
        origin: &str,
        limit: OutputLimit,
        mut pipe: impl Read + Send + 'static,
    ) -> io::Result<Self> {
        let mut lines = ForeignLines::new(origin, limit, io::stderr());
        let thread = std::thread::Builder::new().name("foreign output".into());
        let thread = thread.spawn(move || {
            let mut buffer = [0; 4096];
            loop {
                match pipe.read(&mut buffer) {
                    Ok(0) => break,
                    Ok(count) => lines.take(&buffer[..count]),
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                    Err(_) => break,
                }
            }
            lines.end()
        })?;
        Ok(Self { thread, origin: printable(origin).into_owned() })
    }

    /// Waits until all is passed on, at most for a time: a process that the program started may hold the pipe for
    /// longer.
    pub fn settle(&self, wait: Duration) {
        let until = Instant::now() + wait;
        while !self.thread.is_finished() && Instant::now() < until {
            std::thread::sleep(LOOK);
        }
    }

    /// Waits as [`Self::settle`], and says how much was dropped.
    pub fn finish(self, wait: Duration) {
        self.settle(wait);
        if self.thread.is_finished()
            && let Ok(dropped @ 1..) = self.thread.join()
        {
            let told =
                format!("octant: {}: {dropped} bytes of its output were dropped\n", self.origin);
            let _ = io::stderr().write_all(told.as_bytes());
        }
    }
}
