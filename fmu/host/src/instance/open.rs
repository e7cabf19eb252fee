//! Opening an FMU: its archive, its description, its library, an instance.

use super::super::archive::{Archive, ArchiveError, Unpacked};
use super::super::description::{
    self, Description, DescriptionError, Interface, Standard, VariableType,
};
#[cfg(feature = "model-exchange")]
use super::super::exchange::Exchange;
use super::super::library::{self, Library};
use super::super::process;
use super::call::{LOADING, Mark, NOWHERE};
use super::clocks::Clocks;
use super::co_simulation::CoSimulation;
use super::once::Once;
use super::options::{InterfaceKind, OpenOptions, ProcessPlace};
use super::scheduled::ScheduledExecution;
use super::setup::Setup;
use super::{Instance, InstanceError, fmi2, fmi3};
use octant_base::failing::{Failing, FailureKind};
use std::path::Path;
use std::sync::Arc;

/// Reason why an FMU can't be opened.
#[derive(Debug, thiserror::Error)]
pub enum FmuOpenError {
    /// Error of the archive.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// Error of the description.
    #[error(transparent)]
    Description(#[from] DescriptionError),
    /// Error of the code.
    #[error(transparent)]
    Instance(#[from] InstanceError),
}

impl Failing for FmuOpenError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Instance(error) => error.kind_of_opening(),
            Self::Archive(_) | Self::Description(_) => FailureKind::Input,
        }
    }
}

/// True if this program has the solver for model exchange.
pub const SOLVES: bool = cfg!(feature = "model-exchange");

/// Opens an FMU, or a folder with its unpacked content.
///
/// # Errors
/// If its archive or description can't be used, it lacks the interface, its library can't be
/// loaded, or it makes no instance.
pub fn open(path: &Path, options: &OpenOptions) -> Result<Box<dyn Instance>, FmuOpenError> {
    let mut archive = Archive::open(path)?;
    open_archive(&mut archive, options)
}

/// Opens an FMU whose archive is open, such as one in an SSP file.
///
/// # Errors
/// As [`open`].
pub fn open_archive(
    archive: &mut Archive,
    options: &OpenOptions,
) -> Result<Box<dyn Instance>, FmuOpenError> {
    // The description comes first, so that an FMU of FMI 1.0 is refused before gigabytes are
    // unpacked.
    let description = read_description(archive)?;
    let name = name_of(archive.file());
    let folder = archive.unpack()?;
    Ok(open_unpacked(&name, folder, Arc::new(description), options)?)
}

/// Opens the FMU in a folder that another process has unpacked and owns.
#[cfg(target_os = "linux")]
pub(crate) fn open_folder(
    name: &str,
    path: &Path,
    options: &OpenOptions,
    mark: Mark,
) -> Result<Box<dyn Instance>, FmuOpenError> {
    let mut archive = Archive::open(path)?;
    let description = read_description(&mut archive)?;
    let folder = archive.unpack()?;
    Ok(open_here(name, folder, Arc::new(description), options, mark)?)
}

pub(crate) fn read_description(archive: &mut Archive) -> Result<Description, FmuOpenError> {
    const NAME: &str = "modelDescription.xml";
    let bytes = archive.read(NAME)?;
    Ok(description::read_bytes(&bytes, &format!("{}/{NAME}", archive.file()))?)
}

/// Last part of a path: the name of the FMU in errors.
pub(crate) fn name_of(file: &str) -> String {
    let name = Path::new(file).file_name();
    name.map_or_else(|| file.into(), |name| name.to_string_lossy().into_owned())
}

/// Opens an unpacked FMU. `name` is its name in errors.
///
/// # Errors
/// If the FMU lacks the interface, its library can't be loaded, or it makes no instance.
pub fn open_unpacked(
    name: &str,
    folder: Unpacked,
    description: Arc<Description>,
    options: &OpenOptions,
) -> Result<Box<dyn Instance>, InstanceError> {
    match options.place {
        ProcessPlace::OwnProcess => process::open(name, folder, description, options),
        ProcessPlace::ThisProcess => open_here(name, folder, description, options, Mark::default()),
    }
}

/// Opens an unpacked FMU in this process.
pub(crate) fn open_here(
    name: &str,
    folder: Unpacked,
    description: Arc<Description>,
    options: &OpenOptions,
    mark: Mark,
) -> Result<Box<dyn Instance>, InstanceError> {
    let (purpose, interface) = interface(name, &description, options.interface)?;
    let exchange = purpose == fmi3::Use::ModelExchange;
    if exchange && cfg!(not(feature = "model-exchange")) {
        return Err(InstanceError::unsupported(
            name,
            "be run",
            format!(
                "{}this program was built without the solver for model exchange, expected one built with its default \
                 features, or with --features octant/model-exchange",
                match description.co_simulation {
                    Some(_) => "",
                    None => "it has model exchange and no co-simulation, and ",
                }
            ),
        ));
    }
    if interface.needs_execution_tool && !options.allow_tool {
        let tool = match &description.generation_tool[..] {
            "" => String::new(),
            tool => format!(", {tool}"),
        };
        let reason = format!(
            "it needs the tool that made it{tool}; where that is installed, --allow-tool runs it, or \
             allow_tool = true in a scenario"
        );
        return Err(InstanceError::unsupported(name, "be run", reason));
    }
    let clocks = description.variables.iter().any(|variable| variable.kind == VariableType::Clock);
    let steps = purpose == fmi3::Use::CoSimulation;
    if steps && clocks && !(options.event_mode && interface.event_mode) {
        return Err(InstanceError::unsupported(
            name,
            "run without event mode",
            "it has clocks, which tick at events",
        ));
    }
    if exchange && !Clocks::of(&description).is_empty() {
        return Err(InstanceError::unsupported(
            name,
            "run by model exchange",
            "it has clocks that tick in time, which tick in co-simulation alone",
        ));
    }
    let once = if interface.only_once_per_process {
        Some(Once::take(name, &description.token)?)
    } else {
        None
    };
    let absolute = std::path::absolute(folder.path())
        .map_err(|e| InstanceError::load(name, format!("{}: {e}", folder.path().display())))?;
    let path = library::binary(name, &absolute, description.standard, &interface.model_identifier)?;
    mark.set(LOADING);
    let library = Arc::new(Library::load(name, &path, description.standard, (folder, once))?);
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
    #[cfg(feature = "model-exchange")]
    if exchange {
        return exchanged(library, &setup);
    }
    if purpose == fmi3::Use::ScheduledExecution {
        return Ok(Box::new(ScheduledExecution::new(fmi3::Component::new(
            library, &setup, purpose,
        )?)));
    }
    Ok(match setup.description.standard {
        Standard::Fmi2 => Box::new(CoSimulation::new(fmi2::Component::new(
            library,
            &setup,
            octant_fmi::fmi2::CO_SIMULATION,
        )?)),
        Standard::Fmi3 => Box::new(CoSimulation::new(stepped(library, setup, purpose, clocks)?)),
    })
}

/// Makes an instance of FMI 3.0 for co-simulation. An FMU that declares event mode, and makes no
/// instance with it, is run without, unless it has clocks.
fn stepped(
    library: Arc<Library>,
    mut setup: Setup,
    purpose: fmi3::Use,
    clocks: bool,
) -> Result<fmi3::Component, InstanceError> {
    let made = fmi3::Component::new(Arc::clone(&library), &setup, purpose);
    let refused = match made {
        Err(InstanceError::Failed { said, .. })
            if setup.event_mode && setup.interface.event_mode && !clocks =>
        {
            said
        }
        made => return made,
    };
    setup.event_mode = false;
    let made = fmi3::Component::new(library, &setup, purpose)?;
    made.base.note(&format!(
        "it declares event mode (hasEventMode), and makes no instance with it{refused}; it is run without event mode"
    ));
    Ok(made)
}

/// Makes an instance by model exchange, with Octant's solver.
#[cfg(feature = "model-exchange")]
fn exchanged(library: Arc<Library>, setup: &Setup) -> Result<Box<dyn Instance>, InstanceError> {
    let tells_steps = setup.interface.completed_step_needed;
    Ok(match setup.description.standard {
        Standard::Fmi2 => Box::new(Exchange::new(
            fmi2::Component::new(library, setup, octant_fmi::fmi2::MODEL_EXCHANGE)?,
            tells_steps,
        )),
        Standard::Fmi3 => Box::new(Exchange::new(
            fmi3::Component::new(library, setup, fmi3::Use::ModelExchange)?,
            tells_steps,
        )),
    })
}

/// Chooses the interface.
fn interface(
    name: &str,
    description: &Description,
    kind: InterfaceKind,
) -> Result<(fmi3::Use, Interface), InstanceError> {
    let with = |interface: &Option<Interface>, purpose| {
        interface.clone().map(|interface| (purpose, interface))
    };
    let co_simulation = with(&description.co_simulation, fmi3::Use::CoSimulation);
    let exchange = with(&description.model_exchange, fmi3::Use::ModelExchange);
    let scheduled = with(&description.scheduled_execution, fmi3::Use::ScheduledExecution);
    let (found, wanted) = match kind {
        InterfaceKind::Any => (co_simulation.or(exchange), "co-simulation or model exchange"),
        InterfaceKind::CoSimulation => (co_simulation, "co-simulation"),
        InterfaceKind::ModelExchange => (exchange, "model exchange"),
        InterfaceKind::ScheduledExecution => (scheduled, "scheduled execution"),
    };
    found.ok_or_else(|| {
        let mut has = Vec::new();
        for (there, what) in [
            (description.co_simulation.is_some(), "co-simulation"),
            (description.model_exchange.is_some(), "model exchange"),
            (description.scheduled_execution.is_some(), "scheduled execution"),
        ] {
            if there {
                has.push(what);
            }
        }
        let only = has == ["scheduled execution"];
        let has = if has.is_empty() { "no interface".into() } else { has.join(" and ") };
        let hint = match only {
            true => ", by which octant fmu run --interface scheduled-execution runs it",
            false => "",
        };
        InstanceError::unsupported(name, format!("run by {wanted}"), format!("it has {has}{hint}"))
    })
}
