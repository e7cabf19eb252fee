//! Bus operations of FMI-LS-BUS 1.0.0 for CAN, as bytes and back.
//!
//! An operation is a code and a length, u32 each, and its arguments, all little-endian. Several
//! follow one another without gaps. Bytes that are no operation are returned unchanged, to be
//! answered with a Format Error.

/// Codes of the operations.
mod code {
    pub(super) const FORMAT_ERROR: u32 = 0x01;
    pub(super) const CAN_TRANSMIT: u32 = 0x10;
    pub(super) const CAN_FD_TRANSMIT: u32 = 0x11;
    pub(super) const CAN_XL_TRANSMIT: u32 = 0x12;
    pub(super) const CONFIRM: u32 = 0x20;
    pub(super) const ARBITRATION_LOST: u32 = 0x30;
    pub(super) const BUS_ERROR: u32 = 0x31;
    pub(super) const CONFIGURATION: u32 = 0x40;
    pub(super) const STATUS: u32 = 0x41;
    pub(super) const WAKEUP: u32 = 0x42;
}

/// Bytes of code and length.
const HEADER_BYTES: usize = 8;

/// Largest number of bytes that a Format Error can quote.
const QUOTED_MAX: usize = u16::MAX as usize;

/// A frame on the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Transmit<'a> {
    pub id: u32,
    /// True if the identifier has 29 bits.
    pub extended: bool,
    pub kind: Kind,
    pub data: &'a [u8],
}

/// Kind of CAN frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Classic { remote: bool },
    Fd,
    Xl,
}

/// A bus error, as reported to each node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct BusError {
    pub id: u32,
    pub cause: ErrorCause,
    /// True if this node has detected it.
    pub primary: bool,
    /// True if the frame was this node's.
    pub is_sender: bool,
}

/// Causes that the error counters distinguish.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ErrorCause {
    Acknowledgement,
    BrokenErrorFrame,
    /// Bit, stuffing, form and CRC errors.
    Other,
}

/// An operation that a node receives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operation<'a> {
    Transmit(Transmit<'a>),
    Confirm {
        id: u32,
    },
    ArbitrationLost {
        id: u32,
    },
    BusError(BusError),
    /// A peer couldn't read this operation of the node.
    FormatError {
        quoted: &'a [u8],
    },
    /// Configuration and Status are for the bus simulation, and a node ignores them; this node
    /// never sleeps, so that a Wakeup has no effect.
    Ignored,
}

/// Iterates over the operations in the bytes of a tick; `Err`: bytes that are no operation.
#[derive(Clone, Debug)]
pub(super) struct Operations<'a> {
    rest: &'a [u8],
}

impl<'a> Operations<'a> {
    pub(super) fn of(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }
}

impl<'a> Iterator for Operations<'a> {
    type Item = Result<Operation<'a>, &'a [u8]>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let whole =
            Arguments(self.rest).u32().zip(Arguments(&self.rest[4.min(self.rest.len())..]).u32());
        let length = whole.map(|(_, length)| length as usize);
        let sound = length.filter(|length| (HEADER_BYTES..=self.rest.len()).contains(length));
        let (Some((code, _)), Some(length)) = (whole, sound) else {
            // The start of the next operation can't be known.
            return Some(Err(core::mem::take(&mut self.rest)));
        };
        let (operation, rest) = self.rest.split_at(length);
        self.rest = rest;
        Some(read(code, &operation[HEADER_BYTES..]).ok_or(operation))
    }
}

/// Reader of arguments.
struct Arguments<'a>(&'a [u8]);

impl<'a> Arguments<'a> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*first)
    }

    fn u8(&mut self) -> Option<u8> {
        self.take::<1>().map(|[byte]| byte)
    }

    fn u32(&mut self) -> Option<u32> {
        self.take().map(u32::from_le_bytes)
    }

    fn boolean(&mut self) -> Option<bool> {
        match self.u8()? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }

    /// Reads a length of two bytes, and the data, which must fill the rest.
    fn data(&mut self) -> Option<&'a [u8]> {
        let length = usize::from(u16::from_le_bytes(self.take()?));
        (self.0.len() == length).then(|| core::mem::take(&mut self.0))
    }

    /// Reads an identifier, and whether it has 29 bits.
    fn identifier(&mut self) -> Option<(u32, bool)> {
        let (id, extended) = (self.u32()?, self.boolean()?);
        (id <= if extended { 0x1FFF_FFFF } else { 0x7FF }).then_some((id, extended))
    }
}

/// Reads an operation; `None`: it doesn't follow the standard.
fn read<'a>(code: u32, arguments: &'a [u8]) -> Option<Operation<'a>> {
    let mut from = Arguments(arguments);
    let operation = match code {
        code::FORMAT_ERROR => Operation::FormatError { quoted: from.data()? },
        code::CAN_TRANSMIT => {
            let (id, extended) = from.identifier()?;
            let remote = from.boolean()?;
            let data = if remote { from.remote()? } else { from.data()? };
            (data.len() <= 8).then_some(())?;
            Operation::Transmit(Transmit { id, extended, kind: Kind::Classic { remote }, data })
        }
        code::CAN_FD_TRANSMIT => {
            let (id, extended) = from.identifier()?;
            from.boolean()?;
            from.boolean()?;
            let data = from.data()?;
            let fits = matches!(data.len(), 0..=8 | 12 | 16 | 20 | 24 | 32 | 48 | 64);
            fits.then_some(())?;
            Operation::Transmit(Transmit { id, extended, kind: Kind::Fd, data })
        }
        code::CAN_XL_TRANSMIT => {
            let (id, extended) = from.identifier()?;
            from.boolean()?;
            // SDU type, virtual network, acceptance field.
            from.take::<6>()?;
            let data = from.data()?;
            (1..=2048).contains(&data.len()).then_some(())?;
            Operation::Transmit(Transmit { id, extended, kind: Kind::Xl, data })
        }
        code::CONFIRM => Operation::Confirm { id: from.u32()? },
        code::ARBITRATION_LOST => Operation::ArbitrationLost { id: from.u32()? },
        code::BUS_ERROR => {
            let id = from.u32()?;
            let cause = match from.u8()? {
                1..=4 => ErrorCause::Other,
                5 => ErrorCause::Acknowledgement,
                6 => ErrorCause::BrokenErrorFrame,
                _ => return None,
            };
            let primary = match from.u8()? {
                1 => true,
                2 => false,
                _ => return None,
            };
            Operation::BusError(BusError { id, cause, primary, is_sender: from.boolean()? })
        }
        code::CONFIGURATION | code::STATUS | code::WAKEUP => {
            from.0 = &[];
            Operation::Ignored
        }
        _ => return None,
    };
    from.0.is_empty().then_some(operation)
}

impl<'a> Arguments<'a> {
    /// Reads the data length of a remote frame, which carries no data. By the standard's text the
    /// bytes follow all the same, by its headers they don't: both are accepted.
    fn remote(&mut self) -> Option<&'a [u8]> {
        let length = usize::from(u16::from_le_bytes(self.take()?));
        let data = core::mem::take(&mut self.0);
        (length <= 8 && (data.is_empty() || data.len() == length)).then_some(data)
    }
}

/// State of a CAN node.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum NodeState {
    #[default]
    ErrorActive = 1,
    ErrorPassive = 2,
    BusOff = 3,
}

/// Action of a bus simulation on a frame that lost arbitration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum ArbitrationLost {
    Buffer = 1,
    Notify = 2,
}

/// One setting of the bus simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Configuration {
    BitRate(u32),
    DataBitRate(u32),
    ArbitrationLost(ArbitrationLost),
}

/// Appends operations to bytes.
#[derive(Debug)]
pub(super) struct Writer<'a>(pub &'a mut Vec<u8>);

impl Writer<'_> {
    fn header(&mut self, code: u32, arguments: usize) {
        let length = (HEADER_BYTES + arguments) as u32;
        self.0.extend_from_slice(&code.to_le_bytes());
        self.0.extend_from_slice(&length.to_le_bytes());
    }

    /// Quotes bytes that could not be read, up to the largest length of a quotation.
    pub(super) fn format_error(&mut self, quoted: &[u8]) {
        let quoted = &quoted[..quoted.len().min(QUOTED_MAX)];
        self.header(code::FORMAT_ERROR, 2 + quoted.len());
        self.0.extend_from_slice(&(quoted.len() as u16).to_le_bytes());
        self.0.extend_from_slice(quoted);
    }

    /// Writes a data frame with an identifier of 11 bits; `esi`: its sender is error-passive (CAN
    /// FD).
    pub(super) fn transmit(&mut self, id: u16, fd: bool, esi: bool, data: &[u8]) {
        let (code, arguments) =
            if fd { (code::CAN_FD_TRANSMIT, 9) } else { (code::CAN_TRANSMIT, 8) };
        self.header(code, arguments + data.len());
        self.0.extend_from_slice(&u32::from(id).to_le_bytes());
        // Not extended; then for FD the bit rate switch and the error state, else not remote.
        self.0.extend_from_slice(if fd { &[0, 1] } else { &[0, 0] });
        if fd {
            self.0.push(esi.into());
        }
        self.0.extend_from_slice(&(data.len() as u16).to_le_bytes());
        self.0.extend_from_slice(data);
    }

    pub(super) fn configuration(&mut self, configuration: Configuration) {
        match configuration {
            Configuration::BitRate(rate) | Configuration::DataBitRate(rate) => {
                self.header(code::CONFIGURATION, 5);
                self.0.push(if matches!(configuration, Configuration::BitRate(_)) { 1 } else { 2 });
                self.0.extend_from_slice(&rate.to_le_bytes());
            }
            Configuration::ArbitrationLost(behaviour) => {
                self.header(code::CONFIGURATION, 2);
                self.0.extend_from_slice(&[4, behaviour as u8]);
            }
        }
    }

    pub(super) fn status(&mut self, state: NodeState) {
        self.header(code::STATUS, 1);
        self.0.push(state as u8);
    }
}

/// Bytes of a transmit operation.
pub(super) const fn transmit_bytes(fd: bool, data: usize) -> usize {
    HEADER_BYTES + if fd { 9 } else { 8 } + data
}

/// Returns whether unreadable bytes were meant as a Format Error, which isn't answered: two nodes
/// would answer each other for ever.
pub(super) fn is_format_error(bytes: &[u8]) -> bool {
    Arguments(bytes).u32() == Some(code::FORMAT_ERROR)
}
