//! Differences between a folder and its manifest.

use super::names::LOCK;
use octant_operator::journal;

/// A difference between a folder and its manifest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FolderDifference {
    /// The manifest names a file that isn't there.
    Missing(String),
    /// A file isn't named in the manifest.
    Unknown(String),
    /// A file has another content.
    Changed(String),
    /// An empty folder isn't named in the manifest.
    EmptyFolder(String),
    /// An entry is neither a file nor a folder; the kind stands beside the path.
    NoFile(String, &'static str),
    /// The lock of a run in progress is there.
    Locked,
    /// Manifest and journal differ in the answers of a person.
    Answers,
}

impl std::fmt::Display for FolderDifference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Missing(path) => write!(f, "{path} is missing"),
            Self::Unknown(path) => write!(f, "{path} was added: the manifest doesn't name it"),
            Self::Changed(path) => write!(f, "{path} was changed"),
            Self::EmptyFolder(path) => {
                write!(f, "{path}/ was added: an empty folder that the manifest doesn't name")
            }
            Self::NoFile(path, what) => {
                write!(f, "{path} is {what}: evidence is regular files and folders")
            }
            Self::Locked => {
                write!(f, "{LOCK} is there: the run goes on, or a kill left it")
            }
            Self::Answers => {
                write!(
                    f,
                    "the manifest's answers of the operator aren't those of {}",
                    journal::FILE_NAME
                )
            }
        }
    }
}
