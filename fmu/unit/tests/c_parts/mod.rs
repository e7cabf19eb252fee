//! Parts of the C interface that the library keeps to itself. Their files are compiled into this program once
//! more, so that nothing of the library has to be public for its tests.
#![allow(dead_code, unreachable_pub, reason = "the library uses the rest")]

#[path = "../../src/c/layout.rs"]
mod layout;
mod layouts;
#[path = "../../src/c/log.rs"]
mod log;
mod logs;
mod registries;
#[path = "../../src/c/registry.rs"]
mod registry;
#[path = "../../src/c/room.rs"]
mod room;
mod rooms;

/// Neighbour of `log` that it imports.
mod mode {
    pub(super) use octant_fmu::c::ServedStandard;
}
