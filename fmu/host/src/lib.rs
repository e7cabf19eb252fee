//! Import of Functional Mock-up Units: opening, reading, loading and stepping.
//!
//! | module | idea |
//! |---|---|
//! | [`archive`] | foreign files opened and unpacked safely |
//! | [`description`] | content of a `modelDescription.xml`, of both standards in one form |
//! | `exchange` | model exchange as co-simulation, with Octant's solver |
//! | [`library`] | the shared library of an unpacked FMU |
//! | [`instance`] | a running FMU, of both standards and both kinds, behind one trait |
//! | [`OpenedFmu`] | an FMU opened once, for its hash, its description and all its instances |
//! | [`process`] | an FMU in a process of its own |

pub mod archive;
pub mod description;
#[cfg(feature = "model-exchange")]
mod exchange;
pub mod instance;
pub mod library;
mod opened;
pub mod process;

pub use instance::open::{FmuOpenError, open, open_archive};
pub use opened::OpenedFmu;

// The tests name the crate as its users do. They are a part of its one test program.
#[cfg(test)]
extern crate self as octant_fmu_host;
#[cfg(test)]
#[path = "../tests/main.rs"]
mod tests;
