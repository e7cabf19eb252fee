//! What a run leaves behind as evidence: its folder, written in one piece, and the manifest.

mod fmus;
pub mod folder;
pub mod manifest;

pub use fmus::fmus;
pub(crate) use fmus::sha256;
pub(crate) use folder::LOCK;
pub use folder::{Existing, FolderError, RunFolder};
pub use manifest::{FmuFacts, Manifest, ManifestError, RunFacts};
