//! What a run leaves behind as evidence: its folder, written in one piece, and the manifest.

pub mod folder;
pub mod manifest;

pub use folder::{Existing, FolderError, RunFolder};
pub use manifest::{Manifest, ManifestError, RunFacts};
