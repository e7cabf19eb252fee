//! The end of the run that drives the table.

use super::ends::GuestEnd;
use super::monotonic::Monotonic;
use super::words::{GuestWord, HostWord, SharedAxis, SharedLook, VERSION, line};
use crate::{TableAxis, TableStatus};
use octant_sample::GimbalAngles;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Longest line of a guest, bytes.
const LONGEST: usize = 4096;

#[derive(Debug)]
struct Guest {
    /// `None` once it has ended.
    stream: Option<UnixStream>,
    heard: Vec<u8>,
    end: GuestEnd,
}

/// Takes guests at a table. Clones take the same ones.
#[derive(Clone, Debug)]
pub struct TableHost {
    units: usize,
    monotonic: Monotonic,
    guests: Arc<Mutex<Guests>>,
}

#[derive(Debug, Default)]
struct Guests {
    begun: bool,
    all: Vec<Guest>,
}

impl TableHost {
    /// Makes a host for so many runs, its own among them.
    #[must_use]
    pub fn new(units: usize) -> Self {
        Self { units, monotonic: Monotonic::now(), guests: Arc::default() }
    }

    /// Takes a guest, or tells it why not. Waits for nothing.
    pub(crate) fn join(&self, mut stream: UnixStream) {
        let mut guests = self.guests();
        let refused = |why: &str| HostWord::Refused(why.to_owned());
        let word = if self.units < 2 {
            refused("it is for its run alone, expected turntable.drive.units = 2 or more there")
        } else if guests.begun {
            refused("its run has begun already")
        } else if guests.present() + 1 >= self.units {
            refused(&format!("the {} runs of turntable.drive.units are there already", self.units))
        } else {
            HostWord::Table { version: VERSION, units: self.units }
        };
        let taken = matches!(word, HostWord::Table { .. });
        // A line fits into an empty socket, and a guest never holds up the stop button.
        let told = stream.set_nonblocking(true).and_then(|()| stream.write_all(&line(&word)));
        if taken && told.is_ok() {
            guests.all.push(Guest { stream: Some(stream), heard: Vec::new(), end: GuestEnd::Open });
        }
    }

    /// True if everybody is there.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.guests().present() + 1 >= self.units
    }

    /// Number of the runs that are there, its own among them.
    #[must_use]
    pub fn present(&self) -> usize {
        self.guests().present() + 1
    }

    /// Number of all runs, its own among them.
    #[must_use]
    pub const fn units(&self) -> usize {
        self.units
    }

    /// Lets the runs begin, with those guests that are there.
    pub(crate) fn begin(&self) {
        let mut guests = self.guests();
        guests.begun = true;
        guests.all.retain(|guest| guest.stream.is_some());
        guests.tell(&HostWord::Go);
    }

    /// Tells a look, and hears the guests.
    pub(crate) fn look(&self, status: &TableStatus, target: Option<GimbalAngles>) {
        let mut guests = self.guests();
        if guests.all.is_empty() {
            return;
        }
        let axis = |axis: TableAxis| {
            let found = status.of(axis);
            SharedAxis {
                at_ns: found.at.and_then(|at| self.monotonic.of(at)),
                within_ns: found.at_within.as_nanos() as u64,
                angle_rad: found.angle_rad,
                rate_radps: found.rate_radps,
            }
        };
        guests.tell(&HostWord::Look(SharedLook {
            axes: TableAxis::ALL.map(axis),
            target: target.map(|target| [target.azimuth, target.roll]),
        }));
        guests.hear();
    }

    /// Tells the guests that the table was stopped.
    pub(crate) fn stopped(&self, why: &str) {
        self.guests().tell(&HostWord::Stopped(why.to_owned()));
    }

    /// Tells the guests that the driving run has ended.
    pub(crate) fn end(&self) {
        let mut guests = self.guests();
        guests.hear();
        guests.tell(&HostWord::End);
    }

    /// True if a guest's run still goes on.
    #[must_use]
    pub fn has_open(&self) -> bool {
        let mut guests = self.guests();
        guests.hear();
        guests.present() > 0
    }

    /// How the guests' runs ended, in the order in which they came.
    #[must_use]
    pub fn ends(&self) -> Vec<GuestEnd> {
        self.guests().all.iter().map(|guest| guest.end.clone()).collect()
    }

    fn guests(&self) -> MutexGuard<'_, Guests> {
        self.guests.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Guests {
    fn present(&self) -> usize {
        self.all.iter().filter(|guest| guest.stream.is_some()).count()
    }

    /// Tells all guests. One that doesn't take what it is told has left.
    fn tell(&mut self, word: &HostWord) {
        let line = line(word);
        for guest in &mut self.all {
            let Some(stream) = &mut guest.stream else { continue };
            if let Err(error) = stream.write_all(&line) {
                guest.left(match error.kind() {
                    ErrorKind::WouldBlock => "it didn't take what it was told".to_owned(),
                    _ => format!("it is gone: {error}"),
                });
            }
        }
    }

    /// Hears what the guests have said.
    fn hear(&mut self) {
        for guest in &mut self.all {
            guest.hear();
        }
    }
}

impl Guest {
    fn left(&mut self, why: String) {
        self.stream = None;
        self.end = GuestEnd::Left(why);
    }

    fn hear(&mut self) {
        let mut bytes = [0; 256];
        while let Some(stream) = &mut self.stream {
            match stream.read(&mut bytes) {
                Ok(0) => self.left("it is gone".to_owned()),
                Ok(count) => {
                    self.heard.extend_from_slice(&bytes[..count]);
                    self.take_lines();
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => return,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => self.left(format!("it is gone: {error}")),
            }
        }
    }

    fn take_lines(&mut self) {
        while let Some(end) = self.heard.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.heard.drain(..=end).collect();
            match serde_json::from_slice(&line) {
                Ok(GuestWord::Done) => {
                    self.stream = None;
                    self.end = GuestEnd::Done;
                }
                Ok(GuestWord::Left(why)) => self.left(why),
                Err(_) => self.left("what it said can't be read".to_owned()),
            }
        }
        if self.heard.len() > LONGEST {
            self.left("what it said has no end".to_owned());
        }
    }
}
