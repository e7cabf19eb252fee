//! The shared libraries of an FMU, read without running them.

pub use super::binary::LibraryProperties;

use super::binary::is_beside;
use super::elf;
use super::finding::{Findings, Place};
use super::model::Model;
use super::rules::{
    BINARY_ARCHITECTURE, BINARY_FOLDER, BINARY_FORMAT, BINARY_LIBRARIES, BINARY_NAME,
    BINARY_OPTIONAL_SYMBOLS, BINARY_PLATFORM, BINARY_SYMBOLS,
};
use object::{Architecture, BinaryFormat, Object, ObjectKind};
use octant_fmu_host::archive::Archive;
use octant_fmu_host::description::Standard;
use octant_fmu_host::library::platforms;
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of function names in a message.
const NAMED: usize = 6;

/// Platform of a folder of binaries, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FolderPlatform {
    /// Format of its libraries.
    pub format: BinaryFormat,
    /// Architecture of its processors.
    pub architecture: Architecture,
    /// Extension of the names of its libraries.
    pub extension: &'static str,
}

/// Finds the platform of a folder; `Err`: the name isn't in the standard, with the platform if it
/// is in the other standard.
///
/// # Errors
/// If the standard has no such name.
pub fn platform(
    folder: &str,
    standard: Standard,
) -> Result<FolderPlatform, Option<FolderPlatform>> {
    use Architecture::{Aarch64, Arm, I386, PowerPc, PowerPc64, Riscv32, Riscv64, X86_64};
    let of = |system: &str, architecture| {
        let (format, extension) = match system {
            "linux" => (BinaryFormat::Elf, "so"),
            "windows" => (BinaryFormat::Pe, "dll"),
            "darwin" => (BinaryFormat::MachO, "dylib"),
            _ => return None,
        };
        Some(FolderPlatform { format, architecture, extension })
    };
    let old = match folder {
        "win32" => of("windows", I386),
        "win64" => of("windows", X86_64),
        "linux32" => of("linux", I386),
        "linux64" => of("linux", X86_64),
        "darwin32" => of("darwin", I386),
        "darwin64" => of("darwin", X86_64),
        _ => None,
    };
    let mut parts = folder.splitn(3, '-');
    let architecture = match parts.next().unwrap_or_default() {
        "x86" | "i386" | "i586" | "i686" => Some(I386),
        "x86_64" => Some(X86_64),
        "aarch32" => Some(Arm),
        "aarch64" => Some(Aarch64),
        "riscv32" => Some(Riscv32),
        "riscv64" => Some(Riscv64),
        "ppc32" => Some(PowerPc),
        "ppc64" => Some(PowerPc64),
        _ => None,
    };
    let new = parts.next().zip(architecture).and_then(|(system, arch)| of(system, arch));
    match standard {
        // FMI 2.0 has names only for PCs; tools use those of FMI 3.0 for other machines.
        Standard::Fmi2 => {
            old.or(new.filter(|new| !matches!(new.architecture, I386 | X86_64))).ok_or(new)
        }
        Standard::Fmi3 => new.ok_or(old),
    }
}

/// Checks the libraries.
pub(super) fn check(
    model: &Model<'_, '_>,
    archive: &mut Archive,
    findings: &mut Findings,
) -> Vec<LibraryProperties> {
    let mut folders: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for entry in archive.entries() {
        let mut parts = entry.name.splitn(3, '/');
        if let (Some("binaries"), Some(folder), Some(file)) =
            (parts.next(), parts.next(), parts.next())
        {
            folders.entry(folder.to_owned()).or_default().insert(file.to_owned());
        }
    }
    let description = model.description;
    let mut identifiers: BTreeSet<&str> = BTreeSet::new();
    for interface in [&description.co_simulation, &description.model_exchange].into_iter().flatten()
    {
        identifiers.insert(&interface.model_identifier);
    }
    if let Some(element) = model.root.child("ScheduledExecution") {
        identifiers.extend(element.text("modelIdentifier"));
    }
    let mut binaries = Vec::new();
    for (folder, files) in &folders {
        let path = format!("binaries/{folder}/");
        let place = Place { entry: &path, ..Place::default() };
        let platform = match platform(folder, model.standard()) {
            Ok(platform) => platform,
            Err(other) => {
                let (found, expected) = match (model.standard(), other.is_some()) {
                    (Standard::Fmi2, true) => ("a folder as FMI 3.0 names it", "linux64, win64, …"),
                    (Standard::Fmi3, true) => {
                        ("a folder as FMI 2.0 names it", "x86_64-linux, x86_64-windows, …")
                    }
                    (Standard::Fmi2, false) => {
                        ("a folder of a name that FMI doesn't have", "linux64, win64, …")
                    }
                    (Standard::Fmi3, false) => {
                        ("a folder of a name that FMI doesn't have", "x86_64-linux, …")
                    }
                };
                findings.add(&BINARY_FOLDER, place, found, expected);
                match other {
                    Some(platform) => platform,
                    None => continue,
                }
            }
        };
        // Static libraries are for importers that link the sources.
        let is_static = files.iter().any(|file| file.ends_with(".lib") || file.ends_with(".a"));
        for identifier in &identifiers {
            let name = format!("{identifier}.{}", platform.extension);
            if files.contains(&name) {
                let entry = format!("{path}{name}");
                binaries.push(library(model, archive, &entry, platform, files, findings));
            } else if !is_static {
                let found = match files.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", ") {
                    files if files.is_empty() => "nothing".to_owned(),
                    files => files,
                };
                findings.add(&BINARY_NAME, place, found, name);
            }
        }
    }
    let here = platforms(model.standard());
    if !folders.is_empty()
        && !here.iter().any(|name| folders.contains_key(*name))
        && !here.is_empty()
    {
        let found = folders.keys().cloned().collect::<Vec<_>>().join(", ");
        let place = Place { entry: "binaries/", ..Place::default() };
        findings.add(&BINARY_PLATFORM, place, format!("binaries for {found}"), here.join(" or "));
    }
    binaries
}

/// Checks one library.
fn library(
    model: &Model<'_, '_>,
    archive: &mut Archive,
    entry: &str,
    platform: FolderPlatform,
    beside: &BTreeSet<String>,
    findings: &mut Findings,
) -> LibraryProperties {
    let place = Place { entry, ..Place::default() };
    let mut binary = LibraryProperties { entry: entry.to_owned(), ..LibraryProperties::default() };
    let bytes = match archive.read(entry) {
        Ok(bytes) => bytes,
        Err(error) => {
            findings.add(&super::rules::ARCHIVE_READABLE, place, error.to_string(), "the library");
            return binary;
        }
    };
    let object = match parse(&bytes, platform) {
        Ok(object) => object,
        Err(error) => {
            findings.add(&BINARY_FORMAT, place, error, "a shared library");
            return binary;
        }
    };
    binary.format = format!("{:?}", object.format());
    binary.architecture = format!("{:?}", object.architecture());
    if object.format() != platform.format || object.architecture() != platform.architecture {
        let found = format!("{} for {}", binary.format, binary.architecture);
        let expected = format!("{:?} for {:?}", platform.format, platform.architecture);
        findings.add(&BINARY_ARCHITECTURE, place, found, expected);
        return binary;
    }
    if object.kind() != ObjectKind::Dynamic {
        findings.add(&BINARY_FORMAT, place, format!("{:?}", object.kind()), "a shared library");
        return binary;
    }
    symbols(model, &object, place, &mut binary, findings);
    libraries(&object, place, beside, &mut binary, findings);
    match &object {
        object::File::Elf32(elf) => elf::check(elf, place, beside, &mut binary, findings),
        object::File::Elf64(elf) => elf::check(elf, place, beside, &mut binary, findings),
        _ => {}
    }
    binary
}

/// Reads the library, out of a fat file of macOS if it is one.
fn parse(bytes: &[u8], platform: FolderPlatform) -> Result<object::File<'_>, String> {
    use object::read::macho::{FatArch, MachOFatFile32, MachOFatFile64};
    let mut slices: Vec<(Architecture, Result<&[u8], object::Error>)> = Vec::new();
    if let Ok(fat) = MachOFatFile32::parse(bytes) {
        slices.extend(fat.arches().iter().map(|arch| (arch.architecture(), arch.data(bytes))));
    } else if let Ok(fat) = MachOFatFile64::parse(bytes) {
        slices.extend(fat.arches().iter().map(|arch| (arch.architecture(), arch.data(bytes))));
    }
    let slice = slices.into_iter().find(|(architecture, _)| *architecture == platform.architecture);
    let bytes = match slice {
        Some((_, slice)) => slice.map_err(|error| error.to_string())?,
        None => bytes,
    };
    object::File::parse(bytes).map_err(|error| format!("no library: {error}"))
}

/// Checks the functions that the library has to export.
fn symbols(
    model: &Model<'_, '_>,
    object: &object::File<'_>,
    place: Place<'_>,
    binary: &mut LibraryProperties,
    findings: &mut Findings,
) {
    let mut exported: BTreeSet<String> = BTreeSet::new();
    match object.exports() {
        Ok(exports) => {
            for export in exports.flatten() {
                if let object::read::NameOrOrdinal::Name(name) = export.name() {
                    let name = String::from_utf8_lossy(name);
                    // Mach-O has an underscore before every C name.
                    let name = match object.format() {
                        BinaryFormat::MachO => name.strip_prefix('_').unwrap_or(&name).to_owned(),
                        _ => name.into_owned(),
                    };
                    exported.insert(name);
                }
            }
        }
        Err(error) => {
            findings.add(
                &BINARY_SYMBOLS,
                place,
                format!("no exports: {error}"),
                "exported functions",
            );
            return;
        }
    }
    let all: &[&str] = match model.standard() {
        Standard::Fmi2 => octant_fmi::fmi2::NAMES,
        Standard::Fmi3 => octant_fmi::fmi3::NAMES,
    };
    binary.functions = all.iter().filter(|name| exported.contains(**name)).count();
    let description = model.description;
    let missing: Vec<&str> = all
        .iter()
        .copied()
        .filter(|name| super::functions::is_of_interface(description, name))
        .filter(|name| !exported.contains(*name))
        .collect();
    let Some(first) = missing.first() else { return };
    // Static libraries have the model identifier before every name.
    let interfaces = description.co_simulation.iter().chain(&description.model_exchange);
    let prefixed = interfaces
        .map(|interface| format!("{}_{first}", interface.model_identifier))
        .find(|name| exported.contains(name));
    if let Some(name) = prefixed {
        let found = format!("{name} and others with a prefix, as in a static library");
        findings.add(&BINARY_SYMBOLS, place, found, format!("{first}, without"));
        return;
    }
    let (needed, optional): (Vec<&str>, Vec<&str>) =
        missing.iter().partition(|name| super::functions::is_needed(description, name));
    for (rule, names) in [(&BINARY_SYMBOLS, needed), (&BINARY_OPTIONAL_SYMBOLS, optional)] {
        let mut list: Vec<String> = names.iter().take(NAMED).map(|&name| name.to_owned()).collect();
        if names.len() > NAMED {
            list.push(format!("{} more", names.len() - NAMED));
        }
        if !list.is_empty() {
            let found = format!("no {}", list.join(", "));
            findings.add(rule, place, found, "all functions of its interfaces");
        }
    }
}

/// Checks the libraries that the library needs.
fn libraries(
    object: &object::File<'_>,
    place: Place<'_>,
    beside: &BTreeSet<String>,
    binary: &mut LibraryProperties,
    findings: &mut Findings,
) {
    let Ok(imports) = object.import_libraries() else { return };
    for import in imports.flatten() {
        binary.libraries.push(String::from_utf8_lossy(import.name()).into_owned());
    }
    let unusual: Vec<&str> = binary
        .libraries
        .iter()
        .map(String::as_str)
        .filter(|name| !is_usual(object.format(), name) && !is_beside(name, beside))
        .collect();
    if !unusual.is_empty() {
        let expected = "libraries of every system, or in the same folder";
        findings.add(
            &BINARY_LIBRARIES,
            place,
            format!("it needs {}", unusual.join(", ")),
            expected,
        );
    }
}

/// Returns whether every system has a library of this name.
#[must_use]
pub fn is_usual(format: BinaryFormat, name: &str) -> bool {
    let lower = name.to_ascii_lowercase();
    match format {
        BinaryFormat::Elf => {
            const STEMS: &str = "libc libm libdl libpthread librt libgcc_s libstdc++ libutil libresolv ld-linux \
                 ld-linux-x86-64 ld-linux-aarch64 ld-linux-armhf";
            lower
                .split_once(".so")
                .is_some_and(|(stem, _)| STEMS.split(' ').any(|known| known == stem))
        }
        BinaryFormat::Pe => {
            const STEMS: &str = "kernel32 user32 advapi32 ntdll ws2_32 wsock32 ole32 oleaut32 shell32 gdi32 \
                 comdlg32 comctl32 bcrypt bcryptprimitives userenv ucrtbase msvcrt winmm version \
                 dbghelp secur32 crypt32 iphlpapi psapi shlwapi setupapi rpcrt4 synchronization \
                 winspool powrprof";
            let stem = lower.strip_suffix(".dll").unwrap_or(&lower);
            STEMS.split(' ').any(|known| known == stem) || stem.starts_with("api-ms-win-")
        }
        BinaryFormat::MachO => {
            name.starts_with("/usr/lib/") || name.starts_with("/System/Library/")
        }
        _ => false,
    }
}
