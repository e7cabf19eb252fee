//! Opens the FMUs of a system.

use super::flat::Flat;
use super::ssp::SspError;
use super::ssp::structure::{Implementation, SystemStructure};
use octant_fmu_bind::OpenedFmus;
use octant_fmu_host::description::Description;
use octant_fmu_host::instance::{Instance, InterfaceKind, OpenOptions, ProcessPlace};
use octant_fmu_host::{FmuOpenError, OpenedFmu};

/// Returns whether an FMU is run by model exchange.
pub(super) fn is_exchange(description: &Description, implementation: Implementation) -> bool {
    match implementation {
        Implementation::Any => description.co_simulation.is_none(),
        Implementation::CoSimulation => false,
        Implementation::ModelExchange => true,
    }
}

/// The FMUs of a system, in the order of its components.
pub(super) struct OpenedSystem {
    pub(super) instances: Vec<Box<dyn Instance>>,
    pub(super) fmus: Vec<OpenedFmu>,
}

/// Opens all FMUs, each file once.
pub(super) fn open_all(
    structure: &SystemStructure,
    flat: &Flat,
    common: &OpenOptions,
) -> Result<OpenedSystem, SspError> {
    let files = OpenedFmus::default();
    let mut instances = Vec::with_capacity(flat.components.len());
    let mut fmus = Vec::with_capacity(flat.components.len());
    for component in &flat.components {
        let failed = |message: String| SspError {
            file: structure.file.clone(),
            line: Some(component.line),
            element: format!("Component {:?}", component.name),
            message,
        };
        let cannot = |error: FmuOpenError| failed(format!("failed to open the FMU: {error}"));
        let fmu = files.file(&component.file).map_err(cannot)?;
        let others = &flat.components[..instances.len()];
        if let Some(other) = others.iter().find(|other| other.file == component.file)
            && fmu.only_once_per_process()
            && common.place == ProcessPlace::ThisProcess
        {
            return Err(failed(format!(
                "{} can be there once in a process, and {:?} is it already: leave out \
                 --in-process",
                component.source, other.name
            )));
        }
        let options = OpenOptions {
            interface: match component.implementation {
                Implementation::Any => InterfaceKind::Any,
                Implementation::CoSimulation => InterfaceKind::CoSimulation,
                Implementation::ModelExchange => InterfaceKind::ModelExchange,
            },
            instance_name: Some(component.name.clone()),
            ..common.clone()
        };
        instances.push(fmu.instance(&options).map_err(cannot)?);
        fmus.push(fmu);
    }
    Ok(OpenedSystem { instances, fmus })
}
