//! Listening to a CAN bus: the frames of all nodes, with identifiers of 11 or 29 bits.

use super::error::PortError;
#[cfg(not(all(target_os = "linux", feature = "can")))]
use super::error::WITHOUT_CAN;
use super::frames::HeardFrame;
use super::slcan::SlcanPort;
#[cfg(all(target_os = "linux", feature = "can"))]
use super::socket_can::SocketCan;
use crate::Uri;
use std::time::{Duration, SystemTime};

/// A listener on a CAN bus, which sends nothing.
#[derive(Debug)]
pub struct Listener {
    bus: Bus,
}

#[derive(Debug)]
enum Bus {
    #[cfg(all(target_os = "linux", feature = "can"))]
    Kernel(SocketCan),
    Slcan(Box<SlcanPort>),
}

impl Listener {
    /// Opens a bus to listen for messages of some identifiers, with 29 bits or 11. An adapter on a
    /// serial line passes on other messages too.
    ///
    /// # Errors
    /// If the port is no CAN bus, or can't be opened.
    pub fn open(uri: &Uri, identifiers: &[(u32, bool)]) -> Result<Self, PortError> {
        let bus = match uri {
            Uri::Slcan(slcan) => Bus::Slcan(Box::new(SlcanPort::open(slcan)?)),
            #[cfg(all(target_os = "linux", feature = "can"))]
            Uri::Can(can) => Bus::Kernel(SocketCan::listen(can, identifiers)?),
            #[cfg(not(all(target_os = "linux", feature = "can")))]
            Uri::Can(_) => {
                let _ = identifiers;
                return Err(PortError::open(uri, WITHOUT_CAN));
            }
            _ => return Err(PortError::open(uri, "it is no CAN bus")),
        };
        Ok(Self { bus })
    }

    /// Receives the next frame within a time, with the kernel's time of its arrival where there is one: an
    /// adapter on a serial line has none. `None`: nothing came, or an event that is no frame with data.
    ///
    /// # Errors
    /// If the port is gone.
    pub fn hear(
        &mut self,
        wait: Duration,
    ) -> Result<Option<(HeardFrame, Option<SystemTime>)>, PortError> {
        match &mut self.bus {
            #[cfg(all(target_os = "linux", feature = "can"))]
            Bus::Kernel(bus) => bus.hear(wait),
            Bus::Slcan(bus) => Ok(bus.hear(wait)?.map(|heard| (heard, None))),
        }
    }
}
