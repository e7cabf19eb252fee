//! Functional Mock-up Units of others: opened, read, loaded and stepped.
//!
//! | module | idea |
//! |---|---|
//! | [`archive`] | files of others opened and unpacked safely |
//! | [`description`] | what a `modelDescription.xml` says, of both standards in one form |
//! | `exchange` | model exchange as co-simulation, with our solver |
//! | [`library`] | the shared library of an unpacked FMU |
//! | [`instance`] | an FMU that runs, of both standards and both kinds, behind one trait |
//! | [`process`] | an FMU in a process of its own |

pub mod archive;
pub mod description;
mod exchange;
pub mod instance;
pub mod library;
pub mod process;

pub use instance::open::{OpenError, open, open_archive};
