//! Flattens a structure into FMUs, wires from FMU to FMU, and parameters of FMUs.

mod dictionaries;
mod parts;

pub use parts::{
    Flat, FlatComponent, FlatParameter, FlatReference, FlatWire, FmuConnector, Hop, HopEntry,
};

use super::ssp::SspError;
use super::ssp::structure::{
    Binding, Connection, ConnectionEnd, Connector, ConnectorKind, SignalDictionary, SspSystem,
    SystemComponent, SystemElement, SystemStructure,
};
use octant_base::names::suggestion;
use parts::Direction;
use std::collections::BTreeMap;

/// Element of the whole structure, with its path.
struct Element<'a> {
    path: String,
    connectors: &'a [Connector],
    component: Option<usize>,
    role: Role<'a>,
}

/// Kind of an element that is neither an FMU nor a system.
#[derive(Clone, Copy)]
enum Role<'a> {
    /// An FMU or a system.
    Plain,
    /// A signal dictionary: its connectors are its entries.
    Dictionary(&'a SignalDictionary),
    /// Reference to the dictionary with this number.
    Reference(usize),
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
    /// Dictionaries of the system and of those around it, the innermost last: name, number.
    scopes: Vec<(&'a str, usize)>,
    references: Vec<FlatReference>,
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
            scopes: Vec::new(),
            references: Vec::new(),
            warnings: Vec::new(),
        };
        flattener.system(&structure.system, "")?;
        if flattener.components.is_empty() {
            return Err(SspError::of_file(&structure.file, "the system has no FMU"));
        }
        let wires = flattener.wires()?;
        let Flattener { components, references, warnings, .. } = flattener;
        Ok(Self { components, wires, references, warnings })
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
        let role = Role::Plain;
        self.elements.push(Element { path: path.to_owned(), connectors, component: None, role });
        let around = self.scopes.len();
        self.dictionaries(system, path);
        let mut parts: Vec<(&str, usize)> = Vec::new();
        for part in &system.elements {
            let inner = join(path, part.name());
            let element = match part {
                SystemElement::System(system) => self.system(system, &inner)?,
                SystemElement::Component(component) => self.component(component, inner),
                SystemElement::Dictionary(reference) => self.reference(reference, inner)?,
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
        self.scopes.truncate(around);
        Ok(number)
    }

    fn component(&mut self, component: &'a SystemComponent, path: String) -> usize {
        let parameters =
            component.bindings.iter().flat_map(|binding| self.bound(binding)).collect();
        self.elements.push(Element {
            path: path.clone(),
            connectors: &component.connectors,
            component: Some(self.components.len()),
            role: Role::Plain,
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
                        entry: None,
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
            self.boundary.insert(self.meant((system, parameter.name.clone())), parameter);
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
                        let element = &self.elements[inner];
                        let name = element.path.strip_prefix(&path)?;
                        // Dictionaries have no place of their own among the elements.
                        let is_part = !matches!(element.role, Role::Dictionary(_));
                        is_part.then(|| (name.to_owned(), inner))
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
        let (start, start_is) = self.end(connection, &connection.start, system, parts)?;
        let (end, end_is) = self.end(connection, &connection.end, system, parts)?;
        let forward = Direction::forward(start_is, end_is).map_err(|reason| {
            let message = format!("{} and {} {reason}", connection.start, connection.end);
            self.error(connection.line, "Connection", message)
        })?;
        let (from, to) = if forward { (start, end) } else { (end, start) };
        if from == to {
            let message = format!("{} is connected with itself", self.named(&from));
            return Err(self.error(connection.line, "Connection", message));
        }
        let hop = Hop {
            suppress_unit_conversion: connection.suppress_unit_conversion,
            transformation: connection.transformation.clone(),
            unit: match self.elements[to.0].component {
                Some(_) => None,
                None => self
                    .connector(&to)
                    .and_then(|connector| connector.of_type.as_ref()?.unit.clone()),
            },
            entry: self.entry(&to),
        };
        if let Some(other) = self.into.get(&to) {
            let message = match hop.entry {
                Some(entry) => format!(
                    "{entry} is written by {}, and by {} in line {} already: expected one writer",
                    self.named(&from),
                    self.named(&other.from),
                    other.line
                ),
                None => format!(
                    "{} gets its values from the connection in line {} already",
                    if forward { &connection.end } else { &connection.start },
                    other.line
                ),
            };
            return Err(self.error(connection.line, "Connection", message));
        }
        let number = self.into.len();
        self.into.insert(to, Edge { from, hop, line: connection.line, number });
        Ok(())
    }

    fn connector(&self, (element, name): &Place) -> Option<&'a Connector> {
        self.elements[*element].connectors.iter().find(|connector| connector.name == *name)
    }

    /// Resolves an end of a connection, with the direction of values seen from within the system.
    fn end(
        &self,
        connection: &Connection,
        end: &ConnectionEnd,
        system: usize,
        parts: &[(&str, usize)],
    ) -> Result<(Place, Direction), SspError> {
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
        let direction = match connector.kind {
            ConnectorKind::Inout => Direction::Either,
            kind if kind.gives() != (element == system) => Direction::Gives,
            _ => Direction::Takes,
        };
        Ok((self.meant(place), direction))
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
                    let message = "connections of systems' own connectors, or of entries of \
                                   signal dictionaries, form a circle"
                        .to_owned();
                    return Err(self.error(edge.line, "Connection", message));
                }
            };
            let Some(source) = source else {
                // No connection ends here: a value of a binding is the start value.
                if let Some(entry) = self.entry(at) {
                    self.warnings.push(format!(
                        "{entry} has a reader, {}, and no writer: expected a connection into the \
                         entry; the input keeps its start value",
                        self.named(sink)
                    ));
                }
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
