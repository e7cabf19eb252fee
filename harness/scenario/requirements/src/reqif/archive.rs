//! `.reqifz`: a ZIP archive with one or several ReqIF files, and the pictures of their texts.
//!
//! Nothing of an archive is written to the disk. Its bytes are counted as they are unpacked, so that the
//! sizes that it states don't matter.

use super::read::read_all;
use crate::encoding::decode;
use crate::error::{Attachment, ExportError, Imported, Note};
use crate::mapping::Mapping;
use octant_verdict::RequirementsError;
use octant_verdict::requirement::Requirements;
use std::collections::HashSet;
use std::io::{Cursor, Read as _, Write as _};
use zip::ZipArchive;
use zip::result::ZipError;
use zip::write::{SimpleFileOptions, ZipWriter};

/// Most entries of an archive.
const ENTRIES: usize = 10_000;
/// Most unpacked bytes of an archive.
const BYTES: u64 = 512 << 20;
/// Extension of a ReqIF file.
const REQIF: &str = ".reqif";

/// Reason why an archive can't be read.
#[derive(Debug, thiserror::Error)]
pub enum ReqIfArchiveError {
    /// The file is no ZIP archive, or it is damaged.
    #[error("{archive}: not a readable ZIP archive: {reason}")]
    Zip {
        /// The archive.
        archive: String,
        /// Reason, in plain words.
        reason: String,
    },
    /// A limit is exceeded.
    #[error("{archive}: {what}, and the limit is {limit}")]
    Limit {
        /// The archive.
        archive: String,
        /// What exceeds it.
        what: String,
        /// The limit.
        limit: String,
    },
    /// An entry has a name that leads out of the archive.
    #[error("{archive}: the entry {entry:?} leads out of the archive: it is refused")]
    Path {
        /// The archive.
        archive: String,
        /// Name of the entry.
        entry: String,
    },
    /// There is no ReqIF file in it.
    #[error("{archive}: there is no file that ends in .reqif in the archive, found {found}")]
    Empty {
        /// The archive.
        archive: String,
        /// Entries found.
        found: String,
    },
    /// Its content is no valid ReqIF.
    #[error(transparent)]
    Requirements(#[from] RequirementsError),
}

/// Reads the bytes of a `.reqifz`: all ReqIF files together, and the files that their texts show.
///
/// # Errors
/// If the bytes are no archive, it exceeds the limits, a name leads out of it, or a ReqIF file in it is
/// invalid.
pub fn read(bytes: &[u8], archive: &str, mapping: &Mapping) -> Result<Imported, ReqIfArchiveError> {
    let (mut files, mut attachments) = (Vec::new(), Vec::new());
    for (name, bytes) in unpacked(bytes, archive)? {
        if name.to_ascii_lowercase().ends_with(REQIF) {
            let text = decode(&bytes, &super::read::inside(archive, &name))?;
            files.push((name, text));
        } else {
            attachments.push(Attachment { name, bytes });
        }
    }
    if files.is_empty() {
        let names: Vec<&str> = attachments.iter().map(|a| a.name.as_str()).collect();
        let found =
            if names.is_empty() { "nothing".to_owned() } else { crate::error::listed(&names) };
        return Err(ReqIfArchiveError::Empty { archive: archive.to_owned(), found });
    }
    let mut imported = read_all(&files, archive, mapping)?;
    missing(&mut imported, &attachments, &files);
    imported.attachments = attachments;
    Ok(imported)
}

/// Notes the files that texts show and the archive doesn't have.
fn missing(imported: &mut Imported, attachments: &[Attachment], files: &[(String, String)]) {
    let folders: Vec<&str> = files
        .iter()
        .map(|(name, _)| name.rsplit_once('/').map_or("", |(folder, _)| folder))
        .collect();
    let names: HashSet<&str> = attachments.iter().map(|a| a.name.as_str()).collect();
    let mut notes = Vec::new();
    for requirement in &imported.requirements.requirements {
        for text in &requirement.formatted {
            for data in crate::xhtml::references(&text.xhtml) {
                let data = data.strip_prefix("./").unwrap_or(&data).replace('\\', "/");
                let there = |folder: &str| {
                    let slash = if folder.is_empty() { "" } else { "/" };
                    names.contains(&*format!("{folder}{slash}{data}"))
                };
                if !data.contains("://") && !folders.iter().any(|folder| there(folder)) {
                    let message = format!(
                        "{}: the text shows {data:?}, which the archive doesn't have",
                        requirement.id
                    );
                    notes.push(Note::new(0, message));
                }
            }
        }
    }
    imported.notes.extend(notes);
}

/// Names and bytes of all files of an archive, in the order of their names.
fn unpacked(bytes: &[u8], archive: &str) -> Result<Vec<(String, Vec<u8>)>, ReqIfArchiveError> {
    let damaged = |reason: String| ReqIfArchiveError::Zip { archive: archive.to_owned(), reason };
    let limit = |what: String, limit: String| ReqIfArchiveError::Limit {
        archive: archive.to_owned(),
        what,
        limit,
    };
    if !bytes.starts_with(b"PK") {
        return Err(damaged("it doesn't begin with PK".to_owned()));
    }
    let mut zip = ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(reason(&error)))?;
    if zip.len() > ENTRIES {
        return Err(limit(format!("it has {} entries", zip.len()), ENTRIES.to_string()));
    }
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    let mut known = HashSet::new();
    let mut left = BYTES;
    for index in 0..zip.len() {
        let name = match zip.name_for_index(index) {
            Some(Ok(name)) => name.into_owned(),
            _ => return Err(damaged(format!("the entry {index} has no readable name"))),
        };
        let mut entry = zip
            .by_index(index)
            .map_err(|error| damaged(format!("the entry {name:?}: {}", reason(&error))))?;
        if !is_inside(&name) || entry.is_symlink() {
            return Err(ReqIfArchiveError::Path { archive: archive.to_owned(), entry: name });
        }
        if entry.is_dir() {
            continue;
        }
        let name = name.replace('\\', "/");
        if !known.insert(name.clone()) {
            return Err(damaged(format!("the entry {name:?} is there twice")));
        }
        let mut content = Vec::new();
        entry
            .by_ref()
            .take(left + 1)
            .read_to_end(&mut content)
            .map_err(|error| damaged(format!("the entry {name:?}: {error}")))?;
        left = match left.checked_sub(content.len() as u64) {
            Some(left) => left,
            None => {
                let what = format!("its content is too large from the entry {name:?} on");
                return Err(limit(what, format!("{} MiB", BYTES >> 20)));
            }
        };
        files.push((name, content));
    }
    files.sort();
    Ok(files)
}

/// True for a relative path without a step upwards.
fn is_inside(name: &str) -> bool {
    let drive = name.chars().nth(1) == Some(':');
    let absolute = name.starts_with(['/', '\\']) || drive;
    !name.is_empty()
        && !absolute
        && !name.contains('\0')
        && !name.split(['/', '\\']).any(|part| part == "..")
}

fn reason(error: &ZipError) -> String {
    match error {
        ZipError::UnsupportedArchive(ZipError::PASSWORD_REQUIRED) => {
            "it is encrypted: export it without a password".to_owned()
        }
        other => other.to_string(),
    }
}

/// Writes a `.reqifz`: the requirements as one file, and the attachments beside it.
///
/// The same requirements, attachments and time give the same bytes.
///
/// # Errors
/// As [`super::write`].
pub fn write(
    requirements: &Requirements,
    attachments: &[Attachment],
    time: &str,
) -> Result<Vec<u8>, ExportError> {
    let text = super::write(requirements, time)?;
    packed(&text, attachments).map_err(|error| ExportError {
        format: "ReqIF",
        id: "(all)".to_owned(),
        message: reason(&error),
    })
}

fn packed(text: &str, attachments: &[Attachment]) -> Result<Vec<u8>, ZipError> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default();
    let taken = |name: &str| attachments.iter().any(|attachment| attachment.name == name);
    let mut name = "requirements.reqif".to_owned();
    let mut number = 2;
    while taken(&name) {
        name = format!("requirements-{number}.reqif");
        number += 1;
    }
    zip.start_file(name, options)?;
    zip.write_all(text.as_bytes())?;
    for attachment in attachments {
        zip.start_file(attachment.name.as_str(), options)?;
        zip.write_all(&attachment.bytes)?;
    }
    Ok(zip.finish()?.into_inner())
}
