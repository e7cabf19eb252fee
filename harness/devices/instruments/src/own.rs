//! Octant's own protocol: frames of `octant-wire` with samples in them.
//!
//! The bytes are those described in `harness/devices/wire/README.md`. Samples of an instrument become readings;
//! other messages pass. Increments are the counts of [`octant_sample::counts`] and lose nothing.

use super::framing::ProtocolFacts;
use crate::encoding::{CannotCarry, Needs};
use crate::framing::{FramingEvent, ReadingCounters, ReadingDefect, UnreadBytes};
use crate::{MeasuredTriad, Reading};
use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{DeviceTime, Sample, Status};
use octant_wire::message::{ClockTime, SampleMessage, StepNumber};
use octant_wire::{Message, serial};

/// Facts of the protocol.
pub(crate) const FACTS: ProtocolFacts = ProtocolFacts {
    name: "octant",
    doc: "the wire of this program",
    resolution: [1.5e-11, 9.4e-10],
    false_starts: &[&[1, 2, 3], &[0xFF; 300]],
};

/// Finds readings in a stream of bytes.
#[derive(Clone, Debug, Default)]
pub struct OwnDecoder {
    line: serial::SerialDecoder,
    last_sequence: Option<u64>,
    counters: ReadingCounters,
}

impl OwnDecoder {
    /// Makes a decoder that has received nothing.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Counts of the traffic so far. Zeros count as part of a frame, and so do the bytes of an
    /// incomplete one.
    #[must_use]
    pub fn counters(&self) -> &ReadingCounters {
        &self.counters
    }

    /// Takes bytes up to the end of the next frame with an event, and returns the event. Returns `None`
    /// when all bytes are taken: call it until then.
    #[inline]
    pub fn next(&mut self, bytes: &mut &[u8]) -> Option<FramingEvent> {
        loop {
            let event = self.line.next(bytes);
            self.count_bytes();
            if let Some(event) = self.event(event?) {
                return Some(event);
            }
        }
    }

    /// Ends the input.
    pub fn end(&mut self) -> Option<FramingEvent> {
        let event = self.line.end();
        self.count_bytes();
        self.event(event?)
    }

    fn count_bytes(&mut self) {
        let line = self.line.counters();
        self.counters.bytes = line.bytes;
        self.counters.bytes_lost = line.bytes_lost;
        self.counters.bytes_framed = line.bytes - line.bytes_lost;
    }

    fn event(&mut self, event: serial::DecodeEvent) -> Option<FramingEvent> {
        let counters = &mut self.counters;
        match event {
            serial::DecodeEvent::Received(received) => match received.message {
                Message::Sample(SampleMessage { sample, .. }) => {
                    let reading = Reading::of_sample(&sample);
                    counters.readings += 1;
                    counters.in_sequence(&mut self.last_sequence, reading.sequence);
                    Some(FramingEvent::Reading(reading))
                }
                _ => {
                    counters.other += 1;
                    None
                }
            },
            serial::DecodeEvent::Lost(lost) => {
                let cause = match lost.cause {
                    serial::FrameDefect::Long | serial::FrameDefect::Malformed => {
                        ReadingDefect::Malformed
                    }
                    serial::FrameDefect::Checksum { found, computed } => {
                        ReadingDefect::Checksum { found, computed }
                    }
                    serial::FrameDefect::Unreadable(unreadable) => {
                        ReadingDefect::Unreadable(unreadable)
                    }
                };
                counters.cause(cause);
                let bytes = usize::try_from(lost.bytes).unwrap_or(usize::MAX);
                Some(FramingEvent::Lost(UnreadBytes { cause, bytes }))
            }
        }
    }
}

/// Encodes readings as frames with a sample in each.
#[derive(Clone, Debug, Default)]
pub struct OwnEncoder {
    line: serial::SerialEncoder,
    rotation: [Accumulator; 3],
    velocity: [Accumulator; 3],
}

impl OwnEncoder {
    /// Makes an encoder that has sent nothing.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Encodes a reading as a frame, and carries the remainder of its counts to the next reading.
    ///
    /// # Errors
    /// If the reading lacks rotation, velocity, sequence or stamp, or has means without an interval.
    pub fn encode(&mut self, reading: &Reading) -> Result<&[u8], CannotCarry> {
        let needs = Needs("octant");
        let sequence = needs.some(reading.sequence, "a sequence number")?;
        let ns = needs.some(reading.stamp, "a stamp")?.ns;
        let mut status = reading.status;
        let mut counts = |measured: Option<MeasuredTriad>,
                          accumulators: &mut [Accumulator; 3],
                          lsb: f64,
                          saturated: Status,
                          what| {
            let increments = needs.increments(measured, reading.interval_s, what)?;
            Ok(core::array::from_fn(|axis| {
                let count = accumulators[axis].count(increments[axis] / lsb);
                status.set(saturated, status.contains(saturated) | count.saturated);
                count.value
            }))
        };
        let rotation = &mut self.rotation;
        let flag = Status::GYRO_SATURATED;
        let delta_theta =
            counts(reading.rotation, rotation, DELTA_THETA_LSB_RAD, flag, "rotation")?;
        let velocity = &mut self.velocity;
        let flag = Status::ACCELEROMETER_SATURATED;
        let delta_velocity =
            counts(reading.velocity, velocity, DELTA_VELOCITY_LSB_MPS, flag, "velocity")?;
        status.set(
            Status::GIMBAL_INVALID,
            status.contains(Status::GIMBAL_INVALID) | reading.gimbal.is_none(),
        );
        let sample = Sample {
            sequence,
            device_time: DeviceTime { ns },
            delta_theta,
            delta_velocity,
            gimbal: reading.gimbal.unwrap_or_default(),
            status,
        };
        // The step has 15 bits, and is 0 for the first sample.
        let step = StepNumber::new((sequence.wrapping_sub(1) & 0x7FFF) as u16);
        let message = Message::Sample(SampleMessage { step, aided: false, sample });
        Ok(self.line.encode(&message, ClockTime { ns }))
    }
}
