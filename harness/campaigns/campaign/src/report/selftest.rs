//! Reads `selftest.json` in the folder of a campaign: the result of the program's self-test.

use octant_base::not_finite;
use octant_verdict::Verdict;
use serde::Deserialize;
use std::path::Path;

/// Name of the file.
pub const FILE_NAME: &str = "selftest.json";
const SCHEMA: u32 = 1;

/// Result of the self-test.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct SelfTest {
    /// Overall verdict.
    pub verdict: Verdict,
    /// SHA-256 of the program that was tested.
    #[serde(default)]
    pub program_sha256: Option<String>,
    /// Time of the self-test, UTC.
    #[serde(default)]
    pub at: Option<String>,
}

#[derive(Deserialize)]
struct Version {
    schema: u32,
}

/// Reads the result; `None` if there is none.
///
/// # Errors
/// The reason, as text.
pub(super) fn read(folder: &Path) -> Result<Option<SelfTest>, String> {
    let path = folder.join(FILE_NAME);
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(format!("{FILE_NAME} can't be read: {error}")),
    };
    let wrong =
        |error: serde_json::Error| format!("{FILE_NAME} is no result of a self-test: {error}");
    let version: Version = serde_json::from_str(&text).map_err(wrong)?;
    if version.schema != SCHEMA {
        return Err(format!(
            "{FILE_NAME} is of version {}, this program reads version {SCHEMA}",
            version.schema
        ));
    }
    not_finite::from_str(&text).map(Some).map_err(wrong)
}
