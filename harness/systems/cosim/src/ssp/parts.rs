//! Parts of a system structure: systems, components, signal dictionaries, connectors, connections
//! and bindings.

use super::parameters::{ParameterMapping, ParameterSet, SystemEnumeration, Transformation};
use octant_fmu_host::description::{BaseUnit, VariableType};
use std::path::PathBuf;

/// System: elements and their connections.
#[derive(Clone, Debug, PartialEq)]
pub struct SspSystem {
    /// Name; the outermost system may have any.
    pub name: String,
    /// Interface.
    pub connectors: Vec<Connector>,
    /// Contents.
    pub elements: Vec<SystemElement>,
    /// Connections among its elements and with its own interface.
    pub connections: Vec<Connection>,
    /// Parameter bindings of the system.
    pub bindings: Vec<Binding>,
    /// Signal dictionaries for references in this system, and in systems within it.
    pub dictionaries: Vec<SignalDictionary>,
    /// Line of the file.
    pub line: u32,
}

/// Collection of signals that systems at any level read and write by their names.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalDictionary {
    /// Name by which references find it.
    pub name: String,
    /// File that contains its entries: that of the structure, or an `.ssb`.
    pub file: String,
    /// Its signals: connectors of kind inout, with a type each.
    pub entries: Vec<Connector>,
    /// Units that it defines.
    pub units: Vec<(String, BaseUnit)>,
    /// Enumerations that it defines.
    pub enumerations: Vec<SystemEnumeration>,
}

/// Place of a signal dictionary in a system: its connectors are entries of the dictionary.
#[derive(Clone, Debug, PartialEq)]
pub struct DictionaryReference {
    /// Name.
    pub name: String,
    /// Name of the dictionary in this system or one around it.
    pub dictionary: String,
    /// Entries that connections of this system use.
    pub connectors: Vec<Connector>,
    /// Parameter bindings: start values of entries that nothing writes.
    pub bindings: Vec<Binding>,
    /// Line of the file.
    pub line: u32,
}

/// An element of a system.
#[derive(Clone, Debug, PartialEq)]
pub enum SystemElement {
    /// An FMU.
    Component(SystemComponent),
    /// Nested system.
    System(SspSystem),
    /// Reference to a signal dictionary.
    Dictionary(DictionaryReference),
}

impl SystemElement {
    /// Returns the name.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Component(component) => &component.name,
            Self::System(system) => &system.name,
            Self::Dictionary(reference) => &reference.name,
        }
    }

    /// Returns the connectors.
    #[must_use]
    pub fn connectors(&self) -> &[Connector] {
        match self {
            Self::Component(component) => &component.connectors,
            Self::System(system) => &system.connectors,
            Self::Dictionary(reference) => &reference.connectors,
        }
    }
}

/// An FMU of a system.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemComponent {
    /// Name.
    pub name: String,
    /// The FMU.
    pub file: PathBuf,
    /// The FMU as the structure names it.
    pub source: String,
    /// Interface to use.
    pub implementation: Implementation,
    /// Interface, as far as the structure names it.
    pub connectors: Vec<Connector>,
    /// Parameter bindings of the component.
    pub bindings: Vec<Binding>,
    /// Line of the file.
    pub line: u32,
}

/// Interface of an FMU that is to be used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Implementation {
    /// This program's choice: co-simulation if the FMU has it.
    #[default]
    Any,
    /// Co-simulation.
    CoSimulation,
    /// Model exchange.
    ModelExchange,
}

/// Kind of a connector.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "named as in the standard")]
pub enum ConnectorKind {
    Input,
    Output,
    Parameter,
    CalculatedParameter,
    StructuralParameter,
    Constant,
    Local,
    Inout,
}

impl ConnectorKind {
    /// Returns the name in the standard.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Input => "input",
            Self::Output => "output",
            Self::Parameter => "parameter",
            Self::CalculatedParameter => "calculatedParameter",
            Self::StructuralParameter => "structuralParameter",
            Self::Constant => "constant",
            Self::Local => "local",
            Self::Inout => "inout",
        }
    }

    /// True if values come out of the connector, seen from outside its element.
    #[must_use]
    pub const fn gives(self) -> bool {
        matches!(self, Self::Output | Self::CalculatedParameter | Self::Constant | Self::Local)
    }
}

/// A connector.
#[derive(Clone, Debug, PartialEq)]
pub struct Connector {
    /// Name; for FMUs, that of the variable.
    pub name: String,
    /// Kind of the connector.
    pub kind: ConnectorKind,
    /// Type; `None` if it is that of the variable behind it.
    pub of_type: Option<ConnectorType>,
    /// Dimensions, where the file says them (SSP 2.0).
    pub dimensions: Vec<Option<u64>>,
    /// Line of the file.
    pub line: u32,
}

/// Type of a connector.
#[derive(Clone, Debug, PartialEq)]
pub struct ConnectorType {
    /// Name in the file: `Real`.
    pub name: String,
    /// The type.
    pub kind: VariableType,
    /// Name of the unit.
    pub unit: Option<String>,
    /// Name of the enumeration.
    pub enumeration: Option<String>,
}

/// An end of a connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConnectionEnd {
    /// The element; `None`: the system itself.
    pub element: Option<String>,
    /// The connector.
    pub connector: String,
}

impl std::fmt::Display for ConnectionEnd {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.element {
            Some(element) => write!(f, "{element}.{}", self.connector),
            None => f.write_str(&self.connector),
        }
    }
}

/// Connection; the direction of values follows from the connectors.
#[derive(Clone, Debug, PartialEq)]
pub struct Connection {
    /// One end.
    pub start: ConnectionEnd,
    /// The other end.
    pub end: ConnectionEnd,
    /// True if units are not converted.
    pub suppress_unit_conversion: bool,
    /// Transformation of the values.
    pub transformation: Option<Transformation>,
    /// Line of the file.
    pub line: u32,
}

/// Parameter binding: values, and the mapping of their names and values.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding {
    /// The values.
    pub values: ParameterSet,
    /// The mapping.
    pub mapping: Option<ParameterMapping>,
    /// Prefix of each name.
    pub prefix: String,
    /// Line of the file.
    pub line: u32,
}
