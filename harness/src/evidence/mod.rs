//! What a run leaves behind as evidence: its folder, written in one piece, the manifest, and
//! its signature.

mod fmus;
pub mod folder;
pub mod manifest;
pub mod signature;

pub use fmus::fmus;
pub(crate) use fmus::sha256;
pub(crate) use folder::LOCK;
pub use folder::{Existing, FolderError, RunFolder};
pub use manifest::{FmuFacts, Manifest, ManifestError, RunFacts};
