//! `octant capture`: what an instrument sends, byte for byte.

use crate::arguments::seconds;
use crate::failure::Failure;
use crate::terminal::{note, print};
use clap::Args;
use octant_base::interrupt;
use octant_link::Uri;
use octant_link::port::{self, Bytes, Port};
use octant_verdict::Verdict;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

#[derive(Debug, Args)]
pub(super) struct CaptureArguments {
    #[arg(value_name = "URI", help = octant_link::uri::instrument_help())]
    uri: String,
    /// New file for the bytes.
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Ends this long after the first byte; by default at Ctrl-C.
    #[arg(long, value_name = "TIME", allow_negative_numbers = true)]
    duration: Option<String>,
    /// Ends as an error when nothing comes for so long; 0: never.
    #[arg(long, value_name = "TIME", default_value = "10 s", allow_negative_numbers = true)]
    silence: String,
    /// Write a TAG block with the time of arrival before each line that begins with $ or !: for sentences without a time.
    #[arg(long)]
    stamp: bool,
}

/// Longest wait in one poll of the port, which bounds the reaction to Ctrl-C.
const WAIT: Duration = Duration::from_millis(50);
/// Interval between two writes of what came: a kill costs no more.
const WRITTEN_EVERY: Duration = Duration::from_secs(1);
/// Longest time on the command line, s.
const TIME_MAX_S: f64 = 1e8;

pub(super) fn command(arguments: &CaptureArguments) -> Result<Verdict, Failure> {
    let CaptureArguments { uri, out, duration, silence, stamp } = arguments;
    let uri: Uri = (uri.parse())
        .map_err(|error| Failure::input(format!("failed to read the port: {error}")))?;
    let time = |name: &str, text: &str| {
        let found = seconds(name, text)?;
        let is_sound = (0.0..=TIME_MAX_S).contains(&found);
        is_sound.then(|| Duration::from_secs_f64(found)).ok_or_else(|| {
            Failure::input(format!("{name}: found {text:?}, expected 0 to {TIME_MAX_S:.0} s"))
        })
    };
    let duration = duration.as_ref().map(|text| time("--duration", text)).transpose()?;
    if duration.is_some_and(|duration| duration.is_zero()) {
        return Err(Failure::input("--duration: found 0 s, expected more"));
    }
    let silence = Some(time("--silence", silence)?).filter(|time| !time.is_zero());
    if matches!(&uri, Uri::Udp(udp) if udp.secret.is_some()) {
        let message =
            format!("found {uri}, expected no secret: an instrument's datagrams have no seal");
        return Err(Failure::input(message));
    }
    let Port::Bytes(mut port) = port::open_instrument(&uri)
        .map_err(|error| Failure::bench(format!("failed to {error}")))?
    else {
        return Err(Failure::input(format!("found {uri}, expected a serial line, UDP or TCP")));
    };
    let mut written = Written::new(out)?;
    written.stamper = stamp.then(Stamper::default);
    interrupt::watch(|| {})
        .map_err(|error| Failure::bench(format!("failed to wait for Ctrl-C: {error}")))?;
    let does =
        if matches!(&uri, Uri::Tcp(tcp) if !tcp.listen) { "connected to" } else { "listening on" };
    note!("octant: {does} {}", port.reached_at());
    let ended = written.receive(port.as_mut(), duration, silence);
    written.flush()?;
    print(&written.summary(out))?;
    ended
}

/// Writes a TAG block with the time of arrival before each sentence that begins a line, and everything else as it came.
#[derive(Clone, Copy, Debug)]
struct Stamper {
    begins_line: bool,
}

impl Default for Stamper {
    fn default() -> Self {
        Self { begins_line: true }
    }
}

impl Stamper {
    fn write(&mut self, came: &[u8], at: SystemTime, to: &mut Vec<u8>) {
        for part in came.split_inclusive(|byte| *byte == b'\n') {
            if self.begins_line && matches!(part.first(), Some(b'$' | b'!')) {
                let since = at.duration_since(UNIX_EPOCH).unwrap_or_default();
                let fields = format!("c:{}", since.as_millis());
                let sum = fields.bytes().fold(0, |sum, byte| sum ^ byte);
                to.extend_from_slice(format!("\\{fields}*{sum:02X}\\").as_bytes());
            }
            to.extend_from_slice(part);
            self.begins_line = part.ends_with(b"\n");
        }
    }
}

/// The file, and what came into it.
struct Written {
    file: File,
    path: String,
    waiting: Vec<u8>,
    bytes: u64,
    first: Option<Instant>,
    last: Instant,
    longest_silence: Duration,
    /// Writes times of arrival, where they are wanted.
    stamper: Option<Stamper>,
}

impl Written {
    fn new(path: &Path) -> Result<Self, Failure> {
        let file = OpenOptions::new().write(true).create_new(true).open(path);
        let file = file.map_err(|error| match error.kind() {
            ErrorKind::AlreadyExists => Failure::input(format!(
                "{}: found a file, expected a new name: what was captured is never overwritten",
                path.display()
            )),
            _ => Failure::bench(format!("failed to create {}: {error}", path.display())),
        })?;
        Ok(Self {
            file,
            path: path.display().to_string(),
            waiting: Vec::new(),
            bytes: 0,
            first: None,
            last: Instant::now(),
            longest_silence: Duration::ZERO,
            stamper: None,
        })
    }

    fn receive(
        &mut self,
        port: &mut dyn Bytes,
        duration: Option<Duration>,
        silence: Option<Duration>,
    ) -> Result<Verdict, Failure> {
        let mut buffer = [0; 1 << 16];
        let mut flushed = Instant::now();
        loop {
            let count = port
                .receive(&mut buffer, WAIT)
                .map_err(|error| Failure::bench(format!("{error}; {}", self.kept())))?;
            let now = Instant::now();
            if count > 0 {
                if self.first.is_none() {
                    self.first = Some(now);
                    // The first sender on UDP counts, and no other.
                    port.hold_peer(true);
                } else {
                    self.longest_silence = self.longest_silence.max(now - self.last);
                }
                self.last = now;
                self.bytes += count as u64;
                match &mut self.stamper {
                    None => self.waiting.extend_from_slice(&buffer[..count]),
                    Some(stamper) => {
                        stamper.write(&buffer[..count], SystemTime::now(), &mut self.waiting);
                    }
                }
            }
            if flushed.elapsed() >= WRITTEN_EVERY {
                self.flush()?;
                flushed = now;
            }
            if let (Some(first), Some(duration)) = (self.first, duration)
                && now - first >= duration
            {
                return Ok(Verdict::Pass);
            }
            if interrupt::seen() {
                // Without a duration that is how it ends.
                let is_whole = duration.is_none() && self.bytes > 0;
                return Ok(if is_whole { Verdict::Pass } else { Verdict::Inconclusive });
            }
            if silence.is_some_and(|silence| now - self.last >= silence) {
                return Err(Failure::bench(format!(
                    "nothing came for {:.1} s; {}",
                    (now - self.last).as_secs_f64(),
                    self.kept()
                )));
            }
        }
    }

    fn kept(&self) -> String {
        format!("{} bytes are kept in {}", self.bytes, self.path)
    }

    fn flush(&mut self) -> Result<(), Failure> {
        let written = self.file.write_all(&self.waiting).and_then(|()| self.file.sync_data());
        written
            .map_err(|error| Failure::bench(format!("failed to write {}: {error}", self.path)))?;
        self.waiting.clear();
        Ok(())
    }

    fn summary(&self, path: &Path) -> String {
        let Some(first) = self.first else {
            return format!("{}: nothing came\n", path.display());
        };
        format!(
            "{}: {} bytes in {:.1} s, longest silence {:.2} s\n",
            path.display(),
            self.bytes,
            (self.last - first).as_secs_f64(),
            self.longest_silence.as_secs_f64()
        )
    }
}
