//! Evidence of a run: its folder, written atomically, the manifest, its signature, and the
//! discrepancies with their dispositions.

pub mod attestation;
pub mod build;
pub mod discrepancy;
pub mod disposition;
pub mod ended;
mod error;
mod facts;
pub mod files;
mod fmus;
pub mod folder;
mod host;
mod inputs;
pub mod leftover;
pub mod maker;
pub mod manifest;
pub mod planned;
mod program;
pub mod signature;
pub mod statements;

pub use fmus::{FmuFactsError, fmus};
pub use folder::LOCK;
pub use folder::{Existing, FolderError, RunFolder};
pub use inputs::{InputFacts, InputHashError, inputs};
pub use manifest::{FmuFacts, Manifest, ManifestError, RunFacts};
