//! Readings of inertial units that exist, from the bytes of their protocols, and back.
//!
//! Each protocol is a module: [`vectornav`], [`xsens`], [`novatel`], [`sbg`], and [`own`], the wire of
//! this project. Each has a decoder, which takes bytes in pieces of any length, finds the frames
//! among whatever else comes and counts what it could not use, and an encoder, for tests and for what
//! plays an instrument. All give and take the same [`Reading`], in SI units: what a protocol doesn't
//! tell is `None`, not a guess. [`any`] chooses one by name.
//!
//! [`Sampler`] makes [`octant_sample::Sample`]s of readings: the axes of the unit turned to those of
//! the body, increments counted with their remainders carried, sequence and time without roll-over.
//!
//! [`align`] finds how a unit's clock stands against the host's, from stamps and arrivals alone.
//!
//! # Axes
//! A reading is in the axes of the unit, right-handed, as its maker marks them on the housing: a
//! rotation is positive by the right-hand rule, and the velocity is the integral of specific force, so
//! that a unit at rest with z down shows −g on z. Where a protocol sends another order or sign (NovAtel:
//! z, −y, x) the codec has undone it. How the unit is mounted is said to the [`Sampler`] ([`Axes`]).
//!
//! Nothing here allocates, waits or knows a port, but for `dbc`: with the feature of that name
//! any CAN database is read on a host, through a mapping of its signals.
#![no_std]

#[cfg(feature = "dbc")]
extern crate std;

pub mod align;
pub mod any;
#[cfg(feature = "dbc")]
pub mod dbc;
pub mod framing;
pub mod novatel;
pub mod own;
pub mod sbg;
pub mod vectornav;
pub mod xsens;

mod axes;
mod bytes;
mod carry;
mod checksum;
mod encoding;
mod reading;
mod rollover;
mod sampler;

pub use any::{AnyDecoder, AnyEncoder, Protocol};
pub use axes::{Axes, AxesError};
pub use encoding::CannotCarry;
pub use framing::{Cause, Counters, Event, Lost};
pub use reading::{Clock, Kind, Measured, Reading, Stamp};
pub use sampler::{Sampler, SamplerCounters, Settings, Unusable};
