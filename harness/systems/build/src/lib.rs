//! `octant fmu build`: descriptions, archives, documentation and system structure, from the tables.
//!
//! | module | idea |
//! |---|---|
//! | `library` | the shared library that goes in, and its platform |
//! | `describe` | `modelDescription.xml` of both standards |
//! | `terminals`, `graphics` | `terminalsAndIcons.xml` |
//! | `bus` | the additions of FMI-LS-BUS, and its manifest |
//! | `documentation`, `prose` | `documentation/index.html` |
//! | `licences` | `documentation/licenses` |
//! | `element`, `archive` | XML and ZIP whose bytes depend on their contents alone |

mod archive;
mod bus;
mod describe;
mod documentation;
mod element;
mod error;
mod library;
mod licences;
mod parameters;
mod prose;
mod reference;
#[cfg(test)]
mod sample;
mod ssp;
mod standard;
mod system;
mod target;
mod terminals;

pub use error::BuildError;

use archive::{File, archive};
use documentation::documentation;
use library::Library;
use octant_fmu::c::token;
use octant_fmu::calibrator::Calibrator;
use octant_fmu::calibrator_can::CalibratorCan;
use octant_fmu::component::ModelComponent as _;
use octant_fmu::plant::PlantFmu;
use octant_fmu::table::Model;
use octant_scenario::Scenario;
use standard::Standard;
use std::path::PathBuf;
use system::{Configured, Own};

/// Settings of a build.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Output folder.
    pub out: PathBuf,
    /// Shared libraries, each for another platform; if empty, the one that was built with the
    /// program.
    pub libraries: Vec<PathBuf>,
    /// Additional targets for which cargo builds a library.
    pub targets: Vec<String>,
    /// Scenario whose parameters the system gets, with its name; `None`: the built-in one.
    pub scenario: Option<(String, Scenario)>,
    /// Leaves out the inputs and outputs to check a tool with, which are a quarter of an FMU and more.
    pub without_reference: bool,
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

/// Reads the libraries, each for another platform.
fn libraries(options: &Options) -> Result<Vec<Library>, BuildError> {
    let mut found: Vec<(PathBuf, Library)> = Vec::new();
    let mut add = |path: PathBuf| {
        let library = Library::read(&path)?;
        if let Some((first, _)) = found.iter().find(|(_, other)| other.platform == library.platform)
        {
            let platform = library.platform.fmi3;
            return Err(BuildError::SamePlatform { first: first.clone(), second: path, platform });
        }
        found.push((path, library));
        Ok(())
    };
    for path in &options.libraries {
        add(path.clone())?;
    }
    for target in &options.targets {
        add(target::library(target)?)?;
    }
    // A library that was named, or built for the program's own platform, replaces the default one.
    if options.libraries.is_empty() {
        match add(library::beside_program()?) {
            Ok(()) | Err(BuildError::SamePlatform { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(found.into_iter().map(|(_, library)| library).collect())
}

/// Runs the models that are wired to a system, with their start values.
fn own(options: &Options) -> Result<[Own; 2], BuildError> {
    if options.without_reference {
        let models = [PlantFmu::MODEL, Calibrator::MODEL];
        return Ok(models.map(|model| Own { model, reference: None }));
    }
    let references = reference::closed_loop::<PlantFmu, Calibrator>();
    let references = references.map_err(|reason| BuildError::Model { reason })?;
    Ok(references.map(|reference| Own { model: reference.model(), reference: Some(reference) }))
}

/// Builds everything; returns the files that were written.
///
/// # Errors
/// If a library isn't there, isn't one of ours or can't be built, the scenario can't be put into
/// FMUs, or a file can't be written.
pub fn build(options: &Options) -> Result<Vec<PathBuf>, BuildError> {
    let configured = match &options.scenario {
        Some((name, scenario)) => Configured::new(scenario, name)?,
        None => Configured::built_in()?,
    };
    let libraries = libraries(options)?;
    let own = own(options)?;
    let failed = |path: PathBuf| move |source| BuildError::Write { path, source };
    std::fs::create_dir_all(&options.out).map_err(failed(options.out.clone()))?;
    let mut written = Vec::new();
    let mut write = |name: &str, bytes: std::io::Result<Vec<u8>>| {
        let path = options.out.join(name);
        let bytes = bytes.map_err(failed(path.clone()))?;
        std::fs::write(&path, &bytes).map_err(failed(path.clone()))?;
        written.push(path);
        Ok::<_, BuildError>(bytes)
    };
    let mut second = Vec::new();
    for own in &own {
        for standard in [Standard::Fmi2, Standard::Fmi3] {
            let name = format!("{}_{}.fmu", own.model.stem, standard.suffix());
            let bytes = write(&name, fmu(own, standard, &libraries))?;
            if standard == Standard::Fmi2 {
                second.push(bytes);
            }
        }
    }
    let can = Own { model: CalibratorCan::MODEL, reference: None };
    let name = format!("{}_{}.fmu", can.model.stem, Standard::Fmi3.suffix());
    write(&name, fmu(&can, Standard::Fmi3, &libraries))?;
    write("octant.ssp", system::archive_of(&own, &second, &configured))?;
    if options.scenario.is_some() {
        let path = options.out.clone();
        let models = own.iter().chain([&can]).map(|own| own.model);
        for (name, bytes) in configured.files(models).map_err(failed(path))? {
            write(&name, Ok(bytes))?;
        }
    }
    Ok(written)
}

/// Builds one FMU.
fn fmu(own: &Own, standard: Standard, libraries: &[Library]) -> std::io::Result<Vec<u8>> {
    let model = own.model;
    let token = token(model, standard.of_library());
    let identifier = format!("{}_{}", model.stem, standard.suffix());
    let icons = icons(model);
    let description = match standard {
        Standard::Fmi2 => describe::fmi2(model, &token),
        Standard::Fmi3 => describe::fmi3(model, &token),
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
    let page = documentation(model, standard, icons.svg, own.reference.is_some());
    files.push(File::new("documentation/index.html", page));
    if let Some(reference) = &own.reference {
        files.extend(reference::files(reference, standard));
    }
    if let Some(manifest) = bus::manifest(model) {
        files.push(File::new(bus::MANIFEST, manifest.document()?));
    }
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

    use super::sample::Sample;
    use super::*;
    use std::io::{Cursor, Read};

    fn files(standard: Standard) -> Vec<(String, Vec<u8>)> {
        let platform = library::Platform { fmi2: "linux64", fmi3: "x86_64-linux", extension: "so" };
        let libraries = [Library { bytes: b"library".to_vec(), platform }];
        let [reference, _] = reference::closed_loop::<Sample, Sample>().unwrap();
        let own = Own { model: &sample::SAMPLE, reference: Some(reference) };
        let bytes = fmu(&own, standard, &libraries).unwrap();
        assert_eq!(bytes, fmu(&own, standard, &libraries).unwrap());
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
        let expected =
            |text: &str| -> Vec<String> { text.split_whitespace().map(str::to_owned).collect() };
        assert_eq!(
            names(Standard::Fmi2),
            expected(
                "modelDescription.xml binaries/linux64/sample_fmi2.so documentation/index.html
                 documentation/sample_fmi2_in.csv documentation/sample_fmi2_ref.csv
                 documentation/sample_fmi2_ref.opt documentation/licenses/LICENSE-APACHE.txt
                 documentation/licenses/LICENSE-MIT.txt documentation/licenses/license.spdx
                 documentation/licenses/license.txt model.png"
            )
        );
        assert_eq!(
            names(Standard::Fmi3),
            expected(
                "modelDescription.xml binaries/x86_64-linux/sample_fmi3.so documentation/index.html
                 documentation/sample_fmi3_in.csv documentation/sample_fmi3_ref.csv
                 documentation/sample_fmi3_ref.opt documentation/licenses/LICENSE-APACHE.txt
                 documentation/licenses/LICENSE-MIT.txt documentation/licenses/license.spdx
                 documentation/licenses/license.txt terminalsAndIcons/icon.png
                 terminalsAndIcons/icon.svg terminalsAndIcons/terminal.png
                 terminalsAndIcons/terminal.svg terminalsAndIcons/terminalsAndIcons.xml"
            )
        );
    }

    /// Every file that the page links to is in the archive, and every anchor that it links to is on
    /// the page.
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
