//! One CAN frame.

/// Version of CAN.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CanVersion {
    /// Classic CAN, up to 8 bytes.
    Classic,
    /// CAN FD, up to 64 bytes.
    Fd,
}

impl CanVersion {
    /// Most bytes of data in a frame.
    #[must_use]
    pub const fn room(self) -> usize {
        match self {
            Self::Classic => 8,
            Self::Fd => 64,
        }
    }

    /// Length of the shortest frame that holds this many bytes: FD has only some lengths beyond 8. If
    /// they don't fit, the longest length.
    #[must_use]
    pub const fn length_for(self, bytes: usize) -> usize {
        match (self, bytes) {
            (_, ..=8) => bytes,
            (Self::Classic, _) => 8,
            (Self::Fd, ..=12) => 12,
            (Self::Fd, ..=16) => 16,
            (Self::Fd, ..=20) => 20,
            (Self::Fd, ..=24) => 24,
            (Self::Fd, ..=32) => 32,
            (Self::Fd, ..=48) => 48,
            (Self::Fd, _) => 64,
        }
    }
}

/// A data frame with an identifier of 11 bits. Remote frames, error frames and frames with 29 bits are
/// not part of the protocol: the caller who takes frames from a bus drops them.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct BusFrame {
    id: u16,
    format: CanVersion,
    length: u8,
    data: [u8; 64],
}

impl BusFrame {
    /// Makes a frame from data of a bus. `None` if no data frame with an 11-bit identifier can be like
    /// that: the identifier is beyond 0x7FF, or the format doesn't have the length.
    #[must_use]
    pub fn new(id: u16, format: CanVersion, data: &[u8]) -> Option<Self> {
        let length = data.len();
        if id > 0x7FF || length > format.room() || format.length_for(length) != length {
            return None;
        }
        let mut frame = Self { id, format, length: length as u8, data: [0; 64] };
        frame.data[..length].copy_from_slice(data);
        Some(frame)
    }

    /// Identifier.
    #[must_use]
    pub fn id(&self) -> u16 {
        self.id
    }

    /// Format.
    #[must_use]
    pub fn format(&self) -> CanVersion {
        self.format
    }

    /// Data.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        &self.data[..usize::from(self.length)]
    }
}

impl core::fmt::Debug for BusFrame {
    /// Writes the frame in the form of `cansend`.
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let mark = match self.format {
            CanVersion::Classic => "#",
            // Flag of the bit rate switch.
            CanVersion::Fd => "##1",
        };
        write!(f, "{:03X}{mark}", self.id)?;
        self.data().iter().try_for_each(|byte| write!(f, "{byte:02X}"))
    }
}
