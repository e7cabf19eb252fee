//! Decoders and encoders for the protocols of existing inertial units.
//!
//! Each protocol is a module, [`own`] that of this project's wire. Each has a decoder, which takes
//! bytes in pieces of any length, finds the frames among other bytes and counts everything that it
//! can't use, and an encoder, for tests and simulated instruments. All use the same [`Reading`], in SI
//! units: a value that a protocol doesn't send is `None`, not a guess. [`any`] lists the protocols and
//! chooses one by name.
//!
//! [`Sampler`] converts readings to [`octant_sample::Sample`]s: it turns the axes of the unit to those
//! of the body, counts increments and carries their remainders, and continues sequence and time across
//! roll-overs.
//!
//! [`timeline`] makes times and intervals of stamps, counters and a rate, for recordings and live units alike.
//!
//! [`align`] finds the offset between a unit's clock and the host's, from stamps and arrivals alone,
//! [`pulses`] from pulses at the unit's whole seconds.
//!
//! # Axes
//! A reading is in the axes of the unit, right-handed, as its maker marks them on the housing: a
//! rotation is positive by the right-hand rule, and the velocity is the integral of specific force, so
//! that a unit at rest with z down shows −g on z. If a protocol sends another order or sign (NovAtel:
//! z, −y, x), the codec corrects it. The mounting of the unit is set at the [`Sampler`] ([`Axes`]).
//!
//! [`navigation`] has the messages of units with a filter of their own: position, velocity, attitude.
//!
//! [`described`] is any other record protocol, by a description of its frames.
//!
//! Nothing in this crate allocates, waits or depends on a port, except two features of a host: with `dbc` any CAN
//! database is read, through a mapping of its signals; with `descriptions` descriptions are read from TOML.
#![no_std]

#[cfg(any(feature = "dbc", feature = "descriptions"))]
extern crate std;

pub mod align;
pub mod any;
pub mod checksum;
#[cfg(feature = "dbc")]
pub mod dbc;
pub mod described;
#[cfg(feature = "descriptions")]
pub mod description;
pub mod framing;
pub mod grades;
pub mod navigation;
pub mod novatel;
pub mod own;
pub mod pulses;
pub mod rollover;
pub mod sbg;
mod stamp_scale;
pub mod timeline;
pub mod vectornav;
pub mod xsens;

mod axes;
mod bytes;
mod carry;
mod encoding;
mod reading;
mod record_defect;
mod sampler;
#[cfg(any(feature = "dbc", feature = "descriptions"))]
mod units;

pub use any::{AnyDecoder, AnyEncoder, Protocol};
pub use axes::{Axes, AxesError};
pub use encoding::CannotCarry;
pub use framing::{FramingEvent, ProtocolFacts, ReadingCounters, ReadingDefect, UnreadBytes};
pub use reading::{MeasuredTriad, Reading, ReadingKind, Stamp, StampClock};
pub use record_defect::{FoundNumber, RecordDefect};
pub use sampler::{Sampler, SamplerCounters, SamplerSettings, Unusable};
pub use stamp_scale::{GPS_EPOCH_S, StampScale};
#[cfg(any(feature = "dbc", feature = "descriptions"))]
pub use units::unit_si;
