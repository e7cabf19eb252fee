//! Flattens a structure into FMUs, wires from FMU to FMU, and parameters of FMUs.

use super::ssp::SspError;
use super::ssp::parameters::{Literal, Transformation};
use super::ssp::structure::{
    Binding, Connection, ConnectionEnd, Connector, ConnectorKind, Implementation, SspSystem,
    SystemComponent, SystemElement, SystemStructure,
};
use octant_base::names::suggestion;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// System of FMUs without nested systems.
#[derive(Clone, Debug, PartialEq)]
pub struct Flat {
    /// The FMUs.
    pub components: Vec<FlatComponent>,
    /// Wires from connector to connector.
    pub wires: Vec<FlatWire>,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// An FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatComponent {
    /// Name: `plant`, within a system `ship.plant`.
    pub name: String,
    /// The FMU.
    pub file: PathBuf,
    /// The FMU as the structure names it.
    pub source: String,
    /// Interface to use.
    pub implementation: Implementation,
    /// Connectors that the structure names.
    pub connectors: Vec<Connector>,
    /// Values for variables of the FMU; the last of a name counts.
    pub parameters: Vec<FlatParameter>,
    /// Line of the structure.
    pub line: u32,
}

/// A value for a variable of an FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatParameter {
    /// The variable.
    pub name: String,
    /// The value.
    pub value: Literal,
    /// Connections that the value passes on its way.
    pub hops: Vec<Hop>,
    /// File that contains it.
    pub file: String,
    /// Line in that file.
    pub line: u32,
}

/// A connector of an FMU.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FmuConnector {
    /// Number of the FMU.
    pub component: usize,
    /// The connector.
    pub connector: String,
}

/// A connection from FMU to FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatWire {
    /// Source of the values.
    pub from: FmuConnector,
    /// Kind of that connector.
    pub from_kind: ConnectorKind,
    /// Destination of the values.
    pub to: FmuConnector,
    /// Kind of that connector.
    pub to_kind: ConnectorKind,
    /// Operations on values on their way, one for each connection.
    pub hops: Vec<Hop>,
    /// Line of the last connection.
    pub line: u32,
}

/// One connection on the way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hop {
    /// True if units are not converted.
    pub suppress_unit_conversion: bool,
    /// Transformation of the values.
    pub transformation: Option<Transformation>,
    /// Unit of the system's connector at the end of the connection, if there is one and the
    /// structure states it.
    pub unit: Option<String>,
}

/// Element of the whole structure, with its path.
struct Element<'a> {
    path: String,
    connectors: &'a [Connector],
    component: Option<usize>,
}

/// Connector of an element: element, name.
type Place = (usize, String);

struct Edge {
    from: Place,
    hop: Hop,
    line: u32,
    /// Number of the connection, in the order of the file.
    number: usize,
}

struct Flattener<'a> {
    file: &'a str,
    elements: Vec<Element<'a>>,
    components: Vec<FlatComponent>,
    /// Connection from which each connector gets its values.
    into: BTreeMap<Place, Edge>,
    /// Values given to connectors of systems.
    boundary: BTreeMap<Place, FlatParameter>,
    warnings: Vec<String>,
}

impl Flat {
    /// Flattens a structure.
    ///
    /// # Errors
    /// If a connection names a missing connector, or joins connectors that can't be connected.
    pub fn of(structure: &SystemStructure) -> Result<Self, SspError> {
        let mut flattener = Flattener {
            file: &structure.file,
            elements: Vec::new(),
            components: Vec::new(),
            into: BTreeMap::new(),
            boundary: BTreeMap::new(),
            warnings: Vec::new(),
        };
        flattener.system(&structure.system, "")?;
        if flattener.components.is_empty() {
            return Err(SspError::of_file(&structure.file, "the system has no FMU"));
        }
        let wires = flattener.wires()?;
        Ok(Self { components: flattener.components, wires, warnings: flattener.warnings })
    }
}

impl<'a> Flattener<'a> {
    fn error(&self, line: u32, element: &str, message: String) -> SspError {
        SspError {
            file: self.file.to_owned(),
            line: Some(line),
            element: element.to_owned(),
            message,
        }
    }

    /// Adds a system and its contents; returns its number.
    fn system(&mut self, system: &'a SspSystem, path: &str) -> Result<usize, SspError> {
        let number = self.elements.len();
        let connectors = &system.connectors;
        self.elements.push(Element { path: path.to_owned(), connectors, component: None });
        let mut parts: Vec<(&str, usize)> = Vec::new();
        for part in &system.elements {
            let inner = join(path, part.name());
            let element = match part {
                SystemElement::System(system) => self.system(system, &inner)?,
                SystemElement::Component(component) => self.component(component, inner),
            };
            parts.push((part.name(), element));
        }
        for connection in &system.connections {
            self.connection(connection, number, &parts)?;
        }
        // Values of the surrounding systems come later, and win.
        for binding in &system.bindings {
            for parameter in self.bound(binding) {
                self.give(number, &parts, parameter);
            }
        }
        Ok(number)
    }

    fn component(&mut self, component: &'a SystemComponent, path: String) -> usize {
        let parameters =
            component.bindings.iter().flat_map(|binding| self.bound(binding)).collect();
        self.elements.push(Element {
            path: path.clone(),
            connectors: &component.connectors,
            component: Some(self.components.len()),
        });
        self.components.push(FlatComponent {
            name: path,
            file: component.file.clone(),
            source: component.source.clone(),
            implementation: component.implementation,
            connectors: component.connectors.clone(),
            parameters,
            line: component.line,
        });
        self.elements.len() - 1
    }

    /// Returns the values of a binding under their names in the element.
    fn bound(&mut self, binding: &Binding) -> Vec<FlatParameter> {
        let mut all = Vec::new();
        let mut used = vec![false; binding.mapping.as_ref().map_or(0, |m| m.entries.len())];
        for parameter in &binding.values.parameters {
            let name = format!("{}{}", binding.prefix, parameter.name);
            let mut give = |name: String, hops: Vec<Hop>| {
                all.push(FlatParameter {
                    name,
                    value: parameter.value.clone(),
                    hops,
                    file: binding.values.file.clone(),
                    line: parameter.line,
                });
            };
            let Some(mapping) = &binding.mapping else {
                give(name, Vec::new());
                continue;
            };
            let mut mapped = false;
            for (entry, used) in mapping.entries.iter().zip(&mut used) {
                if entry.source == name {
                    (mapped, *used) = (true, true);
                    let hop = Hop {
                        suppress_unit_conversion: entry.suppress_unit_conversion,
                        transformation: entry.transformation.clone(),
                        unit: None,
                    };
                    give(entry.target.clone(), vec![hop]);
                }
            }
            if !mapped {
                self.warnings.push(format!(
                    "{}:{}: the parameter {name:?} has no entry in {}, and is not used",
                    binding.values.file, parameter.line, mapping.file
                ));
            }
        }
        for (entry, used) in binding.mapping.iter().flat_map(|m| &m.entries).zip(used) {
            if !used {
                self.warnings.push(format!(
                    "{}:{}: no parameter {:?} is in {}",
                    binding.mapping.as_ref().map_or("", |m| &m.file),
                    entry.line,
                    entry.source,
                    binding.values.file
                ));
            }
        }
        all
    }

    /// Gives a value of a system's binding to its connector, or to an element inside it.
    fn give(&mut self, system: usize, parts: &[(&str, usize)], mut parameter: FlatParameter) {
        if self.elements[system].connectors.iter().any(|c| c.name == parameter.name) {
            self.boundary.insert((system, parameter.name.clone()), parameter);
            return;
        }
        // The longest match, because names of elements may contain dots.
        let inner = parts
            .iter()
            .filter_map(|(name, element)| {
                let rest = parameter.name.strip_prefix(name)?.strip_prefix('.')?;
                Some((name.len(), *element, rest.to_owned()))
            })
            .max_by_key(|(length, ..)| *length);
        let Some((_, element, rest)) = inner else {
            let of = &self.elements[system].path;
            let of = if of.is_empty() { "the system" } else { of };
            self.warnings.push(format!(
                "{}:{}: {:?} is nothing in {of}, and is not used",
                parameter.file, parameter.line, parameter.name
            ));
            return;
        };
        parameter.name = rest;
        match self.elements[element].component {
            Some(component) => self.components[component].parameters.push(parameter),
            None => {
                let path = format!("{}.", self.elements[element].path);
                let parts: Vec<(String, usize)> = (0..self.elements.len())
                    .filter_map(|inner| {
                        let name = self.elements[inner].path.strip_prefix(&path)?;
                        Some((name.to_owned(), inner))
                    })
                    .collect();
                let parts: Vec<(&str, usize)> =
                    parts.iter().map(|(name, element)| (name.as_str(), *element)).collect();
                self.give(element, &parts, parameter);
            }
        }
    }

    fn connection(
        &mut self,
        connection: &Connection,
        system: usize,
        parts: &[(&str, usize)],
    ) -> Result<(), SspError> {
        let (start, start_gives) = self.end(connection, &connection.start, system, parts)?;
        let (end, end_gives) = self.end(connection, &connection.end, system, parts)?;
        let (from, to) = match (start_gives, end_gives) {
            (true, false) => (start, end),
            (false, true) => (end, start),
            (both, _) => {
                let what =
                    if both { "give values and none takes" } else { "take values and none gives" };
                let message = format!(
                    "{} and {} both {what} them: an output is connected with an input, or a \
                     system's connector with one of the same kind in it",
                    connection.start, connection.end
                );
                return Err(self.error(connection.line, "Connection", message));
            }
        };
        let hop = Hop {
            suppress_unit_conversion: connection.suppress_unit_conversion,
            transformation: connection.transformation.clone(),
            unit: match self.elements[to.0].component {
                Some(_) => None,
                None => self
                    .connector(&to)
                    .and_then(|connector| connector.of_type.as_ref()?.unit.clone()),
            },
        };
        if let Some(other) = self.into.get(&to) {
            let message = format!(
                "{} gets its values from the connection in line {} already",
                if connection.end.connector == to.1 { &connection.end } else { &connection.start },
                other.line
            );
            return Err(self.error(connection.line, "Connection", message));
        }
        let number = self.into.len();
        self.into.insert(to, Edge { from, hop, line: connection.line, number });
        Ok(())
    }

    fn connector(&self, (element, name): &Place) -> Option<&'a Connector> {
        self.elements[*element].connectors.iter().find(|connector| connector.name == *name)
    }

    /// Resolves an end of a connection; true if values come out of it, seen from within the system.
    fn end(
        &self,
        connection: &Connection,
        end: &ConnectionEnd,
        system: usize,
        parts: &[(&str, usize)],
    ) -> Result<(Place, bool), SspError> {
        let element = match &end.element {
            None => system,
            Some(name) => {
                let found = parts.iter().find(|(known, _)| known == name);
                let Some((_, element)) = found else {
                    let known = suggestion(name, parts.iter().map(|(name, _)| *name), "elements");
                    let message = format!("the element {name:?} isn't there, {known}");
                    return Err(self.error(connection.line, "Connection", message));
                };
                *element
            }
        };
        let place = (element, end.connector.clone());
        let Some(connector) = self.connector(&place) else {
            let names = self.elements[element].connectors.iter().map(|c| c.name.as_str());
            let of = end.element.as_deref().unwrap_or("the system");
            let message = format!(
                "{of} has no connector {:?}, {}",
                end.connector,
                suggestion(&end.connector, names, "connectors")
            );
            return Err(self.error(connection.line, "Connection", message));
        };
        let gives = connector.kind.gives() != (element == system);
        Ok((place, gives))
    }

    /// Follows connections back through systems to the FMUs.
    fn wires(&mut self) -> Result<Vec<FlatWire>, SspError> {
        let mut wires: Vec<(usize, FlatWire)> = Vec::new();
        let mut given: Vec<(usize, FlatParameter)> = Vec::new();
        let sinks: Vec<(&Place, usize)> = self
            .into
            .keys()
            .filter_map(|place| Some((place, self.elements[place.0].component?)))
            .collect();
        for (sink, component) in sinks {
            let Some(last) = self.into.get(sink) else { continue };
            let mut hops = vec![last.hop.clone()];
            let mut at = &last.from;
            let source = loop {
                if let Some(source) = self.elements[at.0].component {
                    break Some(source);
                }
                let Some(edge) = self.into.get(at) else { break None };
                hops.insert(0, edge.hop.clone());
                at = &edge.from;
                if hops.len() > self.into.len() {
                    let message = "connections of systems' own connectors form a circle".to_owned();
                    return Err(self.error(edge.line, "Connection", message));
                }
            };
            let Some(source) = source else {
                // No connection ends here: a value of a binding is the start value.
                if let Some(value) = self.boundary.get(at) {
                    let mut value = value.clone();
                    value.name.clone_from(&sink.1);
                    value.hops.extend(hops);
                    given.push((component, value));
                }
                continue;
            };
            let (Some(from), Some(to)) = (self.connector(at), self.connector(sink)) else {
                continue;
            };
            let changes = from.kind == ConnectorKind::Output || from.kind == ConnectorKind::Local;
            let fixed = match to.kind {
                ConnectorKind::StructuralParameter => true,
                ConnectorKind::Parameter => changes,
                _ => false,
            };
            if fixed {
                let message = format!(
                    "{}.{} is of kind {}, which can't give values to {}.{} of kind {}",
                    self.components[source].name,
                    at.1,
                    from.kind.name(),
                    self.components[component].name,
                    sink.1,
                    to.kind.name()
                );
                return Err(self.error(last.line, "Connection", message));
            }
            let wire = FlatWire {
                from: FmuConnector { component: source, connector: at.1.clone() },
                from_kind: from.kind,
                to: FmuConnector { component, connector: sink.1.clone() },
                to_kind: to.kind,
                hops,
                line: last.line,
            };
            wires.push((last.number, wire));
        }
        // Sorted into the order of the file.
        wires.sort_by_key(|(number, _)| *number);
        for (component, parameter) in given {
            self.components[component].parameters.push(parameter);
        }
        Ok(wires.into_iter().map(|(_, wire)| wire).collect())
    }
}

fn join(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}
