//! Readings from a port, with their times of arrival.

use crate::SourceError;
use octant_base::number::counted;
use octant_instruments::dbc::{CanFrame, Gatherer};
use octant_instruments::dbc::{Database, Mapping};
use octant_instruments::{AnyDecoder, Event, Reading};
use octant_link::port::{self, Bytes, Heard, Listener, Port};
use octant_scenario::FileName;
use octant_scenario::Messages;
use octant_scenario::{Instrument, Speaks};
use octant_wire::Role;
use std::path::Path;
use std::time::{Duration, Instant};

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
    buffer: [u8; 4096],
    /// Range of the buffer that is not decoded yet.
    rest: std::ops::Range<usize>,
    /// Time at which the buffer was received.
    came: Instant,
}

#[derive(Debug)]
pub(super) struct Bus {
    listener: Listener,
    gatherer: Gatherer,
    /// Frame that was not taken yet, with its time of arrival.
    frame: Option<(Heard, Instant)>,
}

impl Feed {
    /// Opens the port of an instrument. File names are relative to `folder`.
    pub(super) fn open(instrument: &Instrument, folder: &Path) -> Result<Self, SourceError> {
        let uri = &instrument.uri;
        let gone = |reason: String| SourceError::Gone { uri: uri.to_string(), reason };
        let protocol = match &instrument.speaks {
            Speaks::Bytes(protocol) => *protocol,
            Speaks::Can(messages) => {
                let gatherer = gatherer(messages, folder)?;
                let identifiers: Vec<(u32, bool)> = gatherer.identifiers().collect();
                let listener = Listener::open(uri, &identifiers);
                let listener = listener.map_err(|error| gone(error.to_string()))?;
                return Ok(Self::Bus(Box::new(Bus { listener, gatherer, frame: None })));
            }
        };
        // The port waits for a sender, as a device does.
        let port = match port::open(uri, Role::Device) {
            Ok(Port::Bytes(port)) => port,
            Ok(Port::Frames(_)) => {
                return Err(gone(
                    "the port carries no bytes, expected a serial line or UDP".to_owned(),
                ));
            }
            Err(error) => return Err(gone(error.to_string())),
        };
        Ok(Self::Line(Box::new(Line {
            port,
            decoder: AnyDecoder::new(protocol),
            buffer: [0; 4096],
            rest: 0..0,
            came: Instant::now(),
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
    pub(super) fn reading(&mut self) -> Option<(Reading, Instant)> {
        match self {
            Self::Line(line) => line.reading(),
            Self::Bus(bus) => {
                let (heard, came) = bus.frame.take()?;
                let (id, extended) = (heard.id, heard.extended);
                let frame = CanFrame { id, extended, data: heard.data() };
                bus.gatherer.receive(&frame).map(|reading| (reading, came))
            }
        }
    }

    /// Waits for more data; returns whether any came.
    pub(super) fn receive(&mut self, wait: Duration) -> Result<bool, String> {
        match self {
            Self::Line(line) => {
                let came = line.port.receive(&mut line.buffer, wait);
                line.came = Instant::now();
                line.rest = 0..came.map_err(|error| error.to_string())?;
                Ok(!line.rest.is_empty())
            }
            Self::Bus(bus) => {
                let heard = bus.listener.hear(wait).map_err(|error| error.to_string())?;
                bus.frame = heard.map(|heard| (heard, Instant::now()));
                Ok(bus.frame.is_some())
            }
        }
    }

    /// Locks the port to the present sender: no other sender is heard from now on.
    pub(super) fn hold_peer(&mut self) {
        if let Self::Line(line) = self {
            line.port.hold_peer(true);
        }
    }

    /// Summarises the data received so far, for the error about missing readings.
    pub(super) fn said(&self, protocol: &str) -> String {
        match self {
            Self::Line(line) => {
                let counters = line.decoder.counters();
                format!(
                    "received so far: {}, {}, {} of protocol {protocol}, {} with a wrong checksum",
                    counted(counters.bytes, "byte", "bytes"),
                    counted(counters.readings, "reading", "readings"),
                    counted(counters.other, "other frame", "other frames"),
                    counted(counters.checksum, "frame", "frames"),
                )
            }
            Self::Bus(bus) => {
                let counters = bus.gatherer.counters();
                format!(
                    "received so far: {}, {}, {} of other messages, {} with a missing message, {} with \
                     messages of another sample",
                    counted(counters.frames, "frame", "frames"),
                    counted(counters.readings, "reading", "readings"),
                    counted(counters.other, "frame", "frames"),
                    counted(counters.incomplete, "reading", "readings"),
                    counted(counters.mixed, "reading", "readings"),
                )
            }
        }
    }
}

impl Line {
    fn reading(&mut self) -> Option<(Reading, Instant)> {
        loop {
            let mut bytes = &self.buffer[self.rest.clone()];
            let event = self.decoder.next(&mut bytes);
            self.rest.start = self.rest.end - bytes.len();
            // A frame doesn't continue in the next datagram.
            let event =
                if event.is_none() && self.port.datagrams() { self.decoder.end() } else { event };
            match event {
                Some(Event::Reading(reading)) => return Some((reading, self.came)),
                Some(_) => {}
                None => return None,
            }
        }
    }
}

/// Builds the gatherer that assembles readings from CAN messages. File names are relative to
/// `folder`.
///
/// # Errors
/// If a file can't be read, or the files don't fit each other.
pub(super) fn gatherer(messages: &Messages, folder: &Path) -> Result<Gatherer, SourceError> {
    let read = |name: &FileName| {
        let path = name.path(folder).map_err(SourceError::FileName)?;
        let file = path.display().to_string();
        match std::fs::read_to_string(&path) {
            Ok(text) => Ok((file, text)),
            Err(error) => Err(SourceError::Read { path: file, reason: error.to_string() }),
        }
    };
    let wrong = |problem: octant_instruments::dbc::Problem| SourceError::Read {
        path: problem.place,
        reason: problem.what,
    };
    let (file, text) = read(&messages.database)?;
    let database = Database::parse(&file, &text).map_err(wrong)?;
    let (file, text) = read(&messages.mapping)?;
    let mapping = Mapping::parse(&file, &text).map_err(wrong)?;
    Gatherer::new(&database, &mapping).map_err(wrong)
}
