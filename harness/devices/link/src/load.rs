//! Whether a line or bus carries a sample rate, before anything is sent.

use crate::uri::{Rates, Uri};
use octant_wire::can::{self, Bus};
use octant_wire::serial::{Baud, LineLoad};
use octant_wire::traffic::Traffic;

/// Highest permitted utilization of a line or bus, 1.
pub const LIMIT: f64 = 0.9;

/// Load of a port.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PortLoad {
    /// Load of a serial line, which has a wire for each direction.
    Line(LineLoad),
    /// Load of a bus.
    Bus(Bus, can::BusLoad),
    /// The port has no bit rate: a pseudo terminal, UDP, a virtual bus.
    Unlimited,
}

/// Error of a port that is too slow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// The line is too slow.
    #[error(
        "serial line at {baud} baud can't carry {rate_hz:.0} samples a second: that is {:.0} % of it \
         ({:.0} % there, {:.0} % back), {:.0} % are allowed; expected {fits_baud} baud or more",
        100.0 * load.from_harness.max(load.to_harness), 100.0 * load.from_harness,
        100.0 * load.to_harness, 100.0 * LIMIT
    )]
    Line {
        /// Bit rate of the line, bit/s.
        baud: u32,
        /// Sample rate, Hz.
        rate_hz: f64,
        /// Load of the line.
        load: LineLoad,
        /// Sufficient bit rate, bit/s.
        fits_baud: u32,
    },
    /// The bus is too slow.
    #[error(transparent)]
    Bus(#[from] can::Overload),
}

/// Load of a session in real time, if the port can carry it. `bus` are the rates reported by the
/// interface of `can:`, used where the URI names none.
///
/// # Errors
/// If the port is too slow.
pub fn real_time(uri: &Uri, sample_rate_hz: f64, bus: Option<Bus>) -> Result<PortLoad, LoadError> {
    let traffic = Traffic::session(sample_rate_hz);
    let bus = match uri.rates() {
        Rates::Line(baud) => return line(baud, &traffic),
        Rates::Bus(named) => named.or(bus),
        Rates::Unlimited => None,
    };
    match bus {
        Some(bus) => Ok(PortLoad::Bus(bus, bus.carry(&traffic, LIMIT)?)),
        None => Ok(PortLoad::Unlimited),
    }
}

/// Bus of a port: as named by its URI, else as reported by the interface.
#[must_use]
pub fn bus(uri: &Uri) -> Option<Bus> {
    let Rates::Bus(named) = uri.rates() else { return None };
    #[cfg(all(target_os = "linux", feature = "can"))]
    if let (None, Uri::Can(can)) = (named, uri) {
        return crate::port::interface_bus(&can.interface, can.format);
    }
    named
}

/// Common bit rates of serial lines, bit/s.
const BAUDS: [u32; 10] = [
    115_200, 230_400, 460_800, 500_000, 921_600, 1_000_000, 1_500_000, 2_000_000, 3_000_000,
    4_000_000,
];

fn line(rate: u32, traffic: &Traffic) -> Result<PortLoad, LoadError> {
    let most = |load: &LineLoad| load.from_harness.max(load.to_harness);
    let load = Baud::new(rate).load(traffic);
    if most(&load) <= LIMIT {
        return Ok(PortLoad::Line(load));
    }
    let needed = most(&load) * f64::from(rate) / LIMIT;
    let fits = BAUDS.into_iter().find(|baud| f64::from(*baud) >= needed);
    Err(LoadError::Line {
        baud: rate,
        rate_hz: traffic.samples_hz,
        load,
        fits_baud: fits.unwrap_or(needed.ceil() as u32),
    })
}
