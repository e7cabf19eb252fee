//! Folder of a system structure: a plain folder, or unpacked from an `.ssp`.

use super::SspError;
use super::xml::SspWarnings;
use octant_fmu_host::archive::{Archive, Unpacked};
use std::cell::RefCell;
use std::path::{Path, PathBuf};

/// File name of the structure in a package.
pub const STRUCTURE: &str = "SystemStructure.ssd";

/// Maximum size of a file of a structure, bytes.
const TEXT_MAX: u64 = 256 << 20;

/// Reason why a source is no file of a package.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PackageSourceError {
    /// It is a part of another file.
    #[error(
        "found the source {found:?}, expected a file of the package: parts of other files are not part of this version"
    )]
    Part {
        /// Source found.
        found: String,
    },
    /// Its percent signs are wrong.
    #[error("the source {found:?} was found, whose % signs are not those of a URI")]
    Percent {
        /// Source found.
        found: String,
    },
    /// It isn't a relative path.
    #[error(
        "the source {found:?} was found, expected a file of the package, such as \
         \"resources/plant.fmu\""
    )]
    Elsewhere {
        /// Source found.
        found: String,
    },
    /// It leads out of the package.
    #[error(
        "the source {found:?} was found, which leads out of the package; expected a file of the \
         package, such as \"resources/plant.fmu\""
    )]
    Outside {
        /// Source found.
        found: String,
    },
    /// The file is missing.
    #[error("found the source {found:?}, expected a file of {package}: there is none of this name")]
    Missing {
        /// Source found.
        found: String,
        /// Name of the package.
        package: String,
    },
}

/// A folder with a system structure.
#[derive(Debug)]
pub struct Package {
    /// Name as the user gave it.
    name: String,
    folder: PathBuf,
    structure: PathBuf,
    /// Warnings about its files.
    pub(super) warnings: SspWarnings,
    /// True if the structure is a file that the user named, whose sources are files on disk.
    is_loose: bool,
    /// Packages within it that were unpacked.
    nested: RefCell<Vec<Self>>,
    /// Temporary folder, removed with the package.
    _unpacked: Option<Unpacked>,
}

/// Returns whether a path given to `octant run` is a system structure and not a scenario.
#[must_use]
pub fn is_system(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    matches!(extension.as_deref(), Some("ssp" | "ssd"))
        || (path.is_dir() && path.join(STRUCTURE).is_file())
}

impl Package {
    /// Opens an `.ssp`, an `.ssd`, or a folder with a `SystemStructure.ssd`.
    ///
    /// # Errors
    /// If there is none, or an archive is damaged or hostile.
    pub fn open(path: &Path) -> Result<Self, SspError> {
        let name = path.display().to_string();
        let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        let is_loose = !path.is_dir();
        let (folder, structure) = if path.is_dir() {
            (path.to_owned(), path.join(STRUCTURE))
        } else if extension.as_deref() == Some("ssd") {
            let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
            (folder.unwrap_or(Path::new(".")).to_owned(), path.to_owned())
        } else {
            return Self::unpack(path, name);
        };
        if !structure.is_file() {
            let message = format!("failed to find {STRUCTURE} in it");
            return Err(SspError::of_file(&name, message));
        }
        Ok(Self {
            name,
            folder,
            structure,
            warnings: SspWarnings::default(),
            is_loose,
            nested: RefCell::default(),
            _unpacked: None,
        })
    }

    fn unpack(path: &Path, name: String) -> Result<Self, SspError> {
        // These errors name the file already.
        let failed = |error: octant_fmu_host::archive::ArchiveError| {
            let text = error.to_string();
            let message = text.strip_prefix(&format!("{name}: ")).unwrap_or(&text).to_owned();
            SspError::of_file(&name, message)
        };
        let unpacked = Archive::open(path).and_then(|mut archive| archive.unpack());
        let unpacked = unpacked.map_err(failed)?;
        let folder = unpacked.path().to_owned();
        let structure = folder.join(STRUCTURE);
        if !structure.is_file() {
            let message = format!("failed to find {STRUCTURE} in it");
            return Err(SspError::of_file(&name, message));
        }
        Ok(Self {
            name,
            folder,
            structure,
            warnings: SspWarnings::default(),
            is_loose: false,
            nested: RefCell::default(),
            _unpacked: Some(unpacked),
        })
    }

    /// Returns the path of the `.ssd`.
    #[must_use]
    pub fn structure(&self) -> &Path {
        &self.structure
    }

    /// Returns the name of a package's file for messages.
    #[must_use]
    pub fn name_of(&self, file: &Path) -> String {
        match file.strip_prefix(&self.folder) {
            // The user named this very file.
            Ok(_) if self.structure == file && self.name.ends_with(".ssd") => self.name.clone(),
            // Beside a structure that is a file there are files, and no folder of its name.
            Ok(_) if self.is_loose => file.display().to_string(),
            Ok(inner) => format!("{}/{}", self.name, inner.display()),
            Err(_) => file.display().to_string(),
        }
    }

    /// Reads the text of a file.
    ///
    /// # Errors
    /// If it can't be read, isn't UTF-8, or is larger than any structure.
    pub fn text_of(&self, file: &Path) -> Result<String, SspError> {
        let name = self.name_of(file);
        let failed =
            |error: std::io::Error| SspError::of_file(&name, format!("failed to read it: {error}"));
        let bytes = std::fs::metadata(file).map_err(failed)?.len();
        if bytes > TEXT_MAX {
            let message = format!("it has {bytes} bytes, at most {TEXT_MAX} are read");
            return Err(SspError::of_file(&name, message));
        }
        let mut text = std::fs::read_to_string(file).map_err(failed)?;
        if text.starts_with('\u{feff}') {
            text.drain(..'\u{feff}'.len_utf8());
        }
        Ok(text)
    }

    /// Opens a part of this package that is a system of its own: an `.ssd`, or another package.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub(super) fn open_part(&self, path: &Path, is_package: bool) -> Result<Self, SspError> {
        let name = self.name_of(path);
        if is_package {
            return Self::unpack(path, name);
        }
        let folder = path.parent().unwrap_or(&self.folder).to_owned();
        Ok(Self {
            name,
            folder,
            structure: path.to_owned(),
            warnings: SspWarnings::default(),
            is_loose: self.is_loose,
            nested: RefCell::default(),
            _unpacked: None,
        })
    }

    /// Keeps a part for as long as this package.
    pub(super) fn keep(&self, part: Self) {
        self.nested.borrow_mut().push(part);
    }

    /// Finds the file to which a source of the structure refers.
    ///
    /// # Errors
    /// If it isn't a file within the package.
    pub fn resolve(&self, source: &str) -> Result<PathBuf, PackageSourceError> {
        let found = || source.to_owned();
        if source.contains('#') {
            return Err(PackageSourceError::Part { found: found() });
        }
        let decoded = percent_decoded(source)
            .ok_or_else(|| PackageSourceError::Percent { found: found() })?;
        let has_scheme = decoded.split_once(':').is_some_and(|(scheme, _)| !scheme.contains('/'));
        if has_scheme || decoded.starts_with('/') || decoded.contains('\\') {
            return Err(PackageSourceError::Elsewhere { found: found() });
        }
        let mut path = self.folder.clone();
        // `./resources/x.fmu` and `resources//x.fmu` are the same file.
        for part in decoded.split('/').filter(|part| !part.is_empty() && *part != ".") {
            if part == ".." {
                // A file beside a structure that is a file is the user's own; an archive has no other.
                if !self.is_loose {
                    return Err(PackageSourceError::Outside { found: found() });
                }
                path.push(part);
                continue;
            }
            path.push(part);
        }
        if !path.is_file() {
            return Err(PackageSourceError::Missing { found: found(), package: self.name.clone() });
        }
        Ok(path)
    }
}

/// Decodes `%20` and the like.
fn percent_decoded(text: &str) -> Option<String> {
    if !text.contains('%') {
        return Some(text.to_owned());
    }
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        if *first == b'%' {
            let digits = std::str::from_utf8(after.get(..2)?).ok()?;
            bytes.push(u8::from_str_radix(digits, 16).ok()?);
            rest = &after[2..];
        } else {
            bytes.push(*first);
            rest = after;
        }
    }
    String::from_utf8(bytes).ok()
}
