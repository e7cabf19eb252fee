//! Components that are systems: an `.ssd` of the package, or a package within it.

use super::{ELEMENT, Reader, SspError, SspSystem, SystemElement, SystemStructure};
use crate::ssp::connectors::connectors;
use crate::ssp::parameters::SystemEnumeration;
use crate::ssp::xml::Element;
use octant_fmu_host::description::BaseUnit;

impl Reader<'_> {
    /// Reads a component that is a system. Its experiment and its annotations are those of a system that
    /// runs alone, and aren't used.
    pub(super) fn nested(
        &self,
        element: &Element<'_>,
        is_package: bool,
        depth: usize,
    ) -> Result<SspSystem, SspError> {
        element.only(&["name", "type", "source", "implementation"], &ELEMENT)?;
        let Some(source) = element.optional("source") else {
            return Err(element.error("it has no source: there is no system to be run"));
        };
        let path =
            self.package.resolve(source).map_err(|error| element.error(error.to_string()))?;
        let part = self.package.open_part(&path, is_package)?;
        let read = SystemStructure::read_at(&part, depth)?;
        self.package.warnings.extend(read.warnings);
        self.define(element, read.units, read.enumerations)?;
        let mut system = read.system;
        element.required("name")?.clone_into(&mut system.name);
        for outer in connectors(element, self.units, false)? {
            if !system.connectors.iter().any(|inner| inner.name == outer.name) {
                return Err(element.error(format!(
                    "it has the connector {:?}, which the system in {source} doesn't have",
                    outer.name
                )));
            }
        }
        // The outer binding wins, and the later does.
        system.bindings.extend(self.bindings(element, Some(source))?);
        // Messages about the flat system name this file.
        place(&mut system, element.line());
        self.package.keep(part);
        Ok(system)
    }

    /// Takes units and enumerations of a part; one name has one meaning in the whole structure.
    fn define(
        &self,
        element: &Element<'_>,
        units: Vec<(String, BaseUnit)>,
        enumerations: Vec<SystemEnumeration>,
    ) -> Result<(), SspError> {
        let mut all = self.parts.borrow_mut();
        for (name, meaning) in units {
            let known = self.units.iter().chain(&all.units).find(|(known, _)| *known == name);
            match known {
                Some((_, other)) if *other != meaning => {
                    return Err(element.error(format!(
                        "the unit {name:?} has another meaning in this system than outside of it"
                    )));
                }
                Some(_) => {}
                None => all.units.push((name, meaning)),
            }
        }
        for enumeration in enumerations {
            match all.enumerations.iter().find(|known| known.name == enumeration.name) {
                Some(other) if *other != enumeration => {
                    return Err(element.error(format!(
                        "the enumeration {:?} has other items in this system than in another",
                        enumeration.name
                    )));
                }
                Some(_) => {}
                None => all.enumerations.push(enumeration),
            }
        }
        Ok(())
    }
}

/// Gives everything in a system the line of the component that it is.
fn place(system: &mut SspSystem, line: u32) {
    system.line = line;
    system.connectors.iter_mut().for_each(|connector| connector.line = line);
    system.connections.iter_mut().for_each(|connection| connection.line = line);
    for element in &mut system.elements {
        match element {
            SystemElement::Component(component) => {
                component.line = line;
                component.connectors.iter_mut().for_each(|connector| connector.line = line);
            }
            SystemElement::System(inner) => place(inner, line),
            SystemElement::Dictionary(reference) => {
                reference.line = line;
                reference.connectors.iter_mut().for_each(|connector| connector.line = line);
            }
        }
    }
}
