//! Names of files in a scenario.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// Environment variable that a file name may start with.
const VARIABLE: &str = "OCTANT_RECORDINGS";

/// A file name as written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileName(pub String);

/// Reason why a file name can't be expanded. The text fits after "failed to".
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FileNameError {
    /// It begins with another variable than the expected one.
    #[error("expand {name:?}: ${{{VARIABLE}}} is the one variable that file names can have")]
    Unknown {
        /// Name as written.
        name: String,
    },
    /// The variable isn't in the environment.
    #[error(
        "expand {name:?}: the environment variable {VARIABLE} is not set; set it to the folder of the \
         recordings"
    )]
    NotSet {
        /// Name as written.
        name: String,
    },
}

impl FileName {
    /// Name without the folder.
    #[must_use]
    pub fn short(&self) -> &str {
        self.0.rsplit(['/', '\\']).next().unwrap_or(&self.0)
    }

    /// Path of the file: relative to the scenario's folder, with `${OCTANT_RECORDINGS}` expanded.
    ///
    /// # Errors
    /// If the variable is used and not set, or another one is used.
    pub fn path(&self, folder: &Path) -> Result<PathBuf, FileNameError> {
        self.path_with(folder, std::env::var_os(VARIABLE))
    }

    fn path_with(
        &self,
        folder: &Path,
        recordings: Option<OsString>,
    ) -> Result<PathBuf, FileNameError> {
        let Some(rest) = self.0.strip_prefix("${") else { return Ok(folder.join(&self.0)) };
        let Some(rest) = rest.strip_prefix(VARIABLE).and_then(|rest| rest.strip_prefix('}')) else {
            return Err(FileNameError::Unknown { name: self.0.clone() });
        };
        match recordings {
            Some(value) => Ok(Path::new(&value).join(rest.trim_start_matches('/'))),
            None => Err(FileNameError::NotSet { name: self.0.clone() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_start_at_the_scenario_or_at_the_recordings() {
        let path = |name: &str, recordings: Option<&str>| {
            FileName(name.to_owned()).path_with(Path::new("/runs"), recordings.map(OsString::from))
        };
        assert_eq!(path("a.txt", None), Ok(PathBuf::from("/runs/a.txt")));
        assert_eq!(path("/b/a.txt", None), Ok(PathBuf::from("/b/a.txt")));
        let recorded = "${OCTANT_RECORDINGS}/x/a.txt";
        assert_eq!(path(recorded, Some("/data")), Ok(PathBuf::from("/data/x/a.txt")));
        assert!(
            path(recorded, None).unwrap_err().to_string().contains("OCTANT_RECORDINGS is not set")
        );
        let other = path("${HOME}/a.txt", Some("/data")).unwrap_err().to_string();
        assert!(other.contains("the one variable"), "{other}");
    }
}
