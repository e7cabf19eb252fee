//! Resolves wires between names to wires between numbers: finds connectors in the descriptions of
//! the FMUs, with the conversion of values on the way.

pub use super::elements::{element_names, index_of, position};

use super::convert::{Terminal, WireConversion, WireUnit};
use super::elements::{Found, element_name, find};
use super::flat::{Flat, FlatComponent, FlatWire, FmuConnector};
use super::references;
use super::ssp::SspError;
use super::ssp::structure::{Connector, ConnectorKind, SystemStructure};
use super::values::{is_float, is_numeric, kind_name};
use octant_fmu_host::description::{Causality, Description, Variability, Variable, VariableType};
use octant_fmu_host::instance::{AccessPlan, InstanceError, VariableGroup};

/// System of FMUs, ready to be initialized.
#[derive(Clone, Debug)]
pub struct System {
    /// The FMUs.
    pub nodes: Vec<SystemNode>,
    /// Every number that is passed between FMUs at each communication point.
    pub wires: Vec<NumberPath>,
    /// Numbers passed from calculated parameters to parameters, during initialization only.
    pub fixed: Vec<NumberPath>,
    /// Texts and bytes that are passed.
    pub texts: Vec<TextWire>,
}

/// An FMU of a system.
#[derive(Clone, Debug)]
pub struct SystemNode {
    /// Name in the system.
    pub name: String,
    /// Variables that get values at every communication point.
    pub inputs: ExchangeSide,
    /// Variables that get values only during initialization.
    pub fixed: ExchangeSide,
    /// Variables whose values go to other FMUs.
    pub outputs: ExchangeSide,
    /// Unconnected outputs that are only recorded.
    pub watched: ExchangeSide,
    /// Groups of all outputs that are numbers, the connected ones first: they are read with every
    /// step.
    pub read: Vec<VariableGroup>,
    /// Outputs that are texts or bytes, with their indices in the description.
    pub written: Vec<(usize, VariableGroup)>,
}

/// Variables of an FMU that are exchanged together, whole numbers of 64 bits as their bits, and the
/// places of their numbers.
#[derive(Clone, Debug, Default)]
pub struct ExchangeSide {
    /// Indices of the variables in the description.
    pub variables: Vec<usize>,
    /// Groups and places.
    pub plan: AccessPlan,
}

/// Place of a number: FMU, and index on that side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spot {
    /// Number of the FMU.
    pub node: usize,
    /// Place among the numbers of the side.
    pub place: usize,
}

/// Number on its way from an output to an input.
#[derive(Clone, Debug)]
pub struct NumberPath {
    /// Place of the output.
    pub from: Spot,
    /// Place of the input.
    pub to: Spot,
    /// Conversion on the way.
    pub conversion: WireConversion,
    /// True if the output is a floating-point number, which may be none (NaN).
    pub is_real: bool,
    /// Name of the output: `plant.imu.valid`, with the element of an array: `plant.x[2]`.
    pub source: String,
    /// Name of the input.
    pub target: String,
    /// Unit of the input.
    pub unit: Option<WireUnit>,
    /// Values and names of the input's enumeration.
    pub items: Vec<(i64, String)>,
}

/// Text, or bytes, on the way.
#[derive(Clone, Debug)]
pub struct TextWire {
    /// FMU and variable of the output.
    pub from: (usize, VariableGroup),
    /// FMU and variable of the input.
    pub to: (usize, VariableGroup),
    /// True for the bytes of a Binary.
    pub binary: bool,
    /// Name of the output.
    pub source: String,
    /// Name of the input.
    pub target: String,
}

impl System {
    /// Finds the connectors of a system in the descriptions of its FMUs, in their order. Variables
    /// in `also` are read at every step even if they are unconnected.
    ///
    /// # Errors
    /// If a connector isn't there, or differs from the structure, or values can't pass along a
    /// connection.
    pub fn new(
        structure: &SystemStructure,
        flat: &Flat,
        descriptions: &[&Description],
        also: &[(usize, String)],
    ) -> Result<Self, SspError> {
        references::check(structure, flat)?;
        let builder = Builder { structure, flat, descriptions };
        for (number, component) in flat.components.iter().enumerate() {
            for connector in &component.connectors {
                builder.check(number, component, connector)?;
            }
        }
        // Variables on each side of each FMU.
        let mut sides = vec![[const { Vec::new() }; 3]; descriptions.len()];
        let mut add = |port: &FmuConnector, side: usize| -> Result<(), SspError> {
            let found = builder.find(port)?;
            let list: &mut Vec<usize> = &mut sides[port.component][side];
            if is_numeric(found.variable.kind) && !list.contains(&found.number) {
                list.push(found.number);
            }
            Ok(())
        };
        for wire in &flat.wires {
            add(&wire.from, 2)?;
            add(&wire.to, if is_fixed(wire) { 1 } else { 0 })?;
        }
        for (component, connector) in also {
            add(&FmuConnector { component: *component, connector: connector.clone() }, 2)?;
        }
        let mut nodes = Vec::with_capacity(descriptions.len());
        for ((component, description), [inputs, fixed, outputs]) in
            flat.components.iter().zip(descriptions).zip(sides)
        {
            let watched = description.variables.iter().enumerate().filter(|(number, variable)| {
                variable.causality == Causality::Output
                    && is_numeric(variable.kind)
                    && !outputs.contains(number)
            });
            let watched = watched.map(|(number, _)| number).collect();
            let side = |variables: Vec<usize>| {
                ExchangeSide::new(description, variables)
                    .map_err(|error| builder.of_component(component, error.to_string()))
            };
            let (outputs, watched) = (side(outputs)?, side(watched)?);
            let read = [&outputs, &watched].map(|side| side.plan.groups.clone()).concat();
            let written = description.variables.iter().enumerate().filter(|(_, variable)| {
                // Clocked texts have values at the ticks of their clock alone.
                variable.causality == Causality::Output
                    && matches!(variable.kind, VariableType::String | VariableType::Binary)
                    && variable.clocks.is_empty()
            });
            let written = written.map(|(number, variable)| {
                VariableGroup::of(description, variable).map(|group| (number, group))
            });
            let written = written
                .collect::<Result<_, InstanceError>>()
                .map_err(|error| builder.of_component(component, error.to_string()))?;
            nodes.push(SystemNode {
                name: component.name.clone(),
                inputs: side(inputs)?,
                fixed: side(fixed)?,
                outputs,
                watched,
                read,
                written,
            });
        }
        let mut system = Self { nodes, wires: Vec::new(), fixed: Vec::new(), texts: Vec::new() };
        for wire in &flat.wires {
            builder.wire(wire, &mut system)?;
        }
        Ok(system)
    }
}

impl System {
    /// Returns place and variable of an output that is read at every step.
    #[must_use]
    pub fn output<'a>(
        &self,
        node: usize,
        name: &str,
        description: &'a Description,
    ) -> Option<(Spot, &'a Variable)> {
        let found = find(description, name).ok().filter(|found| found.count == 1)?;
        let place = self.nodes.get(node)?.outputs.place(found.number)? + found.first;
        Some((Spot { node, place }, found.variable))
    }
}

/// Returns whether a wire carries values during initialization only.
fn is_fixed(wire: &FlatWire) -> bool {
    wire.to_kind == ConnectorKind::Parameter
}

impl ExchangeSide {
    /// Groups the variables of these indices.
    ///
    /// # Errors
    /// If the size of an array can't be determined.
    pub fn new(description: &Description, variables: Vec<usize>) -> Result<Self, InstanceError> {
        let list: Vec<&Variable> =
            variables.iter().map(|number| &description.variables[*number]).collect();
        let plan = AccessPlan::exactly(description, &list)?;
        Ok(Self { variables, plan })
    }

    /// Returns the place of a variable's first element.
    fn place(&self, number: usize) -> Option<usize> {
        let at = self.variables.iter().position(|known| *known == number)?;
        Some(self.plan.places.get(at)?.start)
    }
}

struct Builder<'a> {
    structure: &'a SystemStructure,
    flat: &'a Flat,
    descriptions: &'a [&'a Description],
}

impl<'a> Builder<'a> {
    fn error(&self, line: u32, element: String, message: String) -> SspError {
        SspError { file: self.structure.file.clone(), line: Some(line), element, message }
    }

    fn of_component(&self, component: &FlatComponent, message: String) -> SspError {
        self.error(component.line, format!("Component {:?}", component.name), message)
    }

    /// Checks that the connector is a variable of the FMU, of the kind and type that the structure
    /// states.
    fn check(
        &self,
        number: usize,
        component: &FlatComponent,
        connector: &Connector,
    ) -> Result<(), SspError> {
        let port = FmuConnector { component: number, connector: connector.name.clone() };
        let element = format!("Connector {:?} of {}", connector.name, component.name);
        let error = |message: String| self.error(connector.line, element.clone(), message);
        let found = self.find(&port)?;
        let variable = found.variable;
        use ConnectorKind as Of;
        let fits = match connector.kind {
            Of::Input => variable.causality == Causality::Input,
            Of::Output => variable.causality == Causality::Output,
            Of::Parameter => variable.causality == Causality::Parameter,
            Of::CalculatedParameter => variable.causality == Causality::CalculatedParameter,
            Of::StructuralParameter => variable.causality == Causality::StructuralParameter,
            Of::Constant => variable.variability == Variability::Constant,
            Of::Local => variable.causality == Causality::Local,
            // The reader takes this kind at references to signal dictionaries alone.
            Of::Inout => false,
        };
        if !fits {
            return Err(error(format!(
                "it is of kind {}, and the variable of {} has causality {:?}",
                connector.kind.name(),
                component.source,
                variable.causality
            )));
        }
        if !connector.dimensions.is_empty() {
            let sizes: Option<Vec<u64>> = connector.dimensions.iter().copied().collect();
            let count: Option<u64> = sizes.map(|sizes| sizes.iter().product());
            if count.is_some_and(|count| count != found.count as u64) {
                return Err(error(format!(
                    "it has {} elements, and the variable of {} has {}",
                    count.unwrap_or_default(),
                    component.source,
                    found.count
                )));
            }
        }
        let Some(of_type) = &connector.of_type else { return Ok(()) };
        let whole = is_numeric(variable.kind)
            && !matches!(
                variable.kind,
                VariableType::Boolean | VariableType::Float64 | VariableType::Float32
            );
        let fits = match of_type.name.as_str() {
            // SSP 1.0 has one name for all types of a sort.
            "Real" => matches!(variable.kind, VariableType::Float64 | VariableType::Float32),
            "Integer" => whole,
            _ => variable.kind == of_type.kind,
        };
        if !fits {
            return Err(error(format!(
                "it is of type {}, and the variable of {} is a {}",
                of_type.name,
                component.source,
                kind_name(variable.kind)
            )));
        }
        let own = WireUnit::of_variable(self.descriptions[number], variable);
        if let (Some(said), Some(own)) = (&of_type.unit, own) {
            let said = WireUnit::named(said, &self.structure.units);
            let same = said.to(&own).map_err(|reason| error(reason.to_string()))?;
            if !same.is_identity() && (same.factor - 1.0).abs() + same.offset.abs() > 1e-9 {
                return Err(error(format!(
                    "it is in {:?}, and the variable of {} is in {:?}",
                    said.name, component.source, own.name
                )));
            }
        }
        Ok(())
    }

    fn connector(&self, port: &FmuConnector) -> Option<&'a Connector> {
        let connectors = &self.flat.components[port.component].connectors;
        connectors.iter().find(|connector| connector.name == port.connector)
    }

    /// Finds the variable behind a connector: by its name, or as an element of an array, `x[2]`,
    /// `m[1,3]`.
    fn find(&self, port: &FmuConnector) -> Result<Found<'a>, SspError> {
        let component = &self.flat.components[port.component];
        let line = self.connector(port).map_or(component.line, |connector| connector.line);
        let element = format!("Connector {:?} of {}", port.connector, component.name);
        find(self.descriptions[port.component], &port.connector).map_err(|message| {
            self.error(line, element, format!("{}: {message}", component.source))
        })
    }

    fn terminal(&self, port: &FmuConnector, found: &Found<'a>) -> Terminal<'a> {
        let description = self.descriptions[port.component];
        let of_type = self.connector(port).and_then(|connector| connector.of_type.as_ref());
        let said = of_type.and_then(|of_type| of_type.unit.as_ref());
        let unit = WireUnit::of_variable(description, found.variable)
            .or_else(|| said.map(|name| WireUnit::named(name, &self.structure.units)));
        let items = found.variable.enumeration.as_ref();
        let enumeration = of_type.and_then(|of_type| of_type.enumeration.as_ref());
        let all = &self.structure.enumerations;
        Terminal {
            kind: found.variable.kind,
            unit,
            items: items.and_then(|name| description.enumeration(name)).unwrap_or_default(),
            enumeration: enumeration.and_then(|name| all.iter().find(|one| one.name == *name)),
        }
    }

    /// Adds the numbers, or the text, of a wire.
    fn wire(&self, wire: &FlatWire, system: &mut System) -> Result<(), SspError> {
        let (from, to) = (self.find(&wire.from)?, self.find(&wire.to)?);
        let names = |port: &FmuConnector| {
            format!("{}.{}", self.flat.components[port.component].name, port.connector)
        };
        let (source, target) = (names(&wire.from), names(&wire.to));
        let error = |message: String| {
            self.error(wire.line, format!("Connection {source} -> {target}"), message)
        };
        if from.count != to.count {
            return Err(error(format!(
                "the output has {} elements and the input {}: expected the same number",
                from.count, to.count
            )));
        }
        references::sizes(&wire.hops, from.count).map_err(&error)?;
        let (a, b) = (self.terminal(&wire.from, &from), self.terminal(&wire.to, &to));
        let conversion = WireConversion::of(&a, &b, &wire.hops, &self.structure.units)
            .map_err(|reason| error(reason.to_string()))?;
        let (a_node, b_node) = (wire.from.component, wire.to.component);
        if !is_numeric(to.variable.kind) {
            let group = |node: usize, variable: &Variable| {
                VariableGroup::of(self.descriptions[node], variable)
                    .map_err(|e| error(e.to_string()))
            };
            system.texts.push(TextWire {
                from: (a_node, group(a_node, from.variable)?),
                to: (b_node, group(b_node, to.variable)?),
                binary: to.variable.kind == VariableType::Binary,
                source: source.clone(),
                target: target.clone(),
            });
            return Ok(());
        }
        let (nodes, fixed) = (&system.nodes, is_fixed(wire));
        let side = if fixed { &nodes[b_node].fixed } else { &nodes[b_node].inputs };
        let (Some(out), Some(into)) =
            (nodes[a_node].outputs.place(from.number), side.place(to.number))
        else {
            return Err(error("its variables are not exchanged".to_owned()));
        };
        let description = |port: &FmuConnector| self.descriptions[port.component];
        let list = if fixed { &mut system.fixed } else { &mut system.wires };
        for element in 0..from.count {
            let name = |port: &FmuConnector, found: &Found<'_>| {
                let of = &self.flat.components[port.component].name;
                let element = element_name(description(port), found, element, &port.connector);
                format!("{of}.{element}")
            };
            list.push(NumberPath {
                from: Spot { node: a_node, place: out + from.first + element },
                to: Spot { node: b_node, place: into + to.first + element },
                conversion: conversion.clone(),
                is_real: is_float(from.variable.kind),
                source: name(&wire.from, &from),
                target: name(&wire.to, &to),
                unit: b.unit.clone(),
                items: b.items.to_vec(),
            });
        }
        Ok(())
    }
}
