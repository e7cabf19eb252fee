//! Data with which an instance is made.

use super::super::description::{Description, Interface};
use super::InstanceError;
use super::call::{Base, Condition, Mark};
use super::message::Log;
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Data with which an instance is made.
pub(crate) struct Setup {
    pub(crate) name: String,
    pub(crate) description: Arc<Description>,
    pub(crate) interface: Interface,
    pub(crate) folder: PathBuf,
    pub(crate) instance_name: String,
    pub(crate) log: bool,
    pub(crate) event_mode: bool,
    pub(crate) early_return: bool,
    pub(crate) time_limit: Duration,
    pub(crate) mark: Mark,
}

impl Setup {
    /// Makes the common part of an instance.
    pub(super) fn base(&self, log: &Arc<Log>) -> Base {
        Base {
            name: self.name.clone(),
            description: Arc::clone(&self.description),
            log: Arc::clone(log),
            mark: self.mark,
            condition: Condition::Sound,
        }
    }

    /// Folder of resources in the form of FMI 2.0: a URI.
    pub(super) fn resource_uri(&self) -> String {
        uri(&self.folder.join("resources"))
    }

    /// Folder of resources in the form of FMI 3.0: a path with a separator at its end.
    pub(super) fn resource_path(&self) -> Result<CString, InstanceError> {
        let mut path = self.folder.join("resources").into_os_string();
        path.push(std::path::MAIN_SEPARATOR_STR);
        CString::new(path.into_encoded_bytes())
            .map_err(|_| InstanceError::load(&self.name, "its folder has a null byte in its name"))
    }
}

/// Converts a path to a file URI.
fn uri(path: &Path) -> String {
    let mut uri = String::from("file://");
    let bytes = path.as_os_str().as_encoded_bytes();
    if !bytes.starts_with(b"/") {
        uri.push('/');
    }
    for byte in bytes {
        match byte {
            b'\\' if cfg!(windows) => uri.push('/'),
            b'/' | b'-' | b'.' | b'_' | b'~' | b':' => uri.push(char::from(*byte)),
            letter if letter.is_ascii_alphanumeric() => uri.push(char::from(*letter)),
            other => uri.push_str(&format!("%{other:02X}")),
        }
    }
    uri
}

/// Converts a text to a C string.
pub(super) fn c_text(fmu: &str, what: &str, value: &str) -> Result<CString, InstanceError> {
    CString::new(value).map_err(|_| {
        InstanceError::unsupported(fmu, format!("pass {what} {value:?}"), "it has a null byte")
    })
}

#[cfg(test)]
mod tests {
    use super::uri;
    use std::path::Path;

    #[cfg(unix)]
    #[test]
    fn paths_become_uris() {
        assert_eq!(uri(Path::new("/tmp/a b/ü#%/x")), "file:///tmp/a%20b/%C3%BC%23%25/x");
    }
}
