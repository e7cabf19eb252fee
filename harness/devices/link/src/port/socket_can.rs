//! CAN interfaces of the Linux kernel.

use super::error::PortError;
use super::frames::{BusEvent, BusTrouble, Frames, HeardFrame};
use crate::Uri;
use crate::uri::Can;
use octant_wire::EndRole;
use octant_wire::can::{Bus, BusFrame, CanVersion, Slot};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use socketcan::{
    CanAnyFrame, CanDataFrame, CanErrorFrame, CanFdFrame, CanFdSocket, CanFilter, CanInterface,
    EmbeddedFrame, Id, Socket, SocketOptions, StandardId,
};
use std::io::ErrorKind;
use std::time::{Duration, Instant, SystemTime};

/// A CAN interface that receives the messages for its role, and the problems of the bus.
#[derive(Debug)]
pub struct SocketCan {
    can: Can,
    role: EndRole,
    uri: String,
    /// `None` while the interface is closed.
    socket: Option<CanFdSocket>,
}

/// Flags of an identifier in the kernel's format.
const EXTENDED: u32 = 0x8000_0000;
const REMOTE: u32 = 0x4000_0000;
/// Mask of the format and slot in an identifier.
const SLOT: u32 = 0x7E0;

/// Bits of an error frame's identifier and of its second byte of data, from linux/can/error.h.
mod error {
    pub(super) const ARBITRATION: u32 = 0x02;
    pub(super) const CONTROLLER: u32 = 0x04;
    pub(super) const NOT_ACKNOWLEDGED: u32 = 0x20;
    pub(super) const OFF: u32 = 0x40;
    pub(super) const RESTARTED: u32 = 0x100;
    pub(super) const OVERFLOW: u8 = 0x03;
    pub(super) const WARNING: u8 = 0x0C;
    pub(super) const PASSIVE: u8 = 0x30;
}

impl SocketCan {
    /// Opens an interface for a role.
    ///
    /// # Errors
    /// If the interface isn't there or is down, can't do CAN FD where that is requested, or has another
    /// bit rate than the URI says.
    pub fn open(can: &Can, role: EndRole) -> Result<Self, PortError> {
        Self::filtered(can, role, &filters(role, can.format))
    }

    /// Opens an interface to listen for messages of some identifiers, with 29 bits or 11.
    pub(super) fn listen(can: &Can, identifiers: &[(u32, bool)]) -> Result<Self, PortError> {
        let filter = |&(id, extended): &(u32, bool)| {
            let (id, mask) = if extended { (id | EXTENDED, 0x1FFF_FFFF) } else { (id, 0x7FF) };
            CanFilter::new(id, mask | EXTENDED | REMOTE)
        };
        let filters: Vec<CanFilter> = identifiers.iter().map(filter).collect();
        let bus = Self::filtered(can, EndRole::Device, &filters)?;
        // Without stamps an arrival is the return of the read, which is told.
        let _ = bus.socket()?.set_recv_timestamp(true);
        Ok(bus)
    }

    fn filtered(can: &Can, role: EndRole, filters: &[CanFilter]) -> Result<Self, PortError> {
        let uri = Uri::Can(can.clone()).to_string();
        let refused = |reason: String| PortError::open(&uri, reason);
        let interface = CanInterface::open(&can.interface)
            .map_err(|error| refused(format!("there is no such interface ({error})")))?;
        let details = interface.details().ok();
        if details.as_ref().is_some_and(|details| !details.is_up) {
            return Err(refused(format!(
                "the interface is down; ip link set {} up type can bitrate … brings it up",
                can.interface
            )));
        }
        let is_fd = |mtu| matches!(mtu, socketcan::nl::Mtu::Fd);
        let mtu = details.and_then(|details| details.mtu);
        if can.format == CanVersion::Fd && mtu.is_some_and(|mtu| !is_fd(mtu)) {
            return Err(refused(
                "the interface carries classic CAN alone, expected one with CAN FD switched on"
                    .to_owned(),
            ));
        }
        compare(can, interface_bus(&can.interface, can.format))?;
        let socket =
            CanFdSocket::open(&can.interface).map_err(|error| refused(error.to_string()))?;
        let set_up = || {
            socket.set_nonblocking(true)?;
            socket.set_filters(filters)?;
            socket.set_error_filter_accept_all()
        };
        set_up().map_err(|error: std::io::Error| refused(error.to_string()))?;
        Ok(Self { can: can.clone(), role, uri, socket: Some(socket) })
    }

    fn gone(&self, error: &std::io::Error) -> PortError {
        PortError::gone(&self.uri, error)
    }

    fn socket(&self) -> Result<&CanFdSocket, PortError> {
        self.socket.as_ref().ok_or_else(|| PortError::gone(&self.uri, "it is closed"))
    }

    /// Receives the kernel's next frame within a time, by one way to read.
    fn next<T>(
        &self,
        wait: Duration,
        read: impl Fn(&CanFdSocket) -> std::io::Result<T>,
    ) -> Result<Option<T>, PortError> {
        let mut waited = wait.is_zero();
        loop {
            match read(self.socket()?) {
                Ok(frame) => return Ok(Some(frame)),
                Err(error) if error.kind() == ErrorKind::WouldBlock => {
                    if std::mem::replace(&mut waited, true) {
                        return Ok(None);
                    }
                    self.wait(wait)?;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.gone(&error)),
            }
        }
    }

    /// Receives the next frame of any node within a time, with the kernel's time of its arrival; `None`: nothing
    /// came, or no frame with data.
    pub(super) fn hear(
        &self,
        wait: Duration,
    ) -> Result<Option<(HeardFrame, Option<SystemTime>)>, PortError> {
        let heard = |id: Id, data: &[u8]| match id {
            Id::Standard(id) => HeardFrame::new(u32::from(id.as_raw()), false, data),
            Id::Extended(id) => HeardFrame::new(id.as_raw(), true, data),
        };
        let came = self.next(wait, Socket::read_frame_with_timestamps)?;
        Ok(came.and_then(|(frame, stamps)| {
            let heard = match &frame {
                CanAnyFrame::Normal(frame) => heard(frame.id(), frame.data()),
                CanAnyFrame::Fd(frame) => heard(frame.id(), frame.data()),
                CanAnyFrame::Remote(_) | CanAnyFrame::Error(_) => return None,
            };
            Some((heard, stamps.socket))
        }))
    }

    /// Waits until a frame is there.
    fn wait(&self, wait: Duration) -> Result<(), PortError> {
        let timeout = Timespec {
            tv_sec: i64::try_from(wait.as_secs()).unwrap_or(i64::MAX),
            tv_nsec: i64::from(wait.subsec_nanos()),
        };
        let mut fds = [PollFd::new(self.socket()?, PollFlags::IN)];
        match poll(&mut fds, Some(&timeout)) {
            Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
            Err(error) => Err(self.gone(&error.into())),
        }
    }
}

/// Bit rates of an interface's bus; `None`: it has none, like a virtual one.
#[must_use]
pub fn interface_bus(interface: &str, format: CanVersion) -> Option<Bus> {
    let interface = CanInterface::open(interface).ok()?;
    let rate = |bps: u32| (bps > 0).then_some(bps);
    let nominal_bps = rate(interface.bit_rate().ok()??)?;
    let data_bps = match format {
        CanVersion::Classic => None,
        CanVersion::Fd => {
            let timing = interface.data_bit_timing().ok().flatten();
            Some(timing.and_then(|timing| rate(timing.bitrate)).unwrap_or(nominal_bps))
        }
    };
    Some(Bus { nominal_bps, data_bps })
}

/// Checks that the interface has the rates that the URI says; an interface without rates has them.
///
/// # Errors
/// If a rate is another one.
pub fn compare(can: &Can, found: Option<Bus>) -> Result<(), PortError> {
    let Some(found) = found else { return Ok(()) };
    let pairs = [
        ("bitrate", can.bitrate, Some(found.nominal_bps)),
        ("data_bitrate", can.data_bitrate, found.data_bps),
    ];
    for (option, said, found) in pairs {
        if let (Some(said), Some(found)) = (said, found)
            && said != found
        {
            let reason = format!("the interface has {option} {found}, expected {said}");
            return Err(PortError::open(Uri::Can(can.clone()), reason));
        }
    }
    Ok(())
}

/// Kernel filters of a role: it receives the messages of the other roles.
#[must_use]
pub fn filters(role: EndRole, format: CanVersion) -> Vec<CanFilter> {
    let heard = |sender: EndRole| (sender == EndRole::Harness) != (role == EndRole::Harness);
    Slot::ALL
        .iter()
        .filter(|slot| heard(slot.sender))
        .map(|slot| CanFilter::new(slot.id(0, format).into(), SLOT | EXTENDED | REMOTE))
        .collect()
}

/// Problem that an error frame reports. Drivers combine several bits in one frame: the worst one
/// counts.
#[must_use]
pub fn trouble(frame: &CanErrorFrame) -> BusTrouble {
    let bits = frame.error_bits();
    let controller =
        if bits & error::CONTROLLER != 0 { frame.data().get(1).copied().unwrap_or(0) } else { 0 };
    if bits & error::OFF != 0 {
        BusTrouble::Off
    } else if bits & error::RESTARTED != 0 {
        BusTrouble::Restarted
    } else if controller & error::PASSIVE != 0 {
        BusTrouble::Passive
    } else if controller & error::OVERFLOW != 0 {
        BusTrouble::Overrun
    } else if controller & error::WARNING != 0 {
        BusTrouble::Warning
    } else if bits & error::NOT_ACKNOWLEDGED != 0 {
        BusTrouble::NotAcknowledged
    } else if bits & error::ARBITRATION != 0 {
        BusTrouble::ArbitrationLost
    } else {
        BusTrouble::ErrorFrame
    }
}

/// Converts a frame of the kernel to a frame of this protocol.
#[must_use]
pub fn event(frame: &CanAnyFrame) -> BusEvent {
    let ours = |id: Id, format: CanVersion, data: &[u8]| match id {
        Id::Standard(id) => BusFrame::new(id.as_raw(), format, data),
        Id::Extended(_) => None,
    };
    let frame = match frame {
        CanAnyFrame::Error(frame) => return BusEvent::Trouble(trouble(frame)),
        CanAnyFrame::Remote(_) => None,
        CanAnyFrame::Normal(frame) => ours(frame.id(), CanVersion::Classic, frame.data()),
        CanAnyFrame::Fd(frame) => ours(frame.id(), CanVersion::Fd, frame.data()),
    };
    frame.map_or(BusEvent::Trouble(BusTrouble::Foreign), BusEvent::Frame)
}

/// True if the queue of the interface is full.
fn is_full(error: &std::io::Error) -> bool {
    error.kind() == ErrorKind::WouldBlock
        || error.raw_os_error() == Some(rustix::io::Errno::NOBUFS.raw_os_error())
}

/// Interval at which a full queue is retried: about the duration of a frame.
const FULL_WAIT: Duration = Duration::from_micros(100);

impl Frames for SocketCan {
    fn send(&mut self, frame: &BusFrame, wait: Duration) -> Result<bool, PortError> {
        // Identifiers of this protocol have 11 bits.
        let Some(id) = StandardId::new(frame.id()) else { return Ok(false) };
        let socket = self.socket()?;
        let begun = Instant::now();
        loop {
            let written = match frame.format() {
                CanVersion::Classic => match CanDataFrame::new(id, frame.data()) {
                    Some(frame) => socket.write_frame(&socketcan::CanFrame::Data(frame)),
                    None => return Ok(false),
                },
                CanVersion::Fd => match CanFdFrame::new(id, frame.data()) {
                    Some(mut frame) => {
                        frame.set_brs(true);
                        socket.write_frame(&frame)
                    }
                    None => return Ok(false),
                },
            };
            match written {
                Ok(()) => return Ok(true),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) if is_full(&error) => {
                    if begun.elapsed() >= wait {
                        return Ok(false);
                    }
                    std::thread::sleep(FULL_WAIT);
                }
                Err(error) => return Err(self.gone(&error)),
            }
        }
    }

    fn receive(&mut self, wait: Duration) -> Result<Option<BusEvent>, PortError> {
        Ok(self.next(wait, Socket::read_frame)?.map(|frame| event(&frame)))
    }

    fn format(&self) -> CanVersion {
        self.can.format
    }

    fn restart(&mut self) -> Result<bool, PortError> {
        // The kernel refuses without privileges, and if the interface restarts by itself (restart-ms).
        let interface = CanInterface::open(&self.can.interface)
            .map_err(|error| PortError::gone(&self.uri, error))?;
        Ok(interface.restart().is_ok())
    }

    fn close(&mut self) {
        self.socket = None;
    }

    fn reopen(&mut self) -> Result<(), PortError> {
        *self = Self::open(&self.can, self.role)?;
        Ok(())
    }
}
