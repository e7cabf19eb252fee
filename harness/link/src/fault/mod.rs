//! What can go wrong on a wire, done on purpose: a port around a port.
//!
//! What a fault is says [`octant_faults::wire`]; here it happens, on the harness's side of the wire and in
//! both directions. What was altered is counted by comparing what went in with what came out.

mod bytes;
mod frames;
mod lane;
mod table;

pub use bytes::FaultyBytes;
pub use frames::FaultyFrames;

use crate::port::Port;

/// A port on which faults can be done.
#[must_use]
pub fn around(port: Port) -> Port {
    match port {
        Port::Bytes(port) => Port::Bytes(Box::new(FaultyBytes::new(port))),
        Port::Frames(port) => Port::Frames(Box::new(FaultyFrames::new(port))),
    }
}
