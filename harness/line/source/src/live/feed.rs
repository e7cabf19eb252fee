//! Readings from a port, with their times of arrival.

use super::arrival::{Arrival, ArrivalClock};
use super::bus::Bus;
use crate::SourceError;
use crate::described::port_decoder;
use crate::traffic::traffic;
use octant_account::{Account, AccountEntry};
use octant_instruments::{AnyDecoder, FramingEvent, Reading, ReadingCounters, ReadingDefect};
use octant_link::port::{self, Bytes, Port};
use octant_scenario::{Instrument, Speaks};
use std::path::Path;
use std::time::Duration;
use std::time::Instant;

/// Number of bytes that are received at a time: the longest datagram, of which a shorter room would lose the rest.
const RECEIVED_BYTES: usize = 1 << 16;

/// Decoder of an instrument's port.
#[derive(Debug)]
pub(super) enum Feed {
    /// Frames of a protocol in a byte stream.
    Line(Box<Line>),
    /// Messages on a CAN bus.
    Bus(Box<Bus>),
}

#[derive(Debug)]
pub(super) struct Line {
    port: Box<dyn Bytes>,
    decoder: AnyDecoder,
    /// Why the first intact frame that can't be read can't.
    unread: Option<ReadingDefect>,
    buffer: Box<[u8]>,
    /// Range of the buffer that is not decoded yet.
    rest: std::ops::Range<usize>,
    /// Time at which the buffer was received.
    came: Arrival,
    clock: ArrivalClock,
    connection: Connection,
}

/// The connection of a port that makes one.
#[derive(Debug, Default)]
struct Connection {
    /// Why it is closed; `None` while it is open, or where this host listens.
    closed: Option<String>,
    /// Number of connections that were made, as they were counted last.
    made: u64,
    /// True until the decoder has ended what the one before left incomplete.
    is_new: bool,
    /// Whether the last reading has a number or a stamp, which shows what was lost between two connections.
    numbered: Option<bool>,
}

impl Feed {
    /// Opens the port of an instrument. File names are relative to `folder`.
    pub(super) fn open(instrument: &Instrument, folder: &Path) -> Result<Self, SourceError> {
        let uri = &instrument.uri;
        let gone = |reason: String| SourceError::Gone { uri: uri.to_string(), reason };
        let decoder = match &instrument.speaks {
            Speaks::Can(messages) => {
                return Ok(Self::Bus(Box::new(Bus::open(uri, messages, folder)?)));
            }
            line => port_decoder(line, instrument.count, folder)?,
        };
        let decoder = decoder.ok_or_else(|| gone("it speaks no protocol of a line".to_owned()))?;
        let port = match port::open_instrument(uri) {
            Ok(Port::Bytes(mut port)) => {
                // Without stamps of the kernel an arrival is the return of the read, which is told.
                port.stamp_arrivals();
                port
            }
            Ok(Port::Frames(_)) => {
                return Err(gone(
                    "the port carries no bytes, expected a serial line, UDP or TCP".to_owned(),
                ));
            }
            Err(error) => return Err(gone(error.to_string())),
        };
        let connection = Connection { made: port.connections(), ..Connection::default() };
        Ok(Self::Line(Box::new(Line {
            port,
            decoder,
            unread: None,
            buffer: vec![0; RECEIVED_BYTES].into_boxed_slice(),
            rest: 0..0,
            came: Arrival::read(Instant::now()),
            clock: ArrivalClock::default(),
            connection,
        })))
    }

    /// Returns the address at which the instrument reaches the port; `None` for a CAN bus.
    pub(super) fn reached_at(&self) -> Option<String> {
        match self {
            Self::Line(line) => Some(line.port.reached_at()),
            Self::Bus(_) => None,
        }
    }

    /// Returns the next reading in the received data, with its time of arrival.
    pub(super) fn reading(&mut self) -> Option<(Reading, Arrival)> {
        match self {
            Self::Line(line) => line.reading(),
            Self::Bus(bus) => bus.reading(),
        }
    }

    /// Waits for more data; returns whether any came.
    pub(super) fn receive(&mut self, wait: Duration) -> Result<bool, String> {
        match self {
            Self::Line(line) => line.receive(wait),
            Self::Bus(bus) => bus.receive(wait),
        }
    }

    /// Locks the port to the present sender: no other sender is heard from now on.
    pub(super) fn hold_peer(&mut self) {
        if let Self::Line(line) = self {
            line.port.hold_peer(true);
        }
    }

    /// Counts of the frames of a line; `None` of a bus.
    pub(super) fn counters(&self) -> Option<&ReadingCounters> {
        match self {
            Self::Line(line) => Some(line.decoder.counters()),
            Self::Bus(_) => None,
        }
    }

    /// Adds the losses on a bus to an account.
    pub(super) fn losses(&self, account: Account) -> Account {
        match self {
            Self::Line(line) => {
                let again = line.connection.made.saturating_sub(1);
                let kind =
                    "connections that were closed and made again: what came meanwhile is lost";
                account.note(AccountEntry::new(again, kind))
            }
            Self::Bus(bus) => bus.losses(account),
        }
    }

    /// Describes the data received so far.
    pub(super) fn said(&mut self, protocol: &str) -> String {
        match self {
            Self::Line(line) => {
                // Bytes of a frame whose rest didn't come are lost; a whole frame behind a sync by chance is one.
                while line.decoder.end().is_some() {}
                let said = traffic(line.decoder.counters(), line.unread, protocol, "live");
                format!("{said}{}", line.connection.said())
            }
            Self::Bus(bus) => bus.said(),
        }
    }
}

impl Connection {
    /// Describes the connections, where there was more than one, or none is left.
    fn said(&self) -> String {
        let made = match self.made {
            0 | 1 => String::new(),
            made => format!("; {made} connections"),
        };
        match &self.closed {
            None => made,
            Some(reason) => format!("{made}; no connection: {reason}"),
        }
    }

    /// Notes that a connection ended.
    ///
    /// # Errors
    /// If the readings don't show what is lost until the next one.
    fn ended(&mut self) -> Result<(), String> {
        self.is_new = true;
        if self.numbered == Some(false) {
            return Err("the connection was closed, and the readings have neither number nor stamp: what is lost \
                        until the next connection couldn't be noticed"
                .to_owned());
        }
        Ok(())
    }
}

impl Line {
    /// Waits for more data; returns whether any came. A closed connection is made again.
    fn receive(&mut self, wait: Duration) -> Result<bool, String> {
        self.rest = 0..0;
        if self.connection.closed.is_some() {
            if let Err(error) = self.port.reopen() {
                self.connection.closed = Some(error.to_string());
                std::thread::sleep(wait);
                return Ok(false);
            }
            (self.connection.closed, self.connection.made) = (None, self.port.connections());
        }
        let came = self.port.receive(&mut self.buffer, wait);
        let made = self.port.connections();
        let count = match came {
            Ok(count) => count,
            Err(error) if made > 0 => {
                self.connection.closed = Some(error.to_string());
                self.connection.ended()?;
                // One that accepts and closes again and again isn't asked without a pause.
                std::thread::sleep(wait);
                return Ok(false);
            }
            Err(error) => return Err(error.to_string()),
        };
        if made != self.connection.made {
            // The instrument connected again.
            if std::mem::replace(&mut self.connection.made, made) > 0 {
                self.connection.ended()?;
            }
        }
        self.rest = 0..count;
        self.came = self.clock.arrival(self.port.arrived());
        Ok(count > 0)
    }

    fn reading(&mut self) -> Option<(Reading, Arrival)> {
        loop {
            if self.connection.is_new {
                // A frame doesn't continue in the next connection.
                match self.decoder.end() {
                    Some(event) => match self.taken(event) {
                        Some(reading) => return Some(reading),
                        None => continue,
                    },
                    None => {
                        self.connection.is_new = false;
                        self.decoder.begin_anywhere();
                    }
                }
            }
            let mut bytes = &self.buffer[self.rest.clone()];
            let event = self.decoder.next(&mut bytes);
            self.rest.start = self.rest.end - bytes.len();
            let event = match event {
                None if self.port.datagrams() => self.decoder.end_of_datagram(),
                event => event,
            };
            if let Some(reading) = self.taken(event?) {
                return Some(reading);
            }
        }
    }

    /// Notes an event; returns its reading.
    fn taken(&mut self, event: FramingEvent) -> Option<(Reading, Arrival)> {
        match event {
            FramingEvent::Reading(reading) => {
                self.connection.numbered =
                    Some(reading.sequence.is_some() || reading.stamp.is_some());
                Some((reading, self.came))
            }
            FramingEvent::Lost(lost) => {
                if lost.cause.is_intact() {
                    self.unread.get_or_insert(lost.cause);
                }
                None
            }
        }
    }
}
