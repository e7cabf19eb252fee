//! The table of keys, which defines everything that can be written in a scenario, with dimension,
//! default and meaning.
//!
//! Check, defaults, error messages, the JSON Schema and the test of the tour all use it.

mod calibration;
mod campaign;
mod connection;
mod definition;
mod drive;
mod faults;
mod fmu;
mod instrument;
mod link;
mod run;
mod screening;
mod source;
mod suite;

pub use campaign::CAMPAIGN;
pub use connection::{CONNECTIONS, connection_section};
pub use definition::{Bounds, Default, Key, Kind, SCHEMA, Section, Tag, Variants};
pub(crate) use faults::{dimension, kind_section};
pub(crate) use fmu::{ENDPOINT_FMU, ENDPOINT_MAP, SOURCE_FMU, SOURCE_MAP};
pub(crate) use link::ENDPOINT_LINK;
pub(crate) use run::SCENARIO;
pub(crate) use source::SOURCE_LIVE;
pub(crate) use suite::SUITE;
