//! Readings from a port, with their times of arrival.

use super::arrival::{Arrival, ArrivalClock};
use super::bus::Bus;
use crate::SourceError;
use crate::described::decoder;
use crate::traffic::traffic;
use octant_account::Account;
use octant_instruments::{AnyDecoder, FramingEvent, Reading, ReadingCounters, ReadingDefect};
use octant_link::port::{self, Bytes, Port};
use octant_scenario::{Instrument, Speaks};
use octant_wire::EndRole;
use std::path::Path;
use std::time::Duration;
use std::time::Instant;

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
    buffer: [u8; 4096],
    /// Range of the buffer that is not decoded yet.
    rest: std::ops::Range<usize>,
    /// Time at which the buffer was received.
    came: Arrival,
    clock: ArrivalClock,
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
            line => decoder(line, instrument.count, folder)?,
        };
        let decoder = decoder.ok_or_else(|| gone("it speaks no protocol of a line".to_owned()))?;
        // The port waits for a sender, as a device does.
        let port = match port::open(uri, EndRole::Device) {
            Ok(Port::Bytes(mut port)) => {
                // Without stamps of the kernel an arrival is the return of the read, which is told.
                port.stamp_arrivals();
                port
            }
            Ok(Port::Frames(_)) => {
                return Err(gone(
                    "the port carries no bytes, expected a serial line or UDP".to_owned(),
                ));
            }
            Err(error) => return Err(gone(error.to_string())),
        };
        Ok(Self::Line(Box::new(Line {
            port,
            decoder,
            unread: None,
            buffer: [0; 4096],
            rest: 0..0,
            came: Arrival::read(Instant::now()),
            clock: ArrivalClock::default(),
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
            Self::Line(line) => {
                let came = line.port.receive(&mut line.buffer, wait);
                line.rest = 0..came.map_err(|error| error.to_string())?;
                line.came = line.clock.arrival(line.port.arrived());
                Ok(!line.rest.is_empty())
            }
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
            Self::Line(_) => account,
            Self::Bus(bus) => bus.losses(account),
        }
    }

    /// Summarises the data received so far, for the error about missing readings.
    pub(super) fn said(&self, protocol: &str) -> String {
        match self {
            Self::Line(line) => {
                let said = traffic(line.decoder.counters(), line.unread, protocol, "live");
                format!("received so far: {said}")
            }
            Self::Bus(bus) => bus.said(),
        }
    }
}

impl Line {
    fn reading(&mut self) -> Option<(Reading, Arrival)> {
        loop {
            let mut bytes = &self.buffer[self.rest.clone()];
            let event = self.decoder.next(&mut bytes);
            self.rest.start = self.rest.end - bytes.len();
            // A frame doesn't continue in the next datagram.
            let event =
                if event.is_none() && self.port.datagrams() { self.decoder.end() } else { event };
            match event {
                Some(FramingEvent::Reading(reading)) => return Some((reading, self.came)),
                Some(FramingEvent::Lost(lost)) if lost.cause.is_intact() => {
                    self.unread.get_or_insert(lost.cause);
                }
                Some(FramingEvent::Lost(_)) => {}
                None => return None,
            }
        }
    }
}
