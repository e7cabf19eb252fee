//! What a manifest says about the recordings that a run took its samples from.

use super::sha256;
use octant_scenario::{FileName, Scenario, Source};
use serde::{Deserialize, Serialize};

/// A recording that samples came from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct InputFacts {
    /// The file.
    pub file: String,
    /// Its SHA-256, hexadecimal.
    pub sha256: String,
}

/// The recordings of a scenario, hashed as they lie there before the run.
///
/// # Errors
/// In words, if one can't be read.
pub fn inputs(scenario: &Scenario) -> Result<Vec<InputFacts>, String> {
    let names: Vec<FileName> = match &scenario.source {
        Source::Replay { file, .. } => vec![file.clone()],
        Source::Text(mapping) => {
            mapping.files.all().map(|path| FileName(path.display().to_string())).collect()
        }
        Source::Plant | Source::Fmu(_) | Source::Live(_) => Vec::new(),
    };
    let one = |name: FileName| {
        let path = name.path(&scenario.folder)?;
        let file = path.display().to_string();
        match sha256(&path) {
            Ok(sha256) => Ok(InputFacts { file, sha256 }),
            Err(error) => Err(format!("read {file}: {error}")),
        }
    };
    names.into_iter().map(one).collect()
}
