//! Faults injected on a wire: a port around a port.
//!
//! [`octant_faults::wire`] defines the faults; this module applies them on the harness's side of the
//! wire, in both directions. Altered frames are counted by comparing input and output.

mod bytes;
mod frames;
mod lane;
mod table;

pub use bytes::FaultyBytes;
pub use frames::FaultyFrames;

use crate::port::Port;

/// Wraps a port so that faults can be injected on it.
#[must_use]
pub fn around(port: Port) -> Port {
    match port {
        Port::Bytes(port) => Port::Bytes(Box::new(FaultyBytes::new(port))),
        Port::Frames(port) => Port::Frames(Box::new(FaultyFrames::new(port))),
    }
}
