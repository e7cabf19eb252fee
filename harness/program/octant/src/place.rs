//! Place of a campaign: a folder, or an address on object storage, of which a folder is made.

use crate::failure::Failure;
use std::path::{Path, PathBuf};

mod needs;
#[cfg(not(feature = "object-storage"))]
#[path = "place/no_object_storage.rs"]
mod object_storage;
#[cfg(feature = "object-storage")]
mod object_storage;

pub(crate) use needs::Needs;
pub(crate) use object_storage::{StoredCampaign, push, run_part};

/// Place of a campaign.
#[derive(Debug)]
pub(crate) enum CampaignPlace {
    /// A folder.
    Folder(PathBuf),
    /// Objects, and a folder that is made of them.
    Stored(Box<StoredCampaign>),
}

/// Returns the address that is given in place of a folder.
pub(crate) fn address(given: &Path) -> Option<&str> {
    given.to_str().filter(|text| text.contains("://"))
}

impl CampaignPlace {
    /// Finds a campaign, and fetches what a command needs of it.
    pub(crate) fn of(given: &Path, needs: Needs) -> Result<Self, Failure> {
        match address(given) {
            Some(text) => StoredCampaign::fetch(text, None, needs)
                .map(|stored| Self::Stored(Box::new(stored))),
            None => Ok(Self::Folder(given.to_owned())),
        }
    }

    /// Returns the folder.
    pub(crate) fn folder(&self) -> &Path {
        match self {
            Self::Folder(folder) => folder,
            Self::Stored(stored) => stored.folder(),
        }
    }

    /// Returns whether the folder is made of objects.
    pub(crate) fn is_stored(&self) -> bool {
        matches!(self, Self::Stored(_))
    }

    /// Names a file of the folder, or the folder, as the user finds it.
    pub(crate) fn shown(&self, file: &Path) -> String {
        match self {
            Self::Folder(_) => file.display().to_string(),
            Self::Stored(stored) => match file.strip_prefix(stored.folder()) {
                Ok(name) if name == Path::new("") => stored.address(),
                Ok(name) => format!("{}/{}", stored.address(), name.display()),
                Err(_) => file.display().to_string(),
            },
        }
    }

    /// Stores what a command has written into the folder.
    pub(crate) fn put_back(&mut self) -> Result<(), Failure> {
        match self {
            Self::Folder(_) => Ok(()),
            Self::Stored(stored) => stored.put_back(),
        }
    }
}
