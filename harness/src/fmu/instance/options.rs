//! How an FMU is opened, and opening it.

use super::super::description::{Description, Interface, Standard};
use super::super::library::{self, Library};
use super::call::{Base, Condition, LOADING, Mark, NOWHERE};
use super::co_simulation::CoSimulation;
use super::message::Log;
use super::{Instance, InstanceError, fmi2, fmi3};
use serde::{Deserialize, Serialize};
use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// Which of its interfaces is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum InterfaceKind {
    /// Co-simulation where it has it, else model exchange.
    #[default]
    Any,
    /// Co-simulation.
    CoSimulation,
    /// Model exchange, with our solver.
    ModelExchange,
}

/// Where its code runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Place {
    /// In a process of its own: it can crash, hang and print as it likes. On Linux only.
    #[default]
    OwnProcess,
    /// In this process: quicker, and for code that is trusted.
    ThisProcess,
}

/// How an FMU is opened.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Options {
    /// Which of its interfaces is used.
    pub interface: InterfaceKind,
    /// Where its code runs.
    pub place: Place,
    /// The name that the instance is told; `None`: the model's.
    pub instance_name: Option<String>,
    /// It is asked to log.
    pub log: bool,
    /// Its event mode is used where it has one (FMI 3.0); else it handles events by itself.
    pub event_mode: bool,
    /// It may return early from a step (FMI 3.0).
    pub early_return: bool,
    /// Longest time for loading, instantiation and initialization, together with each reset.
    pub start_limit: Duration,
    /// Longest time for any other call.
    pub time_limit: Duration,
    /// The program that holds an FMU in a process of its own; `None`: this program. It has to be
    /// an `octant` of the same version.
    pub program: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            interface: InterfaceKind::Any,
            place: Place::OwnProcess,
            instance_name: None,
            log: true,
            event_mode: true,
            early_return: true,
            start_limit: Duration::from_mins(1),
            time_limit: Duration::from_secs(10),
            program: None,
        }
    }
}

/// The folder of an unpacked FMU.
#[derive(Debug)]
pub enum Folder {
    /// It stays when it is done with.
    Kept(PathBuf),
    /// It goes when it is done with.
    Temporary(tempfile::TempDir),
}

impl Folder {
    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        match self {
            Self::Kept(path) => path,
            Self::Temporary(folder) => folder.path(),
        }
    }
}

/// What an instance needs to know to be made.
pub(crate) struct Setup {
    pub(crate) name: String,
    pub(crate) description: Arc<Description>,
    pub(crate) interface: Interface,
    pub(crate) folder: PathBuf,
    pub(crate) instance_name: String,
    pub(crate) log: bool,
    pub(crate) event_mode: bool,
    pub(crate) early_return: bool,
    pub(crate) time_limit: Duration,
    pub(crate) mark: Mark,
}

impl Setup {
    /// What every instance has.
    pub(super) fn base(&self, log: &Arc<Log>) -> Base {
        Base {
            name: self.name.clone(),
            description: Arc::clone(&self.description),
            log: Arc::clone(log),
            mark: self.mark,
            condition: Condition::Sound,
        }
    }

    /// The folder of resources as FMI 2.0 wants it: a URI.
    pub(super) fn resource_uri(&self) -> String {
        uri(&self.folder.join("resources"))
    }

    /// The folder of resources as FMI 3.0 wants it: a path with a separator at its end.
    pub(super) fn resource_path(&self) -> Result<CString, InstanceError> {
        let mut path = self.folder.join("resources").into_os_string();
        path.push(std::path::MAIN_SEPARATOR_STR);
        CString::new(path.into_encoded_bytes())
            .map_err(|_| InstanceError::load(&self.name, "its folder has a null byte in its name"))
    }
}

/// A path as a file URI.
fn uri(path: &Path) -> String {
    let mut uri = String::from("file://");
    let bytes = path.as_os_str().as_encoded_bytes();
    if !bytes.starts_with(b"/") {
        uri.push('/');
    }
    for byte in bytes {
        match byte {
            b'\\' if cfg!(windows) => uri.push('/'),
            b'/' | b'-' | b'.' | b'_' | b'~' | b':' => uri.push(char::from(*byte)),
            letter if letter.is_ascii_alphanumeric() => uri.push(char::from(*letter)),
            other => uri.push_str(&format!("%{other:02X}")),
        }
    }
    uri
}

/// A text for C.
pub(super) fn c_text(fmu: &str, what: &str, value: &str) -> Result<CString, InstanceError> {
    CString::new(value).map_err(|_| {
        InstanceError::unsupported(fmu, format!("pass {what} {value:?}"), "it has a null byte")
    })
}

/// Opens an unpacked FMU. `name` is what errors call it.
///
/// # Errors
/// If it hasn't the interface, its library can't be loaded, or it makes no instance.
pub fn open_unpacked(
    name: &str,
    folder: Folder,
    description: Description,
    options: &Options,
) -> Result<Box<dyn Instance>, InstanceError> {
    match options.place {
        Place::OwnProcess => Err(InstanceError::unsupported(
            name,
            "run in a process of its own",
            "this is not part of this version",
        )),
        Place::ThisProcess => {
            open_here(name, folder, Arc::new(description), options, Mark::default())
        }
    }
}

/// Opens an unpacked FMU in this process.
pub(crate) fn open_here(
    name: &str,
    folder: Folder,
    description: Arc<Description>,
    options: &Options,
    mark: Mark,
) -> Result<Box<dyn Instance>, InstanceError> {
    let (exchange, interface) = interface(name, &description, options.interface)?;
    if interface.needs_execution_tool {
        return Err(InstanceError::unsupported(
            name,
            "run",
            format!("it needs the tool that made it, {}", description.generation_tool),
        ));
    }
    let absolute = std::path::absolute(folder.path())
        .map_err(|e| InstanceError::load(name, format!("{}: {e}", folder.path().display())))?;
    let path = library::binary(name, &absolute, description.standard, &interface.model_identifier)?;
    mark.set(LOADING);
    let library = Arc::new(Library::load(name, &path, description.standard, folder)?);
    mark.set(NOWHERE);
    let setup = Setup {
        name: name.into(),
        interface,
        folder: absolute,
        instance_name: options
            .instance_name
            .clone()
            .unwrap_or_else(|| description.model_name.clone()),
        description,
        log: options.log,
        event_mode: options.event_mode,
        early_return: options.early_return,
        time_limit: options.time_limit,
        mark,
    };
    if exchange {
        return Err(InstanceError::unsupported(
            name,
            "run by model exchange",
            "this is not part of this version",
        ));
    }
    Ok(match setup.description.standard {
        Standard::Fmi2 => Box::new(CoSimulation::new(fmi2::Component::new(
            library,
            &setup,
            octant_fmi::fmi2::CO_SIMULATION,
        )?)),
        Standard::Fmi3 => Box::new(CoSimulation::new(fmi3::Component::new(
            library,
            &setup,
            fmi3::Use::CoSimulation,
        )?)),
    })
}

/// The interface that is used; true: it is model exchange.
fn interface(
    name: &str,
    description: &Description,
    kind: InterfaceKind,
) -> Result<(bool, Interface), InstanceError> {
    let co_simulation = description.co_simulation.clone().map(|interface| (false, interface));
    let exchange = description.model_exchange.clone().map(|interface| (true, interface));
    let (found, wanted) = match kind {
        InterfaceKind::Any => (co_simulation.or(exchange), "co-simulation or model exchange"),
        InterfaceKind::CoSimulation => (co_simulation, "co-simulation"),
        InterfaceKind::ModelExchange => (exchange, "model exchange"),
    };
    found.ok_or_else(|| {
        let mut has = Vec::new();
        for (there, what) in [
            (description.co_simulation.is_some(), "co-simulation"),
            (description.model_exchange.is_some(), "model exchange"),
            (description.scheduled_execution, "scheduled execution"),
        ] {
            if there {
                has.push(what);
            }
        }
        let has = if has.is_empty() { "no interface".into() } else { has.join(" and ") };
        InstanceError::unsupported(name, format!("run by {wanted}"), format!("it has {has}"))
    })
}

#[cfg(test)]
mod tests {
    use super::uri;
    use std::path::Path;

    #[cfg(unix)]
    #[test]
    fn paths_become_uris() {
        assert_eq!(uri(Path::new("/tmp/a b/ü#%/x")), "file:///tmp/a%20b/%C3%BC%23%25/x");
    }
}
