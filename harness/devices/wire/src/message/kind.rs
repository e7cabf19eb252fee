//! Kinds of messages, their sizes and their senders.

/// Bytes of the longest payload, a restart.
pub const MAX_PAYLOAD_BYTES: usize = 244;

/// Role of an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum EndRole {
    /// The test program: it sends samples and receives outputs.
    Harness = 0,
    /// The unit under test: it receives samples and answers with outputs.
    Device = 1,
    /// An inertial unit: it sends samples unasked.
    Instrument = 2,
}

impl EndRole {
    /// All roles, in the order of their codes.
    pub const ALL: [Self; 3] = [Self::Harness, Self::Device, Self::Instrument];

    /// Name used in texts.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Harness => "harness",
            Self::Device => "device",
            Self::Instrument => "instrument",
        }
    }
}

/// Kind of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum MessageKind {
    /// [`super::Hello`].
    Hello = 1,
    /// [`super::SampleMessage`].
    Sample = 2,
    /// [`super::AidingMessage`].
    Aiding = 3,
    /// [`super::OutputMessage`].
    Output = 4,
    /// [`super::ParametersSegment`].
    Parameters = 5,
    /// [`super::Restart`].
    Restart = 6,
    /// [`super::End`].
    End = 7,
    /// [`super::Ready`].
    Ready = 8,
    /// [`super::Heartbeat`].
    Heartbeat = 9,
    /// [`super::DeviceStatus`].
    Status = 10,
    /// [`super::TimeRequest`].
    TimeRequest = 11,
    /// [`super::TimeReply`].
    TimeReply = 12,
    /// [`super::Bye`].
    Bye = 13,
}

impl MessageKind {
    /// All kinds, in the order of their codes, which begin with 1.
    pub const ALL: [Self; 13] = [
        Self::Hello,
        Self::Sample,
        Self::Aiding,
        Self::Output,
        Self::Parameters,
        Self::Restart,
        Self::End,
        Self::Ready,
        Self::Heartbeat,
        Self::Status,
        Self::TimeRequest,
        Self::TimeReply,
        Self::Bye,
    ];

    /// Code on the wire.
    #[must_use]
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Kind of a code.
    #[must_use]
    pub fn of(code: u8) -> Option<Self> {
        Self::ALL.get(usize::from(code).checked_sub(1)?).copied()
    }

    /// Name used in texts and vectors.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hello => "hello",
            Self::Sample => "sample",
            Self::Aiding => "aiding",
            Self::Output => "output",
            Self::Parameters => "parameters",
            Self::Restart => "restart",
            Self::End => "end",
            Self::Ready => "ready",
            Self::Heartbeat => "heartbeat",
            Self::Status => "status",
            Self::TimeRequest => "time_request",
            Self::TimeReply => "time_reply",
            Self::Bye => "bye",
        }
    }

    /// Size of the payload, bytes.
    #[must_use]
    pub const fn payload_bytes(self) -> usize {
        match self {
            Self::Hello => 108,
            Self::Sample | Self::Status => 52,
            Self::Aiding => 36,
            Self::Output => 132,
            Self::Parameters => 92,
            Self::Restart => MAX_PAYLOAD_BYTES,
            Self::End | Self::Ready => 4,
            Self::Heartbeat | Self::TimeRequest => 12,
            Self::TimeReply => 28,
            Self::Bye => 44,
        }
    }

    /// Roles that send this kind.
    #[must_use]
    pub const fn senders(self) -> &'static [EndRole] {
        match self {
            Self::Hello | Self::Heartbeat | Self::Bye => {
                &[EndRole::Harness, EndRole::Device, EndRole::Instrument]
            }
            Self::Sample | Self::Aiding => &[EndRole::Harness, EndRole::Instrument],
            Self::Output | Self::Parameters | Self::Ready => &[EndRole::Device],
            Self::Restart | Self::End | Self::TimeRequest => &[EndRole::Harness],
            Self::Status | Self::TimeReply => &[EndRole::Device, EndRole::Instrument],
        }
    }
}
