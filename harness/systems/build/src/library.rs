//! Reads the shared library that goes into an FMU, and determines its platform.

use super::error::BuildError;
use object::{Architecture, BinaryFormat, Object};
use std::path::{Path, PathBuf};

/// A platform as the two standards name it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Platform {
    /// Folder in FMI 2.0.
    pub(super) fmi2: &'static str,
    /// Folder in FMI 3.0.
    pub(super) fmi3: &'static str,
    /// Extension of a library's file name.
    pub(super) extension: &'static str,
}

/// Known platforms. FMI 2.0 has no name for 64-bit ARM: tools that load it look in the folder of
/// FMI 3.0.
const PLATFORMS: [((BinaryFormat, Architecture), Platform); 5] = {
    use Architecture::{Aarch64, X86_64};
    use BinaryFormat::{Elf, MachO, Pe};
    const fn platform(fmi2: &'static str, fmi3: &'static str, extension: &'static str) -> Platform {
        Platform { fmi2, fmi3, extension }
    }
    [
        ((Elf, X86_64), platform("linux64", "x86_64-linux", "so")),
        ((Elf, Aarch64), platform("aarch64-linux", "aarch64-linux", "so")),
        ((Pe, X86_64), platform("win64", "x86_64-windows", "dll")),
        ((MachO, X86_64), platform("darwin64", "x86_64-darwin", "dylib")),
        ((MachO, Aarch64), platform("aarch64-darwin", "aarch64-darwin", "dylib")),
    ]
};

/// Library that was read.
#[derive(Clone, Debug)]
pub(super) struct Library {
    /// Bytes.
    pub(super) bytes: Vec<u8>,
    /// Platform that it runs on.
    pub(super) platform: Platform,
}

/// One function of each standard, by which our library is recognised.
const MARKS: [&str; 2] = ["fmi2Instantiate", "fmi3InstantiateCoSimulation"];

impl Library {
    /// Reads a library, and checks that it is one of ours.
    pub(super) fn read(path: &Path) -> Result<Self, BuildError> {
        let bytes = std::fs::read(path)
            .map_err(|source| BuildError::Read { path: path.to_owned(), source })?;
        let unfit = |reason: String| BuildError::Library { path: path.to_owned(), reason };
        let object = object::File::parse(bytes.as_slice())
            .map_err(|error| unfit(format!("it is no shared library: {error}")))?;
        let kind = (object.format(), object.architecture());
        let platform = (PLATFORMS.iter().find(|(known, _)| *known == kind))
            .map(|(_, platform)| *platform)
            .ok_or_else(|| unfit(format!("FMI has no name for {:?} on {:?}", kind.0, kind.1)))?;
        let mut missing = MARKS.to_vec();
        for export in object.exports().map_err(|error| unfit(error.to_string()))? {
            let export = export.map_err(|error| unfit(error.to_string()))?;
            if let object::NameOrOrdinal::Name(name) = export.name() {
                // Mach-O puts an underscore in front of each name.
                let name = name.strip_prefix(b"_").unwrap_or(name);
                missing.retain(|mark| mark.as_bytes() != name);
            }
        }
        if let Some(mark) = missing.first() {
            return Err(unfit(format!("it doesn't export {mark}")));
        }
        Ok(Self { bytes, platform })
    }
}

/// Name of the library on the platform that the program runs on.
pub(super) fn file_name() -> String {
    format!("{}octant_fmu{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

/// Finds the library that was built with the program: beside it, in the `deps` folder of the build, or
/// in the `lib/octant` that an installation has beside its `bin`.
pub(super) fn beside_program() -> Result<PathBuf, BuildError> {
    let program = std::env::current_exe().map_err(|source| BuildError::Program { source })?;
    let folder = program.parent().unwrap_or(Path::new(""));
    let name = file_name();
    // A test program is itself in `deps`, an example in `examples`.
    let places = ["", "deps", "../deps", "../lib/octant"].map(|beside| folder.join(beside));
    let found = places.iter().map(|place| place.join(&name)).filter(|path| path.is_file());
    // `cargo test` renews only the library in `deps`.
    let newest = found.max_by_key(|path| path.metadata().and_then(|facts| facts.modified()).ok());
    newest.ok_or(BuildError::NoLibrary { name, folder: folder.to_owned() })
}
