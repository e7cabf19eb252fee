//! Facts for the manifest about the recordings from which a run took its samples.

use octant_base::hash::sha256;
use octant_scenario::{FileName, Scenario};
use serde::{Deserialize, Serialize};

/// Recording from which samples came.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFacts {
    /// The file.
    pub file: String,
    /// SHA-256, hexadecimal.
    pub sha256: String,
    /// Words for the times of samples whose file has none; omitted where it has them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
}

/// Reason why a recording can't be hashed.
#[derive(Debug, thiserror::Error)]
pub enum InputHashError {
    /// The name of the file can't be expanded.
    #[error("{reason}")]
    Name {
        /// Name found, and what is expected.
        reason: String,
    },
    /// The file can't be read.
    #[error("read {file}: {error}")]
    Read {
        /// The file.
        file: String,
        /// Error of the operating system.
        error: std::io::Error,
    },
}

/// Hashes the recordings of a scenario before the run.
///
/// # Errors
/// If one can't be read.
pub fn inputs(scenario: &Scenario) -> Result<Vec<InputFacts>, InputHashError> {
    let time = scenario.source.assumed_time();
    let one = |name: FileName, time: Option<String>| {
        let path = name
            .path(&scenario.folder)
            .map_err(|reason| InputHashError::Name { reason: reason.to_string() })?;
        let file = path.display().to_string();
        match sha256(&path) {
            Ok(sha256) => Ok(InputFacts { file, sha256, time }),
            Err(error) => Err(InputHashError::Read { file, error }),
        }
    };
    let reference = scenario.reference.as_ref().and_then(|reference| reference.own_file());
    let reference = reference.map(|file| FileName(file.display().to_string()));
    let samples = scenario.source.recordings().into_iter().map(|name| one(name, time.clone()));
    samples.chain(reference.into_iter().map(|name| one(name, None))).collect()
}
