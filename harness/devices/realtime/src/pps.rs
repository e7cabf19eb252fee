//! Pulses that the kernel stamps (1PPS), as its file in `/sys/class/pps` gives the last one.
//!
//! The file has one line, `SECONDS.NANOSECONDS#SEQUENCE`: the time of the last pulse by the realtime
//! clock, and its number. Any other file of that form can stand in its place.

use crate::host_clocks::HostClocks;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Oldest pulse that is taken when it is seen first: the next one follows after a second.
const AGE_MOST_NS: i128 = 1_500_000_000;
/// Room for the line: of 64-bit seconds, nine digits and 32-bit number.
const LINE: usize = 64;

/// Edge of a pulse at which its second begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum PulseEdge {
    /// The edge that the kernel calls assert.
    #[default]
    Assert,
    /// The other one.
    Clear,
}

impl PulseEdge {
    /// Name of its file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Assert => "assert",
            Self::Clear => "clear",
        }
    }
}

/// A pulse as the kernel's file has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StampedPulse {
    /// Time by the realtime clock, since 1970, ns.
    pub realtime_ns: i128,
    /// Number of the pulse, in 32 bits.
    pub sequence: u32,
}

impl StampedPulse {
    /// Reads `SECONDS.NANOSECONDS#SEQUENCE`.
    #[must_use]
    pub fn parse(line: &str) -> Option<Self> {
        let line = line.strip_suffix('\n').unwrap_or(line);
        let (time, sequence) = line.split_once('#')?;
        let (seconds, nanoseconds) = time.split_once('.')?;
        let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
        if !digits(seconds) || !digits(sequence) || !digits(nanoseconds) || nanoseconds.len() != 9 {
            return None;
        }
        let seconds: u64 = seconds.parse().ok()?;
        let nanoseconds: u32 = nanoseconds.parse().ok()?;
        Some(Self {
            realtime_ns: i128::from(seconds) * 1_000_000_000 + i128::from(nanoseconds),
            sequence: sequence.parse().ok()?,
        })
    }
}

/// A pulse on the monotonic clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HostPulse {
    /// When it came.
    pub at: Instant,
    /// Bound of the conversion's error.
    pub within: Duration,
}

/// Counts of looks at a file of pulses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PulseLooks {
    /// Pulses seen.
    pub seen: u64,
    /// Pulses that weren't seen, by the gaps of their numbers.
    pub skipped: u64,
    /// Pulses whose number was that of the pulse before, or an earlier one.
    pub repeated: u64,
    /// Pulses that were in the future, or too old when they were seen first.
    pub untimely: u64,
    /// Pulses that came about a step of the realtime clock, and can't be converted.
    pub about_steps: u64,
    /// Steps of the realtime clock.
    pub steps: u64,
    /// Largest of them, with its sign, ns.
    pub step_largest_ns: i64,
    /// Looks that found no line of the kernel's form.
    pub unread: u64,
}

/// A file has no pulses.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {reason}", path.display())]
pub struct PulseFileError {
    /// The file.
    pub path: PathBuf,
    /// Reason.
    pub reason: String,
}

/// Reads pulses from their file. Only a change of the file is a pulse.
#[derive(Clone, Debug)]
pub struct PulseReader {
    path: PathBuf,
    last: StampedPulse,
    clocks: HostClocks,
    looks: PulseLooks,
    /// Description of the last look that found no pulse's line.
    unread: Option<String>,
}

impl PulseReader {
    /// Opens a device `/dev/ppsN`, a folder with the files `assert` and `clear`, or a file.
    ///
    /// # Errors
    /// If there is no such file, or it has another form.
    pub fn open(device: &str, edge: PulseEdge) -> Result<Self, PulseFileError> {
        let path = pulse_file(Path::new(device), edge);
        match look(&path) {
            Ok(last) => {
                let (clocks, looks) = (HostClocks::read(), PulseLooks::default());
                Ok(Self { path, last, clocks, looks, unread: None })
            }
            Err(reason) => Err(PulseFileError { path, reason }),
        }
    }

    /// Looks for a pulse that came since the last look.
    pub fn look(&mut self) -> Option<HostPulse> {
        // The clocks are read after the file: of a pulse that is seen, a step before it is known.
        let found = look(&self.path);
        self.found(found, HostClocks::read())
    }

    /// Judges what a look found, with a reading of the clocks after it.
    pub fn found(
        &mut self,
        found: Result<StampedPulse, String>,
        clocks: HostClocks,
    ) -> Option<HostPulse> {
        let looks = &mut self.looks;
        let step_ns = clocks.step_since_ns(&self.clocks);
        self.clocks = clocks;
        if let Some(step_ns) = step_ns {
            looks.steps += 1;
            if step_ns.unsigned_abs() > u128::from(looks.step_largest_ns.unsigned_abs()) {
                looks.step_largest_ns =
                    i64::try_from(step_ns).unwrap_or(if step_ns < 0 { i64::MIN } else { i64::MAX });
            }
        }
        let pulse = match found {
            Ok(pulse) => pulse,
            Err(reason) => {
                looks.unread += 1;
                self.unread = Some(reason);
                return None;
            }
        };
        let last = std::mem::replace(&mut self.last, pulse);
        if pulse == last {
            return None;
        }
        // Numbers go on at zero after the last one: half of them are ahead.
        let ahead = pulse.sequence.wrapping_sub(last.sequence);
        if ahead == 0 || ahead > u32::MAX / 2 {
            looks.repeated += 1;
            return None;
        }
        looks.seen += 1;
        looks.skipped += u64::from(ahead - 1);
        if step_ns.is_some() {
            looks.about_steps += 1;
            return None;
        }
        let age_ns = clocks.other_ns - pulse.realtime_ns;
        let at = clocks.at(pulse.realtime_ns);
        match at.filter(|_| (-(clocks.within.as_nanos() as i128)..=AGE_MOST_NS).contains(&age_ns)) {
            Some(at) => Some(HostPulse { at, within: clocks.within }),
            None => {
                looks.untimely += 1;
                None
            }
        }
    }

    /// Counts so far.
    #[must_use]
    pub const fn looks(&self) -> PulseLooks {
        self.looks
    }

    /// The file, and of the last look that failed the reason.
    #[must_use]
    pub fn told(&self) -> String {
        let path = self.path.display();
        match &self.unread {
            None => path.to_string(),
            Some(reason) => format!("{path}: {reason}"),
        }
    }
}

/// File in which the kernel has the pulses of a device.
fn pulse_file(device: &Path, edge: PulseEdge) -> PathBuf {
    let name = device.strip_prefix("/dev").ok().and_then(Path::to_str);
    match name.filter(|name| name.starts_with("pps") && !name.contains('/')) {
        Some(name) => Path::new("/sys/class/pps").join(name).join(edge.name()),
        None if device.is_dir() => device.join(edge.name()),
        None => device.to_owned(),
    }
}

fn look(path: &Path) -> Result<StampedPulse, String> {
    let mut line = [0; LINE];
    let mut file = File::open(path).map_err(|error| error.to_string())?;
    let mut length = 0;
    while let Some(rest) = line.get_mut(length..).filter(|rest| !rest.is_empty()) {
        match file.read(rest).map_err(|error| error.to_string())? {
            0 => break,
            count => length += count,
        }
    }
    let text = String::from_utf8_lossy(&line[..length]);
    StampedPulse::parse(&text)
        .ok_or_else(|| format!("found {text:?}, expected SECONDS.NANOSECONDS#SEQUENCE"))
}
