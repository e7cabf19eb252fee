//! Messages between the harness and the other ends.
//!
//! Every message is a payload of a fixed length for its kind: four bytes of head, then fields,
//! little-endian, without gaps ([`crate::layout`] lists them). Increments and angles are the counts of
//! [`octant_sample::counts`]; outputs and aiding are the 64 bits of their f64. So a message arrives bit
//! for bit as it was sent, also NaN and minus zero.

mod hello;
mod kind;
mod link;
mod parameters;
mod step;
mod steps;

pub use hello::{Agreement, Capabilities, EndLimits, Hello, SessionRefusal, StepPacing, agree};
pub use kind::{EndRole, MAX_PAYLOAD_BYTES, MessageKind};
pub use link::{
    Bye, ClockTime, DeviceStatus, EndCondition, Heartbeat, Offset, Reason, TimeReply, TimeRequest,
};
pub use parameters::{Gathered, Gathering, PARAMETERS_SEGMENTS, ParametersSegment, SEGMENT_VALUES};
pub use step::StepNumber;
pub use steps::{AidingMessage, End, OutputMessage, Ready, Restart, SampleMessage};

use crate::Unreadable;
use crate::bytes::{Reader, Writer};

/// A message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Message {
    /// Identity and capabilities of the sender.
    Hello(Hello),
    /// A sample, on which the device steps.
    Sample(SampleMessage),
    /// Reference for the sample that follows.
    Aiding(AidingMessage),
    /// Answer of the core to a sample, or to the end.
    Output(OutputMessage),
    /// A sixth of the parameters with their σ.
    Parameters(ParametersSegment),
    /// Request to restart the core.
    Restart(Restart),
    /// The stream of samples has ended.
    End(End),
    /// The core has restarted.
    Ready(Ready),
    /// Sign of life of the sender.
    Heartbeat(Heartbeat),
    /// Work and losses of a device.
    Status(DeviceStatus),
    /// Request for the time.
    TimeRequest(TimeRequest),
    /// Answer to a request for the time.
    TimeReply(TimeReply),
    /// The sender leaves, with its reason.
    Bye(Bye),
}

/// A payload: the fields of a message as bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Payload {
    kind: MessageKind,
    bytes: [u8; MAX_PAYLOAD_BYTES],
}

impl Payload {
    /// Kind of the message.
    #[must_use]
    pub fn kind(&self) -> MessageKind {
        self.kind
    }

    /// Bytes of the payload, as many as its kind has.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes[..self.kind.payload_bytes()]
    }
}

impl Message {
    /// Kind of the message.
    #[must_use]
    pub fn kind(&self) -> MessageKind {
        match self {
            Self::Hello(_) => MessageKind::Hello,
            Self::Sample(_) => MessageKind::Sample,
            Self::Aiding(_) => MessageKind::Aiding,
            Self::Output(_) => MessageKind::Output,
            Self::Parameters(_) => MessageKind::Parameters,
            Self::Restart(_) => MessageKind::Restart,
            Self::End(_) => MessageKind::End,
            Self::Ready(_) => MessageKind::Ready,
            Self::Heartbeat(_) => MessageKind::Heartbeat,
            Self::Status(_) => MessageKind::Status,
            Self::TimeRequest(_) => MessageKind::TimeRequest,
            Self::TimeReply(_) => MessageKind::TimeReply,
            Self::Bye(_) => MessageKind::Bye,
        }
    }

    /// Payload of the message.
    #[must_use]
    pub fn payload(&self) -> Payload {
        let mut payload = Payload { kind: self.kind(), bytes: [0; MAX_PAYLOAD_BYTES] };
        self.write(&mut payload.bytes);
        payload
    }

    /// Writes the payload to the beginning of a buffer.
    #[inline]
    pub(crate) fn write(&self, bytes: &mut [u8; MAX_PAYLOAD_BYTES]) {
        let w = &mut Writer::new(bytes);
        match self {
            Self::Hello(hello) => hello.write(w),
            Self::Sample(sample) => sample.write(w),
            Self::Aiding(aiding) => aiding.write(w),
            Self::Output(output) => output.write(w),
            Self::Parameters(segment) => segment.write(w),
            Self::Restart(restart) => restart.write(w),
            Self::End(End { step }) | Self::Ready(Ready { step }) => {
                w.u16(step.number());
                w.u16(0);
            }
            Self::Heartbeat(heartbeat) => heartbeat.write(w),
            Self::Status(status) => status.write(w),
            Self::TimeRequest(request) => request.write(w),
            Self::TimeReply(reply) => reply.write(w),
            Self::Bye(bye) => bye.write(w),
        }
    }

    /// Reads the message of a kind from its payload.
    ///
    /// # Errors
    /// If this version has no such payload. Bytes without a meaning are ignored.
    #[inline]
    pub fn read(kind: MessageKind, payload: &[u8]) -> Result<Self, Unreadable> {
        if let (MessageKind::Hello, Some(version)) = (kind, payload.first_chunk::<2>()) {
            let found = u16::from_le_bytes(*version);
            // Applies to a newer hello of any content and length.
            if found > crate::VERSION {
                return Err(Unreadable::NewerVersion { found });
            }
        }
        if payload.len() != kind.payload_bytes() {
            return Err(Unreadable::Length { kind, found: payload.len() });
        }
        let r = &mut Reader::new(payload);
        Ok(match kind {
            MessageKind::Hello => Self::Hello(Hello::read(r)?),
            MessageKind::Sample => Self::Sample(SampleMessage::read(r)),
            MessageKind::Aiding => Self::Aiding(AidingMessage::read(r)?),
            MessageKind::Output => Self::Output(OutputMessage::read(r)?),
            MessageKind::Parameters => Self::Parameters(ParametersSegment::read(r)?),
            MessageKind::Restart => Self::Restart(Restart::read(r)),
            MessageKind::End => Self::End(End { step: StepNumber::new(r.u16()) }),
            MessageKind::Ready => Self::Ready(Ready { step: StepNumber::new(r.u16()) }),
            MessageKind::Heartbeat => Self::Heartbeat(Heartbeat::read(r)?),
            MessageKind::Status => Self::Status(DeviceStatus::read(r)),
            MessageKind::TimeRequest => Self::TimeRequest(TimeRequest::read(r)),
            MessageKind::TimeReply => Self::TimeReply(TimeReply::read(r)),
            MessageKind::Bye => Self::Bye(Bye::read(r)?),
        })
    }

    /// True if both have the same bits: NaN equals itself, and zero differs from minus zero.
    #[must_use]
    pub fn same_bits(&self, other: &Self) -> bool {
        self.payload() == other.payload()
    }
}
