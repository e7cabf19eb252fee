//! Address of a campaign on object storage.

use super::error::StorageError;
use object_store::path::Path as ObjectPath;
use std::fmt;
use std::path::{Path, PathBuf};

/// Forms of an address, for messages.
const FORMS: &str = "s3://BUCKET/PREFIX or file:///FOLDER";

/// Address of a campaign: `s3://BUCKET/PREFIX`, or `file:///FOLDER`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StorageAddress {
    /// The address without a slash at its end.
    text: String,
    pub(crate) place: StoragePlace,
}

/// Place that an address names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum StoragePlace {
    /// A bucket of an S3-compatible service, and the beginning of the names in it.
    S3 { bucket: String, prefix: ObjectPath },
    /// A folder.
    Folder(PathBuf),
}

impl StorageAddress {
    /// Returns whether a text is an address, rather than the name of a folder.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        text.contains("://")
    }

    /// Parses an address.
    ///
    /// # Errors
    /// If it has another form.
    pub fn parse(text: &str) -> Result<Self, StorageError> {
        let wrong = |reason: String| StorageError::Address { found: text.to_owned(), reason };
        let (scheme, rest) =
            text.split_once("://").ok_or_else(|| wrong(format!("expected {FORMS}")))?;
        let trimmed = rest.trim_end_matches('/');
        let place = match scheme {
            "s3" => {
                let (bucket, prefix) = trimmed.split_once('/').unwrap_or((trimmed, ""));
                let fits = |c: char| c.is_ascii_alphanumeric() || "-._".contains(c);
                if bucket.is_empty() || !bucket.chars().all(fits) {
                    return Err(wrong(format!("found the bucket {bucket:?}, expected {FORMS}")));
                }
                let prefix = ObjectPath::parse(prefix).map_err(|error| wrong(error.to_string()))?;
                StoragePlace::S3 { bucket: bucket.to_owned(), prefix }
            }
            "file" if trimmed.starts_with('/') => StoragePlace::Folder(trimmed.into()),
            "file" => return Err(wrong("expected an absolute folder, file:///FOLDER".to_owned())),
            _ => return Err(wrong(format!("found the scheme {scheme:?}, expected {FORMS}"))),
        };
        Ok(Self { text: format!("{scheme}://{trimmed}"), place })
    }

    /// Returns the address of an object under this one.
    #[must_use]
    pub fn of(&self, name: &str) -> String {
        format!("{}/{name}", self.text)
    }

    /// Returns the folder that it names, if it is one.
    #[must_use]
    pub fn folder(&self) -> Option<&Path> {
        match &self.place {
            StoragePlace::Folder(folder) => Some(folder),
            StoragePlace::S3 { .. } => None,
        }
    }
}

impl fmt::Display for StorageAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}
