//! The kinds of faults, one family a folder.

mod added;
mod aiding;
mod analogue;
mod channel;
mod digital;
pub mod host;
mod mapped;
mod parameters;
mod physics;
mod plant;
mod ring_laser;
mod supply;
mod time;
mod turntable;
pub mod unit;
pub mod wire;

use crate::catalogue::FaultKind;

/// All kinds, in the order of the documentation.
pub static KINDS: &[&[&FaultKind]] = &[
    physics::KINDS,
    analogue::KINDS,
    ring_laser::KINDS,
    digital::KINDS,
    time::KINDS,
    turntable::KINDS,
    unit::KINDS,
    aiding::KINDS,
    wire::KINDS,
    host::KINDS,
    supply::KINDS,
];

/// Iterates over all kinds.
pub fn all() -> impl Iterator<Item = &'static FaultKind> {
    KINDS.iter().flat_map(|family| family.iter().copied())
}

/// Finds a kind by its name.
#[must_use]
pub fn named(name: &str) -> Option<&'static FaultKind> {
    all().find(|kind| kind.name == name)
}
