//! Files of a history: JSON with a version, written whole or not at all.

use super::error::NightError;
use octant_base::not_finite;
use serde::Deserialize;
use std::path::Path;

/// Reads versioned JSON; a newer version is reported as such.
pub(super) fn versioned<T: serde::de::DeserializeOwned>(
    path: &Path,
    text: &str,
    schema: u32,
    expected: &'static str,
) -> Result<T, NightError> {
    #[derive(Deserialize)]
    struct Version {
        schema: u32,
    }
    let wrong = |source| NightError::Form { path: path.to_owned(), expected, source };
    let version: Version = serde_json::from_str(text).map_err(wrong)?;
    if version.schema != schema {
        return Err(NightError::Version {
            path: path.to_owned(),
            found: version.schema,
            expected: schema,
        });
    }
    not_finite::from_str(text).map_err(wrong)
}

/// Writes a file: whole or not at all.
pub(super) fn write(path: &Path, text: &str) -> Result<(), NightError> {
    Ok(octant_selftest::record::write(path, text)?)
}
