//! Opens the FMUs of a system.

use super::flat::Flat;
use super::ssp::SspError;
use super::ssp::structure::{Implementation, SystemStructure};
use octant_fmu_host::description::Description;
use octant_fmu_host::instance::{Instance, InterfaceKind, OpenOptions, ProcessPlace, open};

/// Returns whether an FMU is run by model exchange.
pub(super) fn is_exchange(description: &Description, implementation: Implementation) -> bool {
    match implementation {
        Implementation::Any => description.co_simulation.is_none(),
        Implementation::CoSimulation => false,
        Implementation::ModelExchange => true,
    }
}

/// Opens all FMUs, in the order of the components.
pub(super) fn open_all(
    structure: &SystemStructure,
    flat: &Flat,
    place: ProcessPlace,
    allow_tool: bool,
) -> Result<Vec<Box<dyn Instance>>, SspError> {
    let mut instances = Vec::with_capacity(flat.components.len());
    for component in &flat.components {
        let options = OpenOptions {
            interface: match component.implementation {
                Implementation::Any => InterfaceKind::Any,
                Implementation::CoSimulation => InterfaceKind::CoSimulation,
                Implementation::ModelExchange => InterfaceKind::ModelExchange,
            },
            place,
            allow_tool,
            instance_name: Some(component.name.clone()),
            ..OpenOptions::default()
        };
        let opened = open::open(&component.file, &options).map_err(|error| SspError {
            file: structure.file.clone(),
            line: Some(component.line),
            element: format!("Component {:?}", component.name),
            message: format!("failed to open the FMU: {error}"),
        })?;
        let description = opened.description();
        let interfaces = [&description.co_simulation, &description.model_exchange];
        let once = interfaces.into_iter().flatten().any(|one| one.only_once_per_process);
        let others = &flat.components[..instances.len()];
        if let Some(other) = others.iter().find(|other| other.file == component.file)
            && once
            && place == ProcessPlace::ThisProcess
        {
            return Err(SspError {
                file: structure.file.clone(),
                line: Some(component.line),
                element: format!("Component {:?}", component.name),
                message: format!(
                    "{} can be there once in a process, and {:?} is it already: leave out \
                     --in-process",
                    component.source, other.name
                ),
            });
        }
        instances.push(opened);
    }
    Ok(instances)
}
