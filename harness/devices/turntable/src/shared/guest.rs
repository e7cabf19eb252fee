//! The end of a run whose table is driven by another one.

use super::monotonic::Monotonic;
use super::words::{GuestWord, HostWord, SharedLook, VERSION, line};
use crate::button::knock;
use crate::following::{packed, unpacked};
use crate::{AxisStatus, Error, TableAxis, TableStatus, TableTraffic, Track, TrackPoint};
use octant_sample::GimbalCommand;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Number of looks that may wait for the thread of the samples.
const LOOKS: usize = 256;
/// Pause between two attempts to reach the driving run.
const PAUSE: Duration = Duration::from_millis(50);
/// Silence of the driving run after which it counts as lost; it tells dozens of looks a second.
const SILENCE: Duration = Duration::from_secs(2);
/// Longest time for which the own core's set point may be another one than the table's. Runs begin within milliseconds
/// of each other, and their units' clocks drift by less in any sequence.
const APART: Duration = Duration::from_secs(5);
/// Longest line, bytes.
const LONGEST: u64 = 65_536;

/// State shared by the two threads.
#[derive(Debug, Default)]
struct Shared {
    /// Set point of the table; valid once `has_target` is true.
    target: AtomicU64,
    has_target: AtomicBool,
    looks: AtomicU64,
    /// True once nothing more comes; `why` has the reason.
    over: AtomicBool,
    why: Mutex<Option<String>>,
    /// True once this end has said that it leaves.
    leaves: AtomicBool,
}

impl Shared {
    fn end(&self, why: String) {
        let mut reason = self.why.lock().unwrap_or_else(PoisonError::into_inner);
        reason.get_or_insert(why);
        self.over.store(true, Ordering::Release);
    }
}

/// A guest at a table that another run of this host drives.
#[derive(Debug)]
pub struct TableGuest {
    units: usize,
    stream: UnixStream,
    shared: Arc<Shared>,
    looks: rtrb::Consumer<TableStatus>,
    track: Track,
    /// Time since which the own core's set point differs from the table's.
    apart_since: Option<Instant>,
    thread: Option<JoinHandle<()>>,
}

impl TableGuest {
    /// Waits for the run that drives the table on a port, and then until it begins, each for `within` at most.
    ///
    /// # Errors
    /// If there is no such run, or it doesn't take this one or doesn't begin.
    pub fn join(port: &str, within: Duration) -> Result<Self, Error> {
        let failed = |reason: String| Error::Shared { port: port.to_owned(), reason };
        let until = Instant::now() + within;
        let stream = loop {
            match knock(port) {
                Some(stream) => break stream,
                None if octant_base::interrupt::seen() => return Err(Error::Interrupted),
                None if Instant::now() > until => {
                    return Err(failed(format!("no run on this host drives it within {within:?}")));
                }
                None => std::thread::sleep(PAUSE),
            }
        };
        let gone =
            |error: std::io::Error| failed(format!("the run that drives it is gone: {error}"));
        stream.set_read_timeout(Some(PAUSE)).map_err(gone)?;
        let mut lines = Lines::new(stream.try_clone().map_err(gone)?);
        let until = Instant::now() + within;
        let mut units = None;
        loop {
            match lines.next().map_err(&failed)? {
                Some(HostWord::Table { version: VERSION, units: count }) => units = Some(count),
                Some(HostWord::Table { version, .. }) => {
                    return Err(failed(format!(
                        "the run that drives it speaks version {version}, expected {VERSION}"
                    )));
                }
                Some(HostWord::Refused(why)) => return Err(failed(why)),
                Some(HostWord::Go) => break,
                Some(HostWord::Look(_)) if octant_base::interrupt::seen() => {
                    return Err(Error::Interrupted);
                }
                Some(HostWord::Look(_)) => {}
                Some(HostWord::Stopped(why)) => {
                    return Err(failed(format!("the run that drives it stopped it: {why}")));
                }
                Some(HostWord::End) => {
                    return Err(failed("the run that drives it ended".to_owned()));
                }
                None if octant_base::interrupt::seen() => return Err(Error::Interrupted),
                None if Instant::now() > until => {
                    return Err(failed(format!(
                        "the run that drives it doesn't begin within {within:?}"
                    )));
                }
                None => {}
            }
        }
        let Some(units) = units else {
            return Err(failed("the run that drives it didn't introduce itself".to_owned()));
        };
        let shared = Arc::new(Shared::default());
        let (producer, looks) = rtrb::RingBuffer::new(LOOKS);
        let of_thread = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("table of another run".into())
            .spawn(move || listen(lines, &of_thread, producer))
            .map_err(|error| failed(error.to_string()))?;
        let (track, apart_since) = (Track::new(), None);
        Ok(Self { units, stream, shared, looks, track, apart_since, thread: Some(thread) })
    }

    /// Number of runs at the table.
    #[must_use]
    pub fn units(&self) -> usize {
        self.units
    }

    /// Compares the set point of the own core with that of the table; if they stay apart, the run is over.
    pub fn command(&mut self, command: &GimbalCommand) {
        if !self.shared.has_target.load(Ordering::Acquire) {
            return;
        }
        let target = unpacked(self.shared.target.load(Ordering::Acquire));
        if target == command.target {
            self.apart_since = None;
            return;
        }
        let since = *self.apart_since.get_or_insert_with(Instant::now);
        if since.elapsed() > APART && !self.is_stopped() {
            let degrees = |angle_rad: f64| angle_rad.to_degrees();
            self.shared.end(format!(
                "for {APART:?} this run's set point is azimuth {:.4}°, roll {:.4}°, and that of the run that \
                 drives the table azimuth {:.4}°, roll {:.4}°",
                degrees(command.target.azimuth_rad()),
                degrees(command.target.roll_rad()),
                degrees(target.azimuth_rad()),
                degrees(target.roll_rad()),
            ));
        }
    }

    /// Takes the looks since the last call.
    pub fn take_looks(&mut self) {
        while let Ok(status) = self.looks.pop() {
            self.track.add(&status);
        }
    }

    /// Angle of an axis at a time, as far as the looks were taken.
    #[must_use]
    pub fn at(&self, axis: TableAxis, when: Instant) -> Option<TrackPoint> {
        self.track.at(axis, when)
    }

    /// True if the table is of no more use to this run. Takes no lock.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.shared.over.load(Ordering::Acquire)
    }

    /// Reason for that.
    #[must_use]
    pub fn stopped(&self) -> Option<String> {
        self.shared.why.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Counts of the looks so far; a guest commands nothing.
    #[must_use]
    pub fn traffic(&self) -> TableTraffic {
        TableTraffic { looks: self.shared.looks.load(Ordering::Relaxed), commands: 0 }
    }

    /// Tells the driving run that this one has ended: in order, or for a reason.
    pub fn leave(mut self, broken: Option<&str>) {
        self.part(&match broken {
            None => GuestWord::Done,
            Some(why) => GuestWord::Left(why.to_owned()),
        });
    }

    fn part(&mut self, word: &GuestWord) {
        self.shared.leaves.store(true, Ordering::Release);
        let Some(thread) = self.thread.take() else { return };
        // The driving run may be gone: then nobody has to be told.
        let _ = self.stream.write_all(&line(word));
        let _ = self.stream.shutdown(std::net::Shutdown::Write);
        let _ = thread.join();
    }
}

impl Drop for TableGuest {
    fn drop(&mut self) {
        self.part(&GuestWord::Left("its run ended early".to_owned()));
    }
}

/// Listens to the driving run until nothing more comes.
fn listen(mut lines: Lines, shared: &Shared, mut looks: rtrb::Producer<TableStatus>) {
    let monotonic = Monotonic::now();
    let mut heard = Instant::now();
    while !shared.leaves.load(Ordering::Acquire) && !shared.over.load(Ordering::Acquire) {
        match lines.next() {
            Ok(Some(word)) => {
                heard = Instant::now();
                match word {
                    HostWord::Look(look) => {
                        shared.looks.fetch_add(1, Ordering::Relaxed);
                        if let Some([azimuth, roll]) = look.target {
                            let target = octant_sample::GimbalAngles { azimuth, roll };
                            shared.target.store(packed(target), Ordering::Release);
                            shared.has_target.store(true, Ordering::Release);
                        }
                        // In a full queue the angles become too old, which is noticed.
                        let _ = looks.push(status(&look, &monotonic));
                    }
                    HostWord::Stopped(why) => {
                        shared.end(format!("the run that drives it stopped it: {why}"));
                    }
                    HostWord::End => {
                        shared.end("the run that drives it ended before this one".to_owned());
                    }
                    HostWord::Table { .. } | HostWord::Refused(_) | HostWord::Go => {}
                }
            }
            Ok(None) if heard.elapsed() > SILENCE => {
                shared.end(format!("the run that drives it said nothing for {SILENCE:?}"));
            }
            Ok(None) => {}
            Err(why) => shared.end(why),
        }
    }
}

/// Status of the table from a look that was told. Times that aren't told are none.
fn status(look: &SharedLook, monotonic: &Monotonic) -> TableStatus {
    let axis = |axis: TableAxis| {
        let told = &look.axes[axis as usize];
        AxisStatus {
            angle_rad: told.angle_rad,
            at: told.at_ns.and_then(|ns| monotonic.at(ns)),
            at_within: Duration::from_nanos(told.within_ns),
            rate_radps: told.rate_radps,
            ..AxisStatus::default()
        }
    };
    TableStatus { axes: TableAxis::ALL.map(axis) }
}

/// Lines of the driving run.
struct Lines {
    stream: BufReader<UnixStream>,
    begun: Vec<u8>,
}

impl Lines {
    fn new(stream: UnixStream) -> Self {
        Self { stream: BufReader::new(stream), begun: Vec::new() }
    }

    /// Next line; `None` if none came within the stream's time limit.
    fn next(&mut self) -> Result<Option<HostWord>, String> {
        let left = LONGEST.saturating_sub(self.begun.len() as u64);
        let read = (&mut self.stream).take(left).read_until(b'\n', &mut self.begun);
        match read {
            Err(error)
                if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::Interrupted) =>
            {
                Ok(None)
            }
            Err(error) => Err(format!("the run that drives it is gone: {error}")),
            Ok(_) if self.begun.last() == Some(&b'\n') => {
                let word = serde_json::from_slice(&self.begun);
                self.begun.clear();
                word.map(Some).map_err(|error| {
                    format!("the run that drives it said what can't be read: {error}")
                })
            }
            Ok(0) if left > 0 => Err("the run that drives it is gone".to_owned()),
            Ok(_) if self.begun.len() as u64 >= LONGEST => {
                Err("the run that drives it said a line without an end".to_owned())
            }
            Ok(_) => Ok(None),
        }
    }
}
