//! An FMU opened once: its file is read one time, whatever is asked of it and however many instances are made.

use super::archive::Archive;
use super::description::Description;
use super::instance::open::{name_of, open_unpacked, read_description};
use super::instance::{FmuOpenError, Instance, OpenOptions};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// An FMU with its hash and description; clones share the opening.
///
/// Instances are made from a copy that was taken at the opening, so the hash is that of the code that runs. Each
/// instance has an unpacked folder of its own: two in one process have then a library each, and don't share its
/// variables. An unpacked FMU in a folder has no hash, and its code is read where it is.
#[derive(Clone, Debug)]
pub struct OpenedFmu {
    name: String,
    description: Arc<Description>,
    sha256: Option<String>,
    archive: Arc<Mutex<Archive>>,
}

impl OpenedFmu {
    /// Opens an FMU, or a folder with its unpacked content.
    ///
    /// # Errors
    /// If its archive or description can't be used.
    pub fn open(path: &Path) -> Result<Self, FmuOpenError> {
        let (mut archive, sha256) = Archive::open_copy(path)?;
        let description = Arc::new(read_description(&mut archive)?);
        let name = name_of(archive.file());
        Ok(Self { name, description, sha256, archive: Arc::new(Mutex::new(archive)) })
    }

    /// Its description.
    #[must_use]
    pub const fn description(&self) -> &Arc<Description> {
        &self.description
    }

    /// SHA-256 of the file, hexadecimal; `None` for a folder.
    #[must_use]
    pub fn sha256(&self) -> Option<&str> {
        self.sha256.as_deref()
    }

    /// True if a process can hold only one instance of one of its interfaces.
    #[must_use]
    pub fn only_once_per_process(&self) -> bool {
        let interfaces = [&self.description.co_simulation, &self.description.model_exchange];
        interfaces.into_iter().flatten().any(|interface| interface.only_once_per_process)
    }

    /// Makes an instance.
    ///
    /// # Errors
    /// If it can't be unpacked, lacks the interface, its library can't be loaded, or it makes no instance.
    pub fn instance(&self, options: &OpenOptions) -> Result<Box<dyn Instance>, FmuOpenError> {
        let folder = {
            let mut archive = self.archive.lock().unwrap_or_else(PoisonError::into_inner);
            archive.unpack()?
        };
        Ok(open_unpacked(&self.name, folder, Arc::clone(&self.description), options)?)
    }
}
