//! Faults on bytes: a serial line, or datagrams.

use super::lane::{Lane, below, seconds};
use super::table::Table;
use crate::port::{Bytes, PortError};
use octant_faults::wire::{Altered, Way, WireAction, WireFault, Wired};
use std::time::{Duration, Instant};

/// A port of bytes with faults on it.
#[derive(Debug)]
pub struct FaultyBytes {
    inner: Box<dyn Bytes>,
    table: Table,
    there: Lane<Vec<u8>>,
    back: Lane<Vec<u8>>,
    /// Bytes received of an incomplete frame, on a line.
    begun: Vec<u8>,
    /// Frames between two faults, with the delay so far.
    flight: Vec<(Vec<u8>, Duration)>,
    landed: Vec<(Vec<u8>, Duration)>,
    /// True after a hang-up closed the port.
    closed: bool,
}

/// Number of bytes after which a stretch of a line without a zero is taken for a frame.
const STRETCH_MAX: usize = 600;

impl FaultyBytes {
    /// Wraps a port, without faults at first.
    #[must_use]
    pub fn new(inner: Box<dyn Bytes>) -> Self {
        Self {
            inner,
            table: Table::default(),
            there: Lane::new(),
            back: Lane::new(),
            begun: Vec::with_capacity(STRETCH_MAX),
            flight: Vec::new(),
            landed: Vec::new(),
            closed: false,
        }
    }

    /// Passes a frame through all faults, and queues the result.
    fn pass(&mut self, way: Way, frame: &[u8]) {
        let now = Instant::now();
        let lane = match way {
            Way::ToDevice => &mut self.there,
            Way::ToHarness => &mut self.back,
        };
        lane.remember(&frame.to_vec());
        self.flight.clear();
        self.flight.push((frame.to_vec(), Duration::ZERO));
        for entry in self.table.acting(now) {
            self.landed.clear();
            for (frame, after) in self.flight.drain(..) {
                let Some((nth, numbers)) = entry.next(way) else {
                    release(lane, &mut self.landed, frame, after, &entry.fault.action);
                    continue;
                };
                let from = self.landed.len();
                let fault = entry.fault;
                let held = act(&fault, way, nth, numbers, lane, &frame, after, &mut self.landed);
                let came = self.landed[from..].iter().map(|(frame, _)| frame.as_slice());
                let delayed = self.landed[from..].iter().any(|(_, later)| *later != after);
                if held || delayed || came.clone().ne([frame.as_slice()]) {
                    entry.altered(&frame, came);
                }
            }
            // A frame cut to nothing leaves no byte for the next fault to act on.
            self.landed.retain(|(frame, _)| !frame.is_empty());
            std::mem::swap(&mut self.flight, &mut self.landed);
        }
        for (frame, after) in self.flight.drain(..) {
            lane.push(frame, now, after);
        }
    }

    /// Takes bytes from the port, and cuts a line into frames.
    fn take(&mut self, bytes: &[u8]) {
        if self.inner.datagrams() {
            self.pass(Way::ToHarness, bytes);
            return;
        }
        for byte in bytes {
            self.begun.push(*byte);
            let ends = *byte == 0 && self.begun.iter().any(|byte| *byte != 0);
            if ends || self.begun.len() >= STRETCH_MAX {
                let frame = std::mem::take(&mut self.begun);
                self.pass(Way::ToHarness, &frame);
            }
        }
    }

    /// Sends the frames that are due.
    fn send_due(&mut self, wait: Duration) -> Result<bool, PortError> {
        let mut taken = true;
        while let Some(frame) = self.there.pop(Instant::now()) {
            taken &= self.inner.send(&frame, wait)?;
        }
        Ok(taken)
    }

    /// Returns an error while a hang-up keeps the port closed.
    fn there(&mut self) -> Result<(), PortError> {
        let pulled = |action: &WireAction| matches!(action, WireAction::HangUp { .. });
        if let Some((entry, _)) = self.table.lasting(Instant::now(), pulled)
            && !self.closed
        {
            self.closed = true;
            self.inner.close();
            self.there.clear();
            self.back.clear();
            self.begun.clear();
            entry.altered(b"here", [b"away".as_slice()]);
        }
        if self.closed {
            let port = self.inner.reached_at();
            return Err(PortError::gone(port, "a fault of the scenario pulled its plug"));
        }
        Ok(())
    }
}

/// Passes a frame that a fault doesn't act on, then the frame that was held back for it.
fn release(
    lane: &mut Lane<Vec<u8>>,
    landed: &mut Vec<(Vec<u8>, Duration)>,
    frame: Vec<u8>,
    after: Duration,
    action: &WireAction,
) {
    match (action, lane.held.take()) {
        (WireAction::Reorder, Some(held)) => {
            landed.push((frame, after));
            landed.push((held, after));
        }
        (WireAction::Coalesce, Some(mut held)) => {
            held.extend_from_slice(&frame);
            landed.push((held, after));
        }
        (_, held) => {
            lane.held = held;
            landed.push((frame, after));
        }
    }
}

/// Applies a fault to a frame, and puts the results into `landed`; true: the frame is held back.
#[expect(clippy::too_many_arguments, reason = "all that is known of one frame")]
fn act(
    fault: &WireFault,
    way: Way,
    nth: u64,
    [a, b, c]: [f64; 3],
    lane: &mut Lane<Vec<u8>>,
    frame: &[u8],
    after: Duration,
    landed: &mut Vec<(Vec<u8>, Duration)>,
) -> bool {
    let mut one = |frame: Vec<u8>| landed.push((frame, after));
    let mut changed = frame.to_vec();
    let at = below(a, frame.len());
    match fault.action {
        WireAction::Flip => {
            changed[at] ^= 1 << below(b, 8);
            one(changed);
        }
        WireAction::Insert => {
            changed.insert(below(a, frame.len() + 1), fault.byte(way, nth, 0));
            one(changed);
        }
        WireAction::Drop => {
            changed.remove(at);
            one(changed);
        }
        WireAction::Truncate => {
            changed.truncate(at);
            one(changed);
        }
        WireAction::Checksum => {
            // The last byte that isn't zero belongs to the checksum, or is the code byte that stands
            // for its trailing zeros.
            if let Some(byte) = changed.iter_mut().rfind(|byte| **byte != 0) {
                let bit = 1 << below(b, 8);
                // The byte must not become zero, which would end the frame early.
                *byte ^= if *byte == bit { bit | bit.rotate_left(1) } else { bit };
            }
            one(changed);
        }
        WireAction::Duplicate => {
            one(changed);
            one(frame.to_vec());
        }
        WireAction::Lose => {}
        WireAction::Delay { by_s, jitter_s } => {
            landed.push((changed, after + seconds(by_s + jitter_s * c)));
        }
        WireAction::Replay { age } => {
            if let Some(old) = lane.ago(age) {
                one(old.clone());
            }
            one(changed);
        }
        WireAction::Reorder | WireAction::Coalesce => {
            if lane.held.is_none() {
                lane.held = Some(changed);
                return true;
            }
            release(lane, landed, changed, after, &fault.action);
        }
        WireAction::Split { pieces, apart_s } => {
            let length = frame.len().div_ceil(pieces.max(1) as usize).max(1);
            for (i, piece) in frame.chunks(length).enumerate() {
                landed.push((piece.to_vec(), after + seconds(apart_s * i as f64)));
            }
        }
        WireAction::Babble { count } => {
            let byte = |i: u32| fault.byte(way, nth, i.into()).wrapping_sub(1);
            one((0..count).map(byte).collect());
            one(changed);
        }
        // A line held low reads as zeros, of which one is kept. Each frame of that time leaves a zero
        // of its own.
        WireAction::Break { .. } => one(vec![0]),
        WireAction::Framing => {
            let inner = 1 + below(a, frame.len().saturating_sub(2));
            if let Some(byte) = changed.get_mut(inner) {
                *byte = 0;
            }
            one(changed);
        }
        _ => one(changed),
    }
    false
}

impl Bytes for FaultyBytes {
    fn send(&mut self, bytes: &[u8], wait: Duration) -> Result<bool, PortError> {
        self.there()?;
        self.pass(Way::ToDevice, bytes);
        self.send_due(wait)
    }

    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<usize, PortError> {
        let begun = Instant::now();
        loop {
            self.there()?;
            self.send_due(wait)?;
            let now = Instant::now();
            let left = wait.saturating_sub(now.saturating_duration_since(begun));
            let slow = |action: &WireAction| matches!(action, WireAction::SlowReader { .. });
            if let Some((entry, pause)) = self.table.lasting(now, slow) {
                if entry.next(Way::ToHarness).is_some_and(|(nth, _)| nth == 0) {
                    entry.altered(b"read", [b"not read".as_slice()]);
                }
                std::thread::sleep(pause.min(left));
                if left.is_zero() {
                    return Ok(0);
                }
                continue;
            }
            if let Some(frame) = self.back.pop(now) {
                let count = frame.len().min(buffer.len());
                buffer[..count].copy_from_slice(&frame[..count]);
                return Ok(count);
            }
            let due = [&self.there, &self.back].into_iter().filter_map(|lane| lane.next_in(now));
            let slice = due.min().map_or(left, |due| due.min(left));
            let mut bytes = [0; 4096];
            let count = self.inner.receive(&mut bytes, slice)?;
            if count > 0 {
                self.take(&bytes[..count]);
            } else if left.is_zero() {
                return Ok(0);
            }
        }
    }

    fn datagrams(&self) -> bool {
        self.inner.datagrams()
    }

    fn connections(&self) -> u64 {
        self.inner.connections()
    }

    fn reached_at(&self) -> String {
        self.inner.reached_at()
    }

    fn unsealed(&self) -> u64 {
        self.inner.unsealed()
    }

    fn hold_peer(&mut self, hold: bool) {
        self.inner.hold_peer(hold);
    }

    fn close(&mut self) {
        self.inner.close();
    }

    fn reopen(&mut self) -> Result<(), PortError> {
        let pulled = |action: &WireAction| matches!(action, WireAction::HangUp { .. });
        if self.table.lasting(Instant::now(), pulled).is_some() {
            let port = self.inner.reached_at();
            return Err(PortError::open(port, "a fault of the scenario pulled its plug"));
        }
        self.inner.reopen()?;
        self.closed = false;
        // Bytes that were on their way are lost.
        let mut bytes = [0; 4096];
        while self.inner.receive(&mut bytes, Duration::ZERO)? > 0 {}
        Ok(())
    }

    fn wired(&mut self) -> Option<&mut dyn Wired> {
        Some(self)
    }
}

impl Wired for FaultyBytes {
    fn begin(&mut self, handle: u32, fault: &WireFault) {
        self.table.begin(handle, fault);
    }

    fn end(&mut self, handle: u32) {
        self.table.end(handle);
        // Releases frames that a fault held back.
        let now = Instant::now();
        for lane in [&mut self.there, &mut self.back] {
            if let Some(held) = lane.held.take() {
                lane.push(held, now, Duration::ZERO);
            }
        }
    }

    fn altered(&mut self, handle: u32) -> Altered {
        self.table.take(handle)
    }
}
