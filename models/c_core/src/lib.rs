//! The calibration core for programs in C. The interface is `include/octant_core.h`; this is what it calls.
//!
//! | module | idea |
//! |---|---|
//! | [`types`] | the structures of the header, field by field |
//! | [`config`] | a core's configuration from its structure, and back |
//! | [`status`] | the codes that the functions return, and their texts |
//! | [`functions`] | the functions |
//! | `text` | text in memory of the caller |
//!
//! The core lives in memory of the caller. Nothing here allocates, but the functions of the feature `state`; nothing
//! unwinds into C: a panic, which would be a bug, ends the program.

pub mod config;
pub mod functions;
pub mod status;
pub mod types;
