//! Functional Mock-up Units: ours made, anybody's checked, loaded and stepped.
//!
//! | module | idea |
//! |---|---|
//! | [`build`] | our own FMUs, from their tables |
//! | [`archive`] | files of others opened and unpacked safely |
//! | [`check`] | what is wrong with an FMU, by the rules of the standards |
//! | [`description`] | what a `modelDescription.xml` says, of both standards in one form |
//! | `exchange` | model exchange as co-simulation, with our solver |
//! | [`library`] | the shared library of an unpacked FMU |
//! | [`mapping`] | which of its variables is what |
//! | [`instance`] | an FMU that runs, of both standards and both kinds, behind one trait |
//! | [`process`] | an FMU in a process of its own |
//! | [`run`] | any FMU stepped with inputs from a file |
//! | [`master`] | several FMUs together: system structures, order, loops, faults on connections |

pub mod archive;
pub mod build;
pub mod check;
pub mod description;
mod exchange;
pub mod instance;
pub mod library;
pub mod mapping;
pub mod master;
pub mod process;
pub mod run;

pub use instance::open::{OpenError, open, open_archive};
