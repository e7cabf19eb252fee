//! Messages across a port, and counts of losses.

use crate::port::{BusEvent, BusTrouble, Bytes, Frames, Port, PortError};
use crate::waited::Waited;
use octant_faults::wire::Wired;
use octant_wire::can::{self, Bits, Bus, CanVersion, Reassembler};
use octant_wire::message::{ClockTime, EndRole, Message};
use octant_wire::serial::{self, SerialDecoder, SerialEncoder};
use octant_wire::{Unreadable, message::DeviceStatus};
use std::time::{Duration, Instant};

/// A unit received.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "the large variant is the one that comes")]
pub enum Incoming {
    /// A message.
    Message(Message),
    /// A hello of a protocol version unknown to this end.
    Newer(u16),
}

/// Counts of the traffic on a wire, seen from one end.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TrafficCounts {
    /// Messages sent.
    pub sent: u64,
    /// Messages that the port did not accept in full.
    pub not_sent: u64,
    /// Messages received.
    pub received: u64,
    /// Bytes (CAN: frames) received that belong to no message.
    pub lost: u64,
    /// Frames (CAN: messages) that arrived damaged.
    pub damaged: u64,
    /// Frames (CAN: segments) that never arrived.
    pub missing: u64,
    /// Frames (CAN: segments) that arrived again, or after later ones.
    pub out_of_order: u64,
    /// Undamaged frames (CAN: messages) that could not be decoded.
    pub unreadable: u64,
    /// Time on the bus of all CAN frames, sent and received, in the worst case, s.
    pub bus_s: f64,
    /// CAN: error frames of any kind.
    pub error_frames: u64,
    /// CAN: number of times that the controller became error-passive.
    pub error_passive: u64,
    /// CAN: number of times that the controller went bus-off.
    pub bus_off: u64,
    /// CAN: number of times that the controller came back.
    pub restarted: u64,
    /// CAN: arbitrations lost, as far as the controller reports them.
    pub arbitration_lost: u64,
}

/// Messages over a port, with counts of losses.
#[derive(Debug)]
pub struct Wire {
    name: String,
    medium: Medium,
    begun: Instant,
    last_sent: Option<Instant>,
    pub(crate) waited: Waited,
    counts: TrafficCounts,
    /// Bit rates of the bus, for its load.
    bus: Option<Bus>,
    /// Time since which the controller is off the bus, or of the last attempt to restart it.
    off: Option<Instant>,
    /// Reason why the last intact message could not be read.
    unreadable: Option<Unreadable>,
}

#[derive(Debug)]
enum Medium {
    Bytes(Box<ByteMedium>),
    Frames(Box<FrameMedium>),
}

#[derive(Debug)]
struct ByteMedium {
    port: Box<dyn Bytes>,
    encoder: SerialEncoder,
    decoder: SerialDecoder,
    buffer: [u8; 4096],
    /// Range of the buffer that isn't decoded yet.
    from: usize,
    to: usize,
    /// True if a datagram is decoded to its last byte and must be concluded.
    concludes: bool,
}

#[derive(Debug)]
struct FrameMedium {
    port: Box<dyn Frames>,
    reassembler: Reassembler,
    role: EndRole,
    format: CanVersion,
}

/// Shortest interval between two attempts to restart a controller.
const RESTART_EVERY: Duration = Duration::from_millis(100);

impl Wire {
    /// Makes a wire for the end of a role. `name` is the port's name in errors.
    #[must_use]
    pub fn new(name: impl Into<String>, port: Port, role: EndRole) -> Self {
        let medium = match port {
            Port::Bytes(port) => Medium::Bytes(Box::new(ByteMedium {
                port,
                encoder: SerialEncoder::new(),
                decoder: SerialDecoder::new(),
                buffer: [0; 4096],
                from: 0,
                to: 0,
                concludes: false,
            })),
            Port::Frames(port) => {
                let others: &[EndRole] = match role {
                    EndRole::Harness => &[EndRole::Device, EndRole::Instrument],
                    EndRole::Device | EndRole::Instrument => &[EndRole::Harness],
                };
                let format = port.format();
                let reassembler = Reassembler::new(others, format);
                Medium::Frames(Box::new(FrameMedium { port, reassembler, role, format }))
            }
        };
        Self {
            name: name.into(),
            medium,
            begun: Instant::now(),
            last_sent: None,
            waited: Waited::default(),
            counts: TrafficCounts::default(),
            bus: None,
            off: None,
            unreadable: None,
        }
    }

    /// Opens the port named by a URI.
    ///
    /// # Errors
    /// If the port can't be opened.
    pub fn open(uri: &crate::Uri, role: EndRole) -> Result<Self, PortError> {
        Ok(Self::new(uri.to_string(), crate::port::open(uri, role)?, role))
    }

    /// Sets the bit rates of the bus, from which [`TrafficCounts::bus_s`] is computed.
    pub fn set_bus(&mut self, bus: Bus) {
        self.bus = Some(bus);
    }

    /// Name of the port.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Time of this end's clock.
    #[must_use]
    pub fn now(&self) -> ClockTime {
        self.at(Instant::now())
    }

    /// Time of this end's clock at an instant; 0 before the wire was made.
    #[must_use]
    pub fn at(&self, instant: Instant) -> ClockTime {
        let since = instant.saturating_duration_since(self.begun).as_nanos();
        ClockTime::from_ns(u64::try_from(since).unwrap_or(u64::MAX))
    }

    /// Time since the last message was sent.
    #[must_use]
    pub fn quiet(&self) -> Duration {
        self.last_sent.unwrap_or(self.begun).elapsed()
    }

    /// Sends a message. False: the port did not accept the whole message within the time.
    ///
    /// # Errors
    /// If the port is gone.
    pub fn send(&mut self, message: &Message, wait: Duration) -> Result<bool, PortError> {
        let now = Instant::now();
        let clock = self.at(now);
        self.last_sent = Some(now);
        let taken = match &mut self.medium {
            Medium::Bytes(medium) => {
                let ByteMedium { port, encoder, .. } = &mut **medium;
                port.send(encoder.encode(message, clock), wait)?
            }
            Medium::Frames(medium) => medium.send(message, wait, self.bus, &mut self.counts)?,
        };
        self.waited.add(now, wait);
        *(if taken { &mut self.counts.sent } else { &mut self.counts.not_sent }) += 1;
        Ok(taken)
    }

    /// Receives the next message within a time; with a zero wait, only what is already there.
    ///
    /// # Errors
    /// If the port is gone.
    pub fn receive(&mut self, wait: Duration) -> Result<Option<Incoming>, PortError> {
        let begun = Instant::now();
        let incoming = self.next(begun, wait);
        self.waited.add(begun, wait);
        if let Ok(Some(_)) = &incoming {
            self.waited.heard();
        }
        incoming
    }

    fn next(&mut self, begun: Instant, wait: Duration) -> Result<Option<Incoming>, PortError> {
        let until = begun.checked_add(wait);
        let mut left = wait;
        let mut lost = 0;
        loop {
            if let Some(since) = self.off {
                self.back_on_bus(since)?;
                left = left.min(RESTART_EVERY);
            }
            let incoming = match &mut self.medium {
                Medium::Bytes(medium) => medium.next(left)?,
                Medium::Frames(medium) => {
                    let next = medium.next(left, self.bus, &mut self.counts)?;
                    match next {
                        Next::Trouble(trouble) => {
                            self.trouble(trouble);
                            Next::Nothing
                        }
                        next => next,
                    }
                }
            };
            match incoming {
                Next::Incoming(incoming) => {
                    self.counts.received += 1;
                    return Ok(Some(incoming));
                }
                // A babbling line must not keep the caller beyond its time.
                Next::Lost(unreadable) => {
                    self.unreadable = unreadable.or(self.unreadable);
                    lost += 1;
                    if lost % 64 == 0 && until.is_some_and(|until| Instant::now() >= until) {
                        return Ok(None);
                    }
                }
                Next::Nothing | Next::Trouble(_) => {
                    left = match until {
                        Some(until) => until.saturating_duration_since(Instant::now()),
                        None => wait,
                    };
                    if left.is_zero() {
                        return Ok(None);
                    }
                }
            }
        }
    }

    /// Counts a problem of the bus, and notes whether the controller is off.
    #[cold]
    fn trouble(&mut self, trouble: BusTrouble) {
        let counts = &mut self.counts;
        counts.error_frames += u64::from(trouble != BusTrouble::Foreign);
        match trouble {
            BusTrouble::Passive => counts.error_passive += 1,
            BusTrouble::ArbitrationLost => counts.arbitration_lost += 1,
            BusTrouble::Off => {
                counts.bus_off += 1;
                // The restart waits: a controller restarted at once may break a bus that recovers.
                self.off = Some(Instant::now());
            }
            BusTrouble::Restarted => {
                counts.restarted += 1;
                self.off = None;
            }
            _ => {}
        }
    }

    /// Tries at intervals to restart a controller that left the bus.
    #[cold]
    fn back_on_bus(&mut self, since: Instant) -> Result<(), PortError> {
        if since.elapsed() >= RESTART_EVERY
            && let Medium::Frames(medium) = &mut self.medium
        {
            medium.port.restart()?;
            self.off = Some(Instant::now());
        }
        Ok(())
    }

    /// Number of datagrams that came without the seal of the port's secret.
    #[must_use]
    pub fn unsealed(&self) -> u64 {
        if let Medium::Bytes(medium) = &self.medium { medium.port.unsealed() } else { 0 }
    }

    /// Reason why the last intact message that could not be read could not.
    #[must_use]
    pub fn last_unreadable(&self) -> Option<Unreadable> {
        self.unreadable
    }

    /// True while the controller is off the bus.
    #[must_use]
    pub fn is_off_bus(&self) -> bool {
        self.off.is_some()
    }

    /// Binds the port to the peer that was heard last, for a session, or releases it.
    pub fn hold_peer(&mut self, hold: bool) {
        if let Medium::Bytes(medium) = &mut self.medium {
            medium.port.hold_peer(hold);
        }
    }

    /// Opens the port again after it went away; frame numbers and counts continue.
    ///
    /// # Errors
    /// If the port isn't back.
    pub fn reopen(&mut self) -> Result<(), PortError> {
        match &mut self.medium {
            Medium::Bytes(medium) => {
                medium.port.reopen()?;
                // The bytes received last are a piece of a frame: the other end sends a zero before its
                // next frame.
                medium.from = 0;
                medium.to = 0;
            }
            Medium::Frames(medium) => medium.port.reopen()?,
        }
        self.off = None;
        Ok(())
    }

    /// Name under which the other end reaches this port.
    #[must_use]
    pub fn reached_at(&self) -> String {
        match &self.medium {
            Medium::Bytes(medium) => medium.port.reached_at(),
            Medium::Frames(_) => self.name.clone(),
        }
    }

    /// Fault injection of the port; `None`: the port was opened without.
    pub fn wired(&mut self) -> Option<&mut dyn Wired> {
        match &mut self.medium {
            Medium::Bytes(medium) => medium.port.wired(),
            Medium::Frames(medium) => medium.port.wired(),
        }
    }

    /// Counts of the traffic so far.
    #[must_use]
    pub fn counts(&self) -> TrafficCounts {
        let mut counts = self.counts;
        match &self.medium {
            Medium::Bytes(medium) => {
                let found = medium.decoder.counters();
                counts.lost = found.bytes_lost;
                counts.damaged = found.damaged();
                counts.missing = found.missing;
                counts.out_of_order = found.behind;
                counts.unreadable = found.unreadable;
            }
            Medium::Frames(medium) => {
                let found = medium.reassembler.counters();
                counts.lost = found.orphaned;
                counts.damaged = found.damaged();
                counts.missing = found.missing;
                counts.out_of_order = found.duplicated + found.disordered;
                counts.unreadable = found.unreadable;
            }
        }
        counts
    }

    /// Fields of a status that the wire counts, since `before`.
    #[must_use]
    pub fn status(&self, before: &TrafficCounts) -> DeviceStatus {
        let now = self.counts();
        let since = |now: u64, before: u64| u32::try_from(now - before).unwrap_or(u32::MAX);
        DeviceStatus {
            received: since(now.received, before.received),
            lost: since(now.lost, before.lost),
            damaged: since(now.damaged, before.damaged),
            missing: since(now.missing, before.missing),
            out_of_order: since(now.out_of_order, before.out_of_order),
            unreadable: since(now.unreadable, before.unreadable),
            ..DeviceStatus::default()
        }
    }
}

/// Result of reading a medium.
#[expect(clippy::large_enum_variant, reason = "the large variant is the one that comes")]
enum Next {
    Incoming(Incoming),
    /// Bytes or a frame that are no message, with the reason where they are intact; more may follow.
    Lost(Option<Unreadable>),
    Trouble(BusTrouble),
    Nothing,
}

impl ByteMedium {
    fn next(&mut self, wait: Duration) -> Result<Next, PortError> {
        if self.from == self.to && !self.concludes {
            let count = self.port.receive(&mut self.buffer, wait)?;
            if count == 0 {
                return Ok(Next::Nothing);
            }
            self.from = 0;
            self.to = count;
            self.concludes = self.port.datagrams();
        }
        let mut rest = &self.buffer[self.from..self.to];
        let event = self.decoder.next(&mut rest);
        self.from = self.to - rest.len();
        let event = match event {
            None if self.concludes => {
                self.concludes = false;
                self.decoder.end()
            }
            event => event,
        };
        Ok(match event {
            Some(serial::DecodeEvent::Received(received)) => {
                Next::Incoming(Incoming::Message(received.message))
            }
            Some(serial::DecodeEvent::Lost(serial::SkippedBytes {
                cause: serial::FrameDefect::Unreadable(Unreadable::NewerVersion { found }),
                ..
            })) => Next::Incoming(Incoming::Newer(found)),
            Some(serial::DecodeEvent::Lost(serial::SkippedBytes {
                cause: serial::FrameDefect::Unreadable(reason),
                ..
            })) => Next::Lost(Some(reason)),
            Some(serial::DecodeEvent::Lost(_)) | None => Next::Lost(None),
        })
    }
}

/// Longest time of a frame on a bus, s; 0 if its rates are unknown.
fn frame_s(frame: &can::BusFrame, bus: Option<Bus>) -> f64 {
    let Some(bus) = bus else { return 0.0 };
    let bits: Bits = match frame.format() {
        CanVersion::Classic => can::classic_bits(frame.data().len()),
        CanVersion::Fd => can::fd_bits(frame.data().len()),
    };
    bits.seconds(bus)
}

impl FrameMedium {
    fn send(
        &mut self,
        message: &Message,
        wait: Duration,
        bus: Option<Bus>,
        counts: &mut TrafficCounts,
    ) -> Result<bool, PortError> {
        // A role has no identifier for the messages that it never sends.
        let Ok(segments) = can::segments(message, self.role, self.format) else { return Ok(false) };
        for frame in segments {
            if !self.port.send(&frame, wait)? {
                return Ok(false);
            }
            counts.bus_s += frame_s(&frame, bus);
        }
        Ok(true)
    }

    fn next(
        &mut self,
        wait: Duration,
        bus: Option<Bus>,
        counts: &mut TrafficCounts,
    ) -> Result<Next, PortError> {
        let frame = match self.port.receive(wait)? {
            None => return Ok(Next::Nothing),
            Some(BusEvent::Trouble(trouble)) => return Ok(Next::Trouble(trouble)),
            Some(BusEvent::Frame(frame)) => frame,
        };
        counts.bus_s += frame_s(&frame, bus);
        Ok(match self.reassembler.receive(&frame) {
            Some(can::ReassemblyEvent::Received { message, .. }) => {
                Next::Incoming(Incoming::Message(message))
            }
            Some(can::ReassemblyEvent::Lost(can::DroppedMessage {
                cause: can::DropCause::Unreadable(Unreadable::NewerVersion { found }),
                ..
            })) => Next::Incoming(Incoming::Newer(found)),
            Some(can::ReassemblyEvent::Lost(can::DroppedMessage {
                cause: can::DropCause::Unreadable(reason),
                ..
            })) => Next::Lost(Some(reason)),
            Some(can::ReassemblyEvent::Lost(_)) | None => Next::Lost(None),
        })
    }
}
