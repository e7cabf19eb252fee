//! The shared library of an unpacked FMU.
#![allow(unsafe_code, reason = "a library is loaded and its functions are looked up")]

use super::archive::Unpacked;
use super::description::Standard;
use super::instance::InstanceError;
use super::instance::once::Once;
use octant_fmi::{fmi2, fmi3};
use std::ffi::CStr;
use std::path::{Path, PathBuf};

/// Functions of a library.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one for each library")]
pub(super) enum Functions {
    Fmi2(fmi2::Functions),
    Fmi3(fmi3::Functions),
}

/// A loaded library. Its functions may be called as long as this exists.
pub(super) struct Library {
    pub(super) functions: Functions,
    /// Dropped before the folder of its file, and before the permission to exist once.
    _library: libloading::Library,
    _kept: (Unpacked, Option<Once>),
}

/// Names of the folders of binaries for this platform, the standard's first. Some tools use the
/// names of FMI 3.0 in FMI 2.0 too, if that has none for a platform.
#[must_use]
pub fn platforms(standard: Standard) -> &'static [&'static str] {
    let all: &[&str] = if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        &["linux64", "x86_64-linux"]
    } else if cfg!(all(target_os = "linux", target_arch = "x86")) {
        &["linux32", "x86-linux"]
    } else if cfg!(all(target_os = "linux", target_arch = "aarch64")) {
        &["aarch64-linux"]
    } else if cfg!(all(target_os = "windows", target_arch = "x86_64")) {
        &["win64", "x86_64-windows"]
    } else if cfg!(all(target_os = "windows", target_arch = "x86")) {
        &["win32", "x86-windows"]
    } else if cfg!(all(target_os = "windows", target_arch = "aarch64")) {
        &["aarch64-windows"]
    } else if cfg!(all(target_os = "macos", target_arch = "x86_64")) {
        &["darwin64", "x86_64-darwin"]
    } else if cfg!(all(target_os = "macos", target_arch = "aarch64")) {
        &["darwin64", "aarch64-darwin"]
    } else {
        &[]
    };
    match standard {
        Standard::Fmi2 => all,
        // FMI 3.0 has only its own name.
        Standard::Fmi3 => all.split_at(all.len().saturating_sub(1)).1,
    }
}

/// Finds the library of an unpacked FMU for this platform.
///
/// # Errors
/// If there is none: the places searched, and the platforms for which there are libraries.
pub fn binary(
    fmu: &str,
    folder: &Path,
    standard: Standard,
    model_identifier: &str,
) -> Result<PathBuf, InstanceError> {
    // The name should be a C identifier; a name of a file elsewhere is never one.
    let elsewhere = |c: char| matches!(c, '/' | '\\' | ':') || c.is_control();
    if model_identifier.is_empty()
        || model_identifier.starts_with('.')
        || model_identifier.contains(elsewhere)
    {
        return Err(InstanceError::load(
            fmu,
            format!("modelIdentifier {model_identifier:?} is no name of a file"),
        ));
    }
    let file = format!("{model_identifier}{}", std::env::consts::DLL_SUFFIX);
    let binaries = folder.join("binaries");
    let wanted = platforms(standard);
    for platform in wanted {
        let path = binaries.join(platform).join(&file);
        if path.is_file() {
            return Ok(path);
        }
    }
    let mut found: Vec<String> = std::fs::read_dir(&binaries)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    found.sort();
    Err(InstanceError::load(
        fmu,
        format!(
            "it has no library for this platform: expected binaries/{}/{file}, found {}",
            wanted.join(" or "),
            if found.is_empty() { "no binaries".into() } else { found.join(", ") },
        ),
    ))
}

impl Library {
    /// Loads the library at `path` and looks up its functions.
    ///
    /// # Errors
    /// If the system can't load it, or it lacks an indispensable function.
    pub(super) fn load(
        fmu: &str,
        path: &Path,
        standard: Standard,
        kept: (Unpacked, Option<Once>),
    ) -> Result<Self, InstanceError> {
        // SAFETY: loading runs code of the FMU, which is what an importer is for; who doesn't trust
        // it has a process of its own for it.
        let library = unsafe { open(path) }.map_err(|error| {
            // The error's source has the text of the system: which symbol or library it is.
            let said = std::error::Error::source(&error).map(ToString::to_string);
            let said = said.unwrap_or_else(|| error.to_string());
            InstanceError::load(fmu, format!("{}: {said}", path.display()))
        })?;
        let find = |name: &str| {
            // SAFETY: nothing but the address is taken.
            let symbol = unsafe { library.get::<*const core::ffi::c_void>(name) };
            symbol.map_or(std::ptr::null(), |symbol| *symbol)
        };
        // SAFETY: the functions of this library under these names have the signatures of the
        // standard that its description claims; the library stays loaded beside the table.
        let functions = unsafe {
            match standard {
                Standard::Fmi2 => Functions::Fmi2(fmi2::Functions::load(find)),
                Standard::Fmi3 => Functions::Fmi3(fmi3::Functions::load(find)),
            }
        };
        let library = Self { functions, _library: library, _kept: kept };
        library.check(fmu, path)?;
        Ok(library)
    }

    /// Checks that the indispensable functions exist, and that the library is of this standard.
    fn check(&self, fmu: &str, path: &Path) -> Result<(), InstanceError> {
        macro_rules! needed {
            ($of:ident: $($name:ident)*) => {
                vec![$((stringify!($name), $of.$name.is_some())),*]
            };
        }
        let (needed, version, expected) = match &self.functions {
            Functions::Fmi2(f) => (
                needed!(f: fmi2Instantiate fmi2FreeInstance fmi2SetupExperiment
                    fmi2EnterInitializationMode fmi2ExitInitializationMode fmi2GetReal fmi2SetReal),
                f.fmi2GetVersion,
                "2.",
            ),
            Functions::Fmi3(f) => {
                let either = f.fmi3InstantiateCoSimulation.is_some()
                    || f.fmi3InstantiateModelExchange.is_some()
                    || f.fmi3InstantiateScheduledExecution.is_some();
                let mut needed = needed!(f: fmi3FreeInstance fmi3EnterInitializationMode
                    fmi3ExitInitializationMode);
                let name = "fmi3InstantiateCoSimulation, fmi3InstantiateModelExchange or \
                            fmi3InstantiateScheduledExecution";
                needed.insert(0, (name, either));
                (needed, f.fmi3GetVersion, "3.")
            }
        };
        let missing: Vec<&str> =
            needed.iter().filter(|(_, there)| !there).map(|(name, _)| *name).collect();
        if !missing.is_empty() {
            return Err(InstanceError::load(
                fmu,
                format!("{} lacks {}", path.display(), missing.join(", ")),
            ));
        }
        if let Some(version) = version {
            // SAFETY: the function takes nothing and gives null or a text that stays.
            let version = unsafe {
                let text = version();
                if text.is_null() { None } else { Some(CStr::from_ptr(text)) }
            };
            let version = version.map_or("null".into(), CStr::to_string_lossy);
            if !version.starts_with(expected) {
                return Err(InstanceError::load(
                    fmu,
                    format!(
                        "{} says that it is of FMI {version}, expected {expected}x",
                        path.display()
                    ),
                ));
            }
        }
        Ok(())
    }
}

/// Loads a library so that missing symbols are reported now and not at a call, and so that its
/// symbols stay local.
#[cfg(unix)]
unsafe fn open(path: &Path) -> Result<libloading::Library, libloading::Error> {
    use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
    // SAFETY: the caller's.
    unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL) }.map(Into::into)
}

/// Loads a library together with the libraries beside it.
#[cfg(windows)]
unsafe fn open(path: &Path) -> Result<libloading::Library, libloading::Error> {
    use libloading::os::windows::{LOAD_WITH_ALTERED_SEARCH_PATH, Library};
    // SAFETY: the caller's.
    unsafe { Library::load_with_flags(path, LOAD_WITH_ALTERED_SEARCH_PATH) }.map(Into::into)
}
