//! What a run leaves behind as evidence: its folder, written in one piece, the manifest, its
//! signature, and what isn't a pass with what people say of it.

pub mod attestation;
pub mod discrepancy;
pub mod disposition;
pub(crate) mod files;
mod fmus;
pub mod folder;
mod inputs;
pub mod inside;
mod leftover;
pub mod manifest;
pub mod rejudge;
pub mod signature;

pub use fmus::fmus;
pub(crate) use fmus::sha256;
pub(crate) use folder::LOCK;
pub use folder::{Existing, FolderError, RunFolder};
pub use inputs::{InputFacts, inputs};
pub use manifest::{FmuFacts, Manifest, ManifestError, RunFacts};
