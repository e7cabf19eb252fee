//! The kernel's times at which datagrams arrived.

#[cfg(target_os = "linux")]
pub(super) use self::linux::ArrivalStamps;
#[cfg(not(target_os = "linux"))]
pub(super) use self::other::ArrivalStamps;

#[cfg(target_os = "linux")]
mod linux {
    use nix::sys::socket::sockopt::ReceiveTimestampns;
    use nix::sys::socket::{ControlMessageOwned, MsgFlags, SockaddrStorage, recvmsg, setsockopt};
    use nix::sys::time::TimeSpec;
    use std::io::{Error, IoSliceMut, Result};
    use std::net::{SocketAddr, UdpSocket};
    use std::os::fd::AsRawFd;
    use std::time::{Duration, SystemTime, UNIX_EPOCH};

    /// Receives datagrams with the times at which the kernel got them.
    #[derive(Debug)]
    pub(in super::super) struct ArrivalStamps {
        /// Room of the control messages.
        control: Vec<u8>,
        arrived: Option<SystemTime>,
    }

    impl ArrivalStamps {
        /// Switches the stamps of a socket on; `None`: the kernel has none. It begins a moment later:
        /// until then the time is that of the reading.
        pub(in super::super) fn of(socket: &UdpSocket) -> Option<Self> {
            setsockopt(socket, ReceiveTimestampns, &true).ok()?;
            Some(Self { control: nix::cmsg_space!(TimeSpec), arrived: None })
        }

        /// Receives a datagram, as the socket itself does.
        pub(in super::super) fn receive(
            &mut self,
            socket: &UdpSocket,
            buffer: &mut [u8],
        ) -> Result<(usize, SocketAddr)> {
            self.arrived = None;
            let mut pieces = [IoSliceMut::new(buffer)];
            let control = Some(&mut self.control[..]);
            let flags = MsgFlags::empty();
            let got = recvmsg::<SockaddrStorage>(socket.as_raw_fd(), &mut pieces, control, flags)?;
            for message in got.cmsgs()? {
                if let ControlMessageOwned::ScmTimestampns(stamp) = message {
                    self.arrived = time(stamp);
                }
            }
            let from = got.address.as_ref().and_then(address);
            let from = from.ok_or_else(|| Error::other("a datagram came from no address"))?;
            Ok((got.bytes, from))
        }

        /// Time at which the last datagram arrived.
        pub(in super::super) fn arrived(&self) -> Option<SystemTime> {
            self.arrived
        }
    }

    fn time(stamp: TimeSpec) -> Option<SystemTime> {
        let since = Duration::new(
            u64::try_from(stamp.tv_sec()).ok()?,
            u32::try_from(stamp.tv_nsec()).ok()?,
        );
        UNIX_EPOCH.checked_add(since)
    }

    fn address(from: &SockaddrStorage) -> Option<SocketAddr> {
        match (from.as_sockaddr_in(), from.as_sockaddr_in6()) {
            (Some(from), _) => Some(SocketAddr::V4((*from).into())),
            (None, Some(from)) => Some(SocketAddr::V6((*from).into())),
            (None, None) => None,
        }
    }
}

#[cfg(not(target_os = "linux"))]
mod other {
    use std::net::{SocketAddr, UdpSocket};
    use std::time::SystemTime;

    /// Uninhabited: Octant asks the kernel of Linux alone.
    #[derive(Debug)]
    pub(in super::super) enum ArrivalStamps {}

    impl ArrivalStamps {
        pub(in super::super) fn of(_: &UdpSocket) -> Option<Self> {
            None
        }

        pub(in super::super) fn receive(
            &mut self,
            _: &UdpSocket,
            _: &mut [u8],
        ) -> std::io::Result<(usize, SocketAddr)> {
            match *self {}
        }

        pub(in super::super) fn arrived(&self) -> Option<SystemTime> {
            match *self {}
        }
    }
}
