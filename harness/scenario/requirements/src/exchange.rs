//! Files of requirements, read and written by the format that their name tells.

use crate::encoding::decode;
use crate::error::{ExportError, Imported};
use crate::format::ExchangeFormat;
use crate::losses::losses;
use crate::mapping::{self, Mapping};
use crate::{needs, reqif, sdoc, xhtml};
use octant_verdict::RequirementsError;
use octant_verdict::file::{self, Checker};
use octant_verdict::requirement::Limit;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// Most bytes of a file that is read.
const BYTES: u64 = 512 << 20;

/// Accepts every measure and every limit: for moving requirements between formats.
#[derive(Clone, Copy, Debug)]
pub struct Anything;

impl Checker for Anything {
    fn measure(&self, _: &str) -> Result<(), String> {
        Ok(())
    }

    fn limit(&self, _: &str, _: &Limit) -> Result<(), String> {
        Ok(())
    }

    fn formatted(&self, xhtml: &str) -> Result<(), String> {
        xhtml::check(xhtml).map_err(|error| error.to_string())
    }
}

/// Reason why requirements can't be read or written.
#[derive(Debug, thiserror::Error)]
pub enum ExchangeError {
    /// The name tells no format.
    #[error("{}: expected a file that ends in .toml, .sdoc, .reqif, .reqifz or .json (needs.json), or a folder of Doorstop", path.display())]
    Format {
        /// The file.
        path: PathBuf,
    },
    /// A mapping was given for a format that has names of its own.
    #[error("{}: a mapping is for .reqif, .reqifz, needs.json and Doorstop: this format has Octant's names", path.display())]
    Mapping {
        /// The file.
        path: PathBuf,
    },
    /// The format is a feature that this program was built without.
    #[error("{}: a folder of Doorstop takes a program with the feature \"doorstop\": cargo build --features doorstop", path.display())]
    NotBuilt {
        /// The folder.
        path: PathBuf,
    },
    /// A folder has items that the new document doesn't have.
    #[error("failed to write {}: the folder has items that the new document doesn't have: {items}; remove them first", path.display())]
    Stale {
        /// The folder.
        path: PathBuf,
        /// Names of their files.
        items: String,
    },
    /// The file can't be read.
    #[error("failed to read {}: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Reason.
        error: io::Error,
    },
    /// The file can't be written.
    #[error("failed to write {}: {error}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Reason.
        error: io::Error,
    },
    /// The file exists already.
    #[error("failed to write {}: the file exists already; --force overwrites it", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The content is invalid.
    #[error(transparent)]
    Requirements(#[from] RequirementsError),
    /// An archive is invalid.
    #[error(transparent)]
    Archive(#[from] reqif::ReqIfArchiveError),
    /// The format can't hold the requirements.
    #[error(transparent)]
    Export(#[from] ExportError),
}

/// Format that the name of a file tells.
///
/// # Errors
/// If it tells none.
pub fn format_of(path: &Path) -> Result<ExchangeFormat, ExchangeError> {
    ExchangeFormat::of(path).ok_or_else(|| ExchangeError::Format { path: path.to_owned() })
}

fn bytes(path: &Path) -> Result<Vec<u8>, ExchangeError> {
    let read = || {
        let file = std::fs::File::open(path)?;
        if file.metadata()?.len() > BYTES {
            let message = format!("it has more than {} MiB", BYTES >> 20);
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
        }
        let mut bytes = Vec::new();
        io::Read::read_to_end(&mut io::Read::take(file, BYTES), &mut bytes)?;
        Ok(bytes)
    };
    read().map_err(|error| ExchangeError::Read { path: path.to_owned(), error })
}

/// Reads a mapping file.
///
/// # Errors
/// If it can't be read or isn't valid.
pub fn read_mapping(path: &Path) -> Result<Mapping, ExchangeError> {
    let name = path.display().to_string();
    Ok(mapping::read(&decode(&bytes(path)?, &name)?, &name)?)
}

/// Reads the requirements of a file, in the format that its name tells.
///
/// The account counts each object of the document. One that can't be read and could have been a requirement is a doubt,
/// and the others are read.
///
/// # Errors
/// If it can't be read, isn't valid, or has names for its attributes that a mapping doesn't fit.
pub fn read(
    path: &Path,
    mapping: Option<&Mapping>,
    checker: &dyn Checker,
) -> Result<Imported, ExchangeError> {
    let format = format_of(path)?;
    if mapping.is_some() && !format.is_mapped() {
        return Err(ExchangeError::Mapping { path: path.to_owned() });
    }
    let usual = Mapping::default();
    let mapping = mapping.unwrap_or(&usual);
    let name = path.display().to_string();
    if format == ExchangeFormat::Doorstop {
        return folder::read(path, mapping);
    }
    let bytes = bytes(path)?;
    if format == ExchangeFormat::ReqIfArchive {
        return Ok(reqif::read_archive(&bytes, &name, mapping)?);
    }
    let text = decode(&bytes, &name)?;
    Ok(match format {
        ExchangeFormat::Toml => Imported::own(file::read(&text, &name, checker)?, &name),
        ExchangeFormat::StrictDoc => sdoc::read(&text, &name)?,
        ExchangeFormat::Needs => needs::read(&text, &name, mapping)?,
        _ => reqif::read_mapped(&text, &name, mapping)?,
    })
}

/// Writes requirements in the format that the name of the file tells, and returns the parts that it
/// can't keep. `time` is that of the export, `2026-01-31T12:00:00Z`.
///
/// # Errors
/// If the file exists and `force` is false, it can't be written, or the format can't hold a part that
/// can't be left out.
pub fn write(
    path: &Path,
    imported: &Imported,
    time: &str,
    force: bool,
) -> Result<Vec<String>, ExchangeError> {
    let format = format_of(path)?;
    let requirements = &imported.requirements;
    let bytes = match format {
        ExchangeFormat::Toml => toml(imported).into_bytes(),
        ExchangeFormat::StrictDoc => sdoc::write(requirements)?.into_bytes(),
        ExchangeFormat::ReqIf => reqif::write(requirements, time)?.into_bytes(),
        ExchangeFormat::ReqIfArchive => {
            reqif::write_archive(requirements, &imported.attachments, time)?
        }
        ExchangeFormat::Needs => needs::write(requirements, time)?.into_bytes(),
        ExchangeFormat::Doorstop => {
            folder::write(path, requirements, force)?;
            return Ok(losses(imported, format));
        }
    };
    store(path, &bytes, force)?;
    Ok(losses(imported, format))
}

/// Writes a `requirements.toml` with the account of the document that it was converted from.
fn toml(imported: &Imported) -> String {
    let mut requirements = imported.requirements.clone();
    if !imported.is_own() {
        requirements.accounts.push(imported.account.clone());
    }
    file::write(&requirements)
}

fn store(path: &Path, bytes: &[u8], force: bool) -> Result<(), ExchangeError> {
    let mut options = std::fs::OpenOptions::new();
    options.write(true);
    if force {
        options.create(true).truncate(true);
    } else {
        options.create_new(true);
    }
    let written = options.open(path).and_then(|mut file| file.write_all(bytes));
    written.map_err(|error| match error.kind() {
        io::ErrorKind::AlreadyExists => ExchangeError::Exists { path: path.to_owned() },
        _ => ExchangeError::Write { path: path.to_owned(), error },
    })
}

/// Folders of Doorstop.
#[cfg(feature = "doorstop")]
mod folder {
    use super::{ExchangeError, bytes, store};
    use crate::doorstop;
    use crate::encoding::decode;
    use crate::error::{Imported, Note, listed};
    use crate::mapping::Mapping;
    use octant_verdict::requirement::Requirements;
    use std::io;
    use std::path::Path;

    /// Names of the files and folders in a folder, sorted.
    fn names(path: &Path) -> io::Result<Vec<String>> {
        let mut names = Vec::new();
        for entry in std::fs::read_dir(path)? {
            names.push(entry?.file_name().to_string_lossy().into_owned());
        }
        names.sort();
        Ok(names)
    }

    fn is_item(name: &str) -> bool {
        !name.starts_with('.') && (name.ends_with(".yml") || name.ends_with(".yaml"))
    }

    fn is_markdown(name: &str) -> bool {
        !name.starts_with('.') && name.ends_with(".md")
    }

    pub(super) fn read(path: &Path, mapping: &Mapping) -> Result<Imported, ExchangeError> {
        let failed = |error| ExchangeError::Read { path: path.to_owned(), error };
        let (mut files, mut notes) = (Vec::new(), Vec::new());
        for name in names(path).map_err(failed)? {
            let file = path.join(&name);
            if is_item(&name) || is_markdown(&name) || name == ".doorstop.yml" {
                let text = decode(&bytes(&file)?, &file.display().to_string())?;
                files.push((name, text));
            } else if file.join(".doorstop.yml").exists() {
                notes.push(Note::new(0, format!("the document in {name} is not read")));
            }
        }
        let mut imported = doorstop::read(&files, &path.display().to_string(), mapping)?;
        imported.notes.extend(notes);
        Ok(imported)
    }

    pub(super) fn write(
        path: &Path,
        requirements: &Requirements,
        force: bool,
    ) -> Result<(), ExchangeError> {
        let files = doorstop::write(requirements)?;
        let failed = |error| ExchangeError::Write { path: path.to_owned(), error };
        if path.exists() {
            let names = names(path).map_err(failed)?;
            if !force && !names.is_empty() {
                return Err(ExchangeError::Exists { path: path.to_owned() });
            }
            let stale =
                |name: &&String| is_item(name) && !files.iter().any(|(new, _)| new == *name);
            let stale: Vec<&String> = names.iter().filter(stale).collect();
            if !stale.is_empty() {
                let items = listed(&stale);
                return Err(ExchangeError::Stale { path: path.to_owned(), items });
            }
        }
        std::fs::create_dir_all(path).map_err(failed)?;
        for (name, text) in &files {
            store(&path.join(name), text.as_bytes(), force)?;
        }
        Ok(())
    }
}

/// Folders of Doorstop, in a program without them.
#[cfg(not(feature = "doorstop"))]
mod folder {
    use super::ExchangeError;
    use crate::error::Imported;
    use crate::mapping::Mapping;
    use octant_verdict::requirement::Requirements;
    use std::path::Path;

    pub(super) fn read(path: &Path, _: &Mapping) -> Result<Imported, ExchangeError> {
        Err(ExchangeError::NotBuilt { path: path.to_owned() })
    }

    pub(super) fn write(path: &Path, _: &Requirements, _: bool) -> Result<(), ExchangeError> {
        Err(ExchangeError::NotBuilt { path: path.to_owned() })
    }
}
