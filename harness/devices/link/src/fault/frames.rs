//! Faults on CAN frames.

use super::lane::{Lane, below, seconds};
use super::table::Table;
use crate::port::{BusEvent, BusTrouble, Frames, PortError};
use octant_faults::wire::{Altered, Way, WireAction, WireFault, Wired};
use octant_wire::can::{BusFrame, CanVersion};
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// A CAN port with faults on it.
#[derive(Debug)]
pub struct FaultyFrames {
    inner: Box<dyn Frames>,
    table: Table,
    there: Lane<BusFrame>,
    back: Lane<BusFrame>,
    flight: Vec<(BusFrame, Duration)>,
    landed: Vec<(BusFrame, Duration)>,
    /// Events that the controller has to report.
    reports: VecDeque<BusTrouble>,
    /// True after a hang-up closed the port.
    closed: bool,
    /// True while a fault keeps the controller off the bus.
    off: bool,
}

/// Time until a sender repeats a frame that an error frame broke up, s.
const AGAIN_S: f64 = 200e-6;

/// Bytes of a frame, for checksums.
fn digest(frame: &BusFrame) -> [u8; 66] {
    let mut bytes = [0; 66];
    bytes[..2].copy_from_slice(&frame.id().to_le_bytes());
    bytes[2..2 + frame.data().len()].copy_from_slice(frame.data());
    bytes
}

impl FaultyFrames {
    /// Wraps a port, without faults at first.
    #[must_use]
    pub fn new(inner: Box<dyn Frames>) -> Self {
        Self {
            inner,
            table: Table::default(),
            there: Lane::new(),
            back: Lane::new(),
            flight: Vec::new(),
            landed: Vec::new(),
            reports: VecDeque::with_capacity(64),
            closed: false,
            off: false,
        }
    }

    /// Passes a frame through all faults, and queues the result.
    fn pass(&mut self, way: Way, frame: &BusFrame) {
        let now = Instant::now();
        let lane = match way {
            Way::ToDevice => &mut self.there,
            Way::ToHarness => &mut self.back,
        };
        lane.remember(frame);
        self.flight.clear();
        self.flight.push((*frame, Duration::ZERO));
        for entry in self.table.acting(now) {
            self.landed.clear();
            for (frame, after) in self.flight.drain(..) {
                let fault = entry.fault;
                let Some((nth, numbers)) = entry.next(way) else {
                    self.landed.push((frame, after));
                    if fault.action == WireAction::Reorder {
                        self.landed.extend(lane.held.take().map(|held| (held, after)));
                    }
                    continue;
                };
                let from = self.landed.len();
                let report = act(&fault, way, nth, numbers, lane, (frame, after), &mut self.landed);
                self.reports.extend(report);
                let came = &self.landed[from..];
                if report.is_some() || came != [(frame, after)] {
                    let digests: Vec<_> = came.iter().map(|(frame, _)| digest(frame)).collect();
                    entry.altered(&digest(&frame), digests.iter().map(|d| d.as_slice()));
                }
            }
            std::mem::swap(&mut self.flight, &mut self.landed);
        }
        for (frame, after) in self.flight.drain(..) {
            lane.push(frame, now, after);
        }
    }

    fn send_due(&mut self, wait: Duration) -> Result<bool, PortError> {
        let mut taken = true;
        while let Some(frame) = self.there.pop(Instant::now()) {
            taken &= self.inner.send(&frame, wait)?;
        }
        Ok(taken)
    }

    /// Applies hang-up and bus-off; returns an error while a hang-up keeps the port closed.
    fn there(&mut self) -> Result<(), PortError> {
        let now = Instant::now();
        let pulled = |action: &WireAction| matches!(action, WireAction::HangUp { .. });
        if let Some((entry, _)) = self.table.lasting(now, pulled)
            && !self.closed
        {
            self.closed = true;
            self.inner.close();
            self.there.clear();
            self.back.clear();
            entry.altered(b"here", [b"away".as_slice()]);
        }
        let off = |action: &WireAction| matches!(action, WireAction::BusOff { .. });
        match (self.table.lasting(now, off), self.off) {
            (Some((entry, _)), false) => {
                self.off = true;
                self.reports.push_back(BusTrouble::Off);
                entry.altered(b"on", [b"off".as_slice()]);
            }
            (None, true) => {
                self.off = false;
                self.reports.push_back(BusTrouble::Restarted);
            }
            _ => {}
        }
        if self.closed {
            return Err(PortError::gone("the CAN port", "a fault of the scenario pulled its plug"));
        }
        Ok(())
    }
}

/// Frame of another node, with identifier 0, which wins every arbitration.
fn foreign(fault: &WireFault, way: Way, nth: u64, i: u64, format: CanVersion) -> Option<BusFrame> {
    let data: [u8; 8] = std::array::from_fn(|k| fault.byte(way, nth, 8 * i + k as u64));
    BusFrame::new(0, format, &data)
}

/// Applies a fault to a frame: puts the results into `landed`, and returns the controller's report.
fn act(
    fault: &WireFault,
    way: Way,
    nth: u64,
    [a, b, c]: [f64; 3],
    lane: &mut Lane<BusFrame>,
    (frame, after): (BusFrame, Duration),
    landed: &mut Vec<(BusFrame, Duration)>,
) -> Option<BusTrouble> {
    let with = |data: &[u8]| BusFrame::new(frame.id(), frame.format(), data);
    let mut data = [0; 64];
    let data = &mut data[..frame.data().len()];
    data.copy_from_slice(frame.data());
    let mut report = None;
    match fault.action {
        WireAction::Flip => {
            if let Some(byte) = data.get_mut(below(a, frame.data().len())) {
                *byte ^= 1 << below(b, 8);
            }
            landed.extend(with(data).map(|frame| (frame, after)));
        }
        WireAction::Lose => {}
        WireAction::Duplicate => landed.extend([(frame, after); 2]),
        WireAction::Delay { by_s, jitter_s } => {
            landed.push((frame, after + seconds(by_s + jitter_s * c)));
        }
        WireAction::Replay { age } => {
            landed.extend(lane.ago(age).map(|old| (*old, after)));
            landed.push((frame, after));
        }
        WireAction::Reorder => match lane.held.take() {
            Some(held) => landed.extend([(frame, after), (held, after)]),
            None => lane.held = Some(frame),
        },
        WireAction::Babble { count } => {
            for i in 0..count.into() {
                let [high, low] = [0, 1].map(|k| fault.byte(way, nth, 1000 + 10 * i + k));
                let id = u16::from_le_bytes([low, high]) & 0x3FF
                    | if frame.format() == CanVersion::Fd { 0x400 } else { 0 };
                let bytes: [u8; 8] =
                    std::array::from_fn(|k| fault.byte(way, nth, 1002 + 10 * i + k as u64));
                landed.extend(BusFrame::new(id, frame.format(), &bytes).map(|f| (f, after)));
            }
            landed.push((frame, after));
        }
        WireAction::ErrorFrame => {
            landed.push((frame, after + seconds(AGAIN_S)));
            report = Some(BusTrouble::ErrorFrame);
        }
        WireAction::ArbitrationLost => {
            landed.extend(foreign(fault, way, nth, 0, frame.format()).map(|f| (f, after)));
            landed.push((frame, after));
            report = Some(BusTrouble::ArbitrationLost);
        }
        WireAction::Collision => {
            for (i, byte) in data.iter_mut().enumerate() {
                *byte = fault.byte(way, nth, i as u64);
            }
            landed.extend(with(data).map(|frame| (frame, after)));
            landed.push((frame, after));
        }
        WireAction::Overload { frames, each_s } => {
            for i in 0..frames.into() {
                let later = after + seconds(each_s * i as f64);
                let other = foreign(fault, way, nth, i, frame.format());
                landed.extend(other.map(|other| (other, later)));
            }
            landed.push((frame, after + seconds(each_s * f64::from(frames))));
        }
        // No frame passes.
        WireAction::BusOff { .. } => {}
        _ => landed.push((frame, after)),
    }
    report
}

impl Frames for FaultyFrames {
    fn send(&mut self, frame: &BusFrame, wait: Duration) -> Result<bool, PortError> {
        self.there()?;
        self.pass(Way::ToDevice, frame);
        self.send_due(wait)
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<BusEvent>, PortError> {
        let begun = Instant::now();
        loop {
            self.there()?;
            self.send_due(wait)?;
            if let Some(report) = self.reports.pop_front() {
                return Ok(Some(BusEvent::Trouble(report)));
            }
            let now = Instant::now();
            let left = wait.saturating_sub(now.saturating_duration_since(begun));
            let slow = |action: &WireAction| matches!(action, WireAction::SlowReader { .. });
            if let Some((entry, pause)) = self.table.lasting(now, slow) {
                if entry.next(Way::ToHarness).is_some_and(|(nth, _)| nth == 0) {
                    entry.altered(b"read", [b"not read".as_slice()]);
                }
                std::thread::sleep(pause.min(left));
                if left.is_zero() {
                    return Ok(None);
                }
                continue;
            }
            if let Some(frame) = self.back.pop(now) {
                return Ok(Some(BusEvent::Frame(frame)));
            }
            let due = [&self.there, &self.back].into_iter().filter_map(|lane| lane.next_in(now));
            let slice = due.min().map_or(left, |due| due.min(left));
            match self.inner.receive(slice)? {
                Some(BusEvent::Frame(frame)) => self.pass(Way::ToHarness, &frame),
                Some(trouble) => return Ok(Some(trouble)),
                None if left.is_zero() => return Ok(None),
                None => {}
            }
        }
    }

    fn format(&self) -> CanVersion {
        self.inner.format()
    }

    fn restart(&mut self) -> Result<bool, PortError> {
        if self.off { Ok(false) } else { self.inner.restart() }
    }

    fn close(&mut self) {
        self.inner.close();
    }

    fn reopen(&mut self) -> Result<(), PortError> {
        let pulled = |action: &WireAction| matches!(action, WireAction::HangUp { .. });
        if self.table.lasting(Instant::now(), pulled).is_some() {
            return Err(PortError::open("the CAN port", "a fault of the scenario pulled its plug"));
        }
        self.inner.reopen()?;
        self.closed = false;
        while self.inner.receive(Duration::ZERO)?.is_some() {}
        Ok(())
    }

    fn wired(&mut self) -> Option<&mut dyn Wired> {
        Some(self)
    }
}

impl Wired for FaultyFrames {
    fn begin(&mut self, handle: u32, fault: &WireFault) {
        self.table.begin(handle, fault);
    }

    fn end(&mut self, handle: u32) {
        self.table.end(handle);
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
