//! Messages between the two processes: postcard, each message after its length. A message of length
//! zero only wakes the other process.

use super::super::instance::{
    ClockNews, FmuMessage, InstanceError, OpenOptions, Stepped, Update, VariableGroup,
};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::io::{self, Read, Write};

/// Version of the protocol: both are the same program, otherwise they refuse.
pub(super) const VERSION: &str = concat!("octant ", env!("CARGO_PKG_VERSION"), " fmu 3");

/// Largest length of a message, bytes.
const LENGTH_MAX: u32 = 1 << 31;

/// Request of the parent process.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Request {
    /// The first request, with the FMU.
    Open {
        version: String,
        name: String,
        folder: Vec<u8>,
        options: Box<OpenOptions>,
    },
    EnterInitialization {
        start_s: f64,
        stop_s: Option<f64>,
        tolerance: Option<f64>,
    },
    ExitInitialization,
    Set {
        group: VariableGroup,
        values: Vec<f64>,
    },
    Get {
        group: VariableGroup,
    },
    SetStrings {
        group: VariableGroup,
        values: Vec<String>,
    },
    GetStrings {
        group: VariableGroup,
    },
    SetBinaries {
        group: VariableGroup,
        values: Vec<Vec<u8>>,
    },
    GetBinaries {
        group: VariableGroup,
    },
    Step {
        time_s: f64,
        step_s: f64,
    },
    /// Registers an exchange with these groups; it gets a number for exchanges through shared
    /// memory.
    Plan {
        set: Vec<VariableGroup>,
        get: Vec<VariableGroup>,
    },
    HandleEvents,
    EnterEventMode,
    UpdateDiscreteStates,
    LeaveEventMode,
    ActivatePartition {
        clock: u32,
        time_s: f64,
    },
    PartitionInterval(u32),
    KeepState,
    RestoreState(u64),
    ForgetState(u64),
    StateToBytes(u64),
    StateFromBytes(Vec<u8>),
    Reset,
    Terminate,
    Messages,
    /// The last request: the FMU is freed.
    Quit,
}

/// Answer of the child process.
#[derive(Debug, Serialize, Deserialize)]
pub(super) enum Answer {
    Done(()),
    Truth(bool),
    Number(u64),
    Numbers(Vec<f64>),
    Strings(Vec<String>),
    Binaries(Vec<Vec<u8>>),
    Bytes(Vec<u8>),
    Stepped(Stepped),
    Update(Update),
    ClockNews(ClockNews),
    Interval(Option<f64>),
    Messages(Vec<FmuMessage>),
}

/// An answer, or the FMU's error.
pub(super) type Reply = Result<Answer, InstanceError>;

/// Writes a message.
pub(super) fn write(to: &mut impl Write, message: &impl Serialize) -> io::Result<()> {
    let mut bytes = postcard::to_extend(message, vec![0; 4]).map_err(io::Error::other)?;
    let length = u32::try_from(bytes.len() - 4)
        .ok()
        .filter(|length| *length <= LENGTH_MAX)
        .ok_or_else(|| io::Error::other("the message is too long"))?;
    bytes[..4].copy_from_slice(&length.to_le_bytes());
    to.write_all(&bytes)
}

/// Wakes the other process.
pub(super) fn wake(to: &mut impl Write) -> io::Result<()> {
    to.write_all(&[0; 4])
}

/// Reads a message; `None`: it only woke this process.
pub(super) fn read<T: DeserializeOwned>(from: &mut impl Read) -> io::Result<Option<T>> {
    let mut length = [0; 4];
    from.read_exact(&mut length)?;
    let length = u32::from_le_bytes(length);
    if length == 0 {
        return Ok(None);
    }
    if length > LENGTH_MAX {
        return Err(io::Error::new(io::ErrorKind::InvalidData, "a message is too long"));
    }
    // Read as it arrives, so that a length alone needs no memory.
    let mut bytes = Vec::new();
    from.take(u64::from(length)).read_to_end(&mut bytes)?;
    if bytes.len() < length as usize {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    postcard::from_bytes(&bytes)
        .map(Some)
        .map_err(|e| io::Error::new(io::ErrorKind::InvalidData, e))
}

#[cfg(test)]
mod tests {
    use super::{Reply, Request, read, wake, write};

    #[test]
    fn messages_come_back_with_their_bits() {
        let mut bytes = Vec::new();
        wake(&mut bytes).unwrap();
        let value = f64::from_bits(0x7FF8_0000_0000_1234);
        write(&mut bytes, &Request::Step { time_s: value, step_s: -0.0 }).unwrap();
        let mut from = &bytes[..];
        assert!(read::<Request>(&mut from).unwrap().is_none());
        let Some(Request::Step { time_s, step_s }) = read(&mut from).unwrap() else {
            panic!("another message");
        };
        assert_eq!((time_s.to_bits(), step_s.to_bits()), (value.to_bits(), 1 << 63));
        assert!(from.is_empty());
    }

    #[test]
    fn what_is_no_message_is_an_error() {
        for bytes in [&b""[..], b"\x01", b"\x05\0\0\0\x01", b"\xff\xff\xff\xff", b"\x01\0\0\0\xff"]
        {
            assert!(read::<Reply>(&mut &bytes[..]).is_err(), "{bytes:?}");
        }
    }
}
