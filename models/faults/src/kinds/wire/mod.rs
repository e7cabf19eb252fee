//! The wire between harness and device: bytes, datagrams, CAN frames.

mod bus;
mod bytes;
mod frames;
mod port;
mod rule;

use crate::catalogue::{Acts, FaultKind};
use crate::wire::Medium;

pub(super) static KINDS: &[&FaultKind] = &[
    &bytes::FLIP,
    &bytes::INSERT,
    &bytes::DROP,
    &bytes::TRUNCATE,
    &bytes::CHECKSUM,
    &frames::LOSS,
    &frames::DUPLICATE,
    &frames::REORDER,
    &frames::DELAY,
    &frames::REPLAY,
    &frames::SPLIT,
    &frames::COALESCE,
    &frames::BABBLE,
    &port::BREAK,
    &port::FRAMING,
    &port::HANG_UP,
    &port::SLOW_READER,
    &bus::ERROR_FRAME,
    &bus::ARBITRATION,
    &bus::OFF,
    &bus::COLLISION,
    &bus::OVERLOAD,
];

/// Returns whether a kind of the wire can happen on a medium.
#[must_use]
pub fn happens_on(kind: &FaultKind, medium: Medium) -> bool {
    let line_or_datagrams =
        ["wire-insert", "wire-drop", "wire-truncate", "wire-checksum", "wire-coalesce"];
    let line = ["wire-split", "serial-break", "serial-framing"];
    match medium {
        _ if kind.acts != Acts::Wire => false,
        Medium::Line => !kind.name.starts_with("can-"),
        Medium::Datagrams => !kind.name.starts_with("can-") && !line.contains(&kind.name),
        Medium::Bus => !line.contains(&kind.name) && !line_or_datagrams.contains(&kind.name),
    }
}
