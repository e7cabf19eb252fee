//! `octant fmu build`: descriptions, archives, documentation and system structure, from the tables.
//!
//! | module | idea |
//! |---|---|
//! | [`library`] | the shared library that goes in, and its platform |
//! | [`describe`] | `modelDescription.xml` of both standards |
//! | [`terminals`] | `terminalsAndIcons.xml` |
//! | [`documentation`], [`prose`] | `documentation/index.html` |
//! | [`licences`] | `documentation/licenses` |
//! | [`element`], [`archive`] | XML and ZIP whose bytes follow from what is in them alone |

mod archive;
mod describe;
mod documentation;
mod element;
mod library;
mod licences;
mod prose;
#[cfg(test)]
mod sample;
mod terminals;

use archive::{File, archive};
use documentation::{Standard, documentation};
use library::Library;
use octant_fmu::table::Model;
use std::path::{Path, PathBuf};

/// Log categories of the library, with what is logged in each.
const LOG_CATEGORIES: [(&str, &str); 5] = [
    ("logStatusWarning", "What is worth looking at and stops nothing"),
    ("logStatusDiscard", "What was refused and changed nothing: values, steps"),
    ("logStatusError", "Wrong calls"),
    ("logStatusFatal", "What an instance can't go on after"),
    ("logEvents", "What happened in the model"),
];

/// What is built.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The folder that the files go into.
    pub out: PathBuf,
    /// The shared library; `None`: the one that was built with the program.
    pub library: Option<PathBuf>,
}

/// Why nothing, or not everything, was built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// The program doesn't know where it is.
    #[error("failed to find the program's own file: {source}")]
    Program {
        /// What the system said.
        source: std::io::Error,
    },
    /// The library isn't where it is built.
    #[error(
        "{name} isn't beside the program in {}: build it with `cargo build --release`, or name one with --library",
        folder.display()
    )]
    NoLibrary {
        /// Name of its file.
        name: String,
        /// Where it was looked for.
        folder: PathBuf,
    },
    /// A file can't be read.
    #[error("failed to read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file isn't a library that can go in.
    #[error("{} can't go into an FMU: {reason}", path.display())]
    Library {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: String,
    },
    /// A file can't be written.
    #[error("failed to write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}

/// Pictures of a model.
struct Icons {
    svg: &'static str,
    png: &'static [u8],
}

fn icons(model: &Model) -> Icons {
    if model.stem == "plant" {
        Icons { svg: include_str!("icons/plant.svg"), png: include_bytes!("icons/plant.png") }
    } else {
        Icons {
            svg: include_str!("icons/calibrator.svg"),
            png: include_bytes!("icons/calibrator.png"),
        }
    }
}

/// Builds everything; the files that were written.
///
/// # Errors
/// If the library isn't there or isn't one of ours, or a file can't be written.
pub fn build(
    models: &[(&'static Model, &str)],
    options: &Options,
) -> Result<Vec<PathBuf>, BuildError> {
    let path = match &options.library {
        Some(path) => path.clone(),
        None => library::beside_program()?,
    };
    let libraries = [Library::read(&path)?];
    let write = |name: String, bytes: Vec<u8>| {
        let path = options.out.join(name);
        std::fs::write(&path, bytes)
            .map(|()| path.clone())
            .map_err(|source| BuildError::Write { path, source })
    };
    std::fs::create_dir_all(&options.out)
        .map_err(|source| BuildError::Write { path: options.out.clone(), source })?;
    let mut written = Vec::new();
    for (model, token) in models {
        for standard in [Standard::Fmi2, Standard::Fmi3] {
            let name = format!("{}_{}.fmu", model.stem, standard.suffix());
            let bytes = fmu(model, standard, token, &libraries)
                .map_err(|source| BuildError::Write { path: Path::new(&name).into(), source })?;
            written.push(write(name, bytes)?);
        }
    }
    Ok(written)
}

/// One FMU.
fn fmu(
    model: &'static Model,
    standard: Standard,
    token: &str,
    libraries: &[Library],
) -> std::io::Result<Vec<u8>> {
    let identifier = format!("{}_{}", model.stem, standard.suffix());
    let icons = icons(model);
    let description = match standard {
        Standard::Fmi2 => describe::fmi2(model, token),
        Standard::Fmi3 => describe::fmi3(model, token),
    };
    let mut files = vec![File::new("modelDescription.xml", description.document()?)];
    for library in libraries {
        let folder = match standard {
            Standard::Fmi2 => library.platform.fmi2,
            Standard::Fmi3 => library.platform.fmi3,
        };
        let path = format!("binaries/{folder}/{identifier}.{}", library.platform.extension);
        files.push(File::new(path, library.bytes.clone()));
    }
    files.push(File::new("documentation/index.html", documentation(model, standard, icons.svg)));
    files.extend(licences::files(&identifier));
    match standard {
        Standard::Fmi2 => files.push(File::new("model.png", icons.png)),
        Standard::Fmi3 => files.extend([
            File::new("terminalsAndIcons/icon.png", icons.png),
            File::new("terminalsAndIcons/icon.svg", icons.svg),
            File::new("terminalsAndIcons/terminal.png", include_bytes!("icons/terminal.png")),
            File::new("terminalsAndIcons/terminal.svg", include_str!("icons/terminal.svg")),
            File::new(
                "terminalsAndIcons/terminalsAndIcons.xml",
                terminals::terminals(model).document()?,
            ),
        ]),
    }
    Ok(archive(&files)?)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use std::io::{Cursor, Read};

    fn files(standard: Standard) -> Vec<(String, Vec<u8>)> {
        let platform = library::Platform { fmi2: "linux64", fmi3: "x86_64-linux", extension: "so" };
        let libraries = [Library { bytes: b"library".to_vec(), platform }];
        let bytes = fmu(&sample::SAMPLE, standard, "{token}", &libraries).unwrap();
        assert_eq!(bytes, fmu(&sample::SAMPLE, standard, "{token}", &libraries).unwrap());
        let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).unwrap();
        (0..archive.len())
            .map(|index| {
                let mut file = archive.by_index(index).unwrap();
                let mut contents = Vec::new();
                file.read_to_end(&mut contents).unwrap();
                (file.name().unwrap().into_owned(), contents)
            })
            .collect()
    }

    #[test]
    fn files_are_where_the_standards_want_them() {
        let names = |standard| -> Vec<String> {
            files(standard).into_iter().map(|(name, _)| name).collect()
        };
        let documentation = [
            "documentation/index.html",
            "documentation/licenses/LICENSE-APACHE.txt",
            "documentation/licenses/LICENSE-MIT.txt",
            "documentation/licenses/license.spdx",
            "documentation/licenses/license.txt",
        ];
        let second = ["modelDescription.xml", "binaries/linux64/sample_fmi2.so"];
        assert_eq!(names(Standard::Fmi2), [&second[..], &documentation, &["model.png"]].concat());
        let third = ["modelDescription.xml", "binaries/x86_64-linux/sample_fmi3.so"];
        let pictures = [
            "terminalsAndIcons/icon.png",
            "terminalsAndIcons/icon.svg",
            "terminalsAndIcons/terminal.png",
            "terminalsAndIcons/terminal.svg",
            "terminalsAndIcons/terminalsAndIcons.xml",
        ];
        assert_eq!(names(Standard::Fmi3), [&third[..], &documentation, &pictures].concat());
    }

    /// Every file that the page links to is in the archive, and every place in it is on the page.
    #[test]
    fn links_of_the_documentation_lead_somewhere() {
        for standard in [Standard::Fmi2, Standard::Fmi3] {
            let files = files(standard);
            let page = files.iter().find(|(name, _)| name == "documentation/index.html").unwrap();
            let page = String::from_utf8(page.1.clone()).unwrap();
            let links: Vec<&str> =
                page.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
            assert!(links.len() > 10, "{links:?}");
            for link in links {
                let found = match link.strip_prefix('#') {
                    Some(place) => page.contains(&format!("id=\"{place}\"")),
                    None => files.iter().any(|(name, _)| *name == format!("documentation/{link}")),
                };
                assert!(found, "{link} leads nowhere");
            }
        }
    }
}
