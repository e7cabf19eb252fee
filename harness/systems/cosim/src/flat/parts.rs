//! Parts of a flattened system: FMUs, wires, and the entries of dictionaries on their way.

use crate::ssp::parameters::{Literal, Transformation};
use crate::ssp::structure::{Connector, ConnectorKind, Implementation, SignalDictionary};
use octant_fmu_host::description::{BaseUnit, VariableType};
use std::fmt;
use std::path::PathBuf;

/// System of FMUs without nested systems.
#[derive(Clone, Debug, PartialEq)]
pub struct Flat {
    /// The FMUs.
    pub components: Vec<FlatComponent>,
    /// Wires from connector to connector.
    pub wires: Vec<FlatWire>,
    /// Places of signal dictionaries.
    pub references: Vec<FlatReference>,
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
    /// Entry of a signal dictionary at the end of the connection.
    pub entry: Option<HopEntry>,
}

/// An entry of a signal dictionary, which values pass on their way.
#[derive(Clone, Debug, PartialEq)]
pub struct HopEntry {
    /// Name.
    pub name: String,
    /// Name of the dictionary, with the path of its system.
    pub dictionary: String,
    /// Type.
    pub kind: VariableType,
    /// Meaning of its unit, where the dictionary defines it.
    pub meaning: Option<BaseUnit>,
    /// Values and names of its enumeration.
    pub items: Vec<(i64, String)>,
    /// Dimensions; `None`: unknown.
    pub dimensions: Vec<Option<u64>>,
    /// File that contains it.
    pub file: String,
    /// Line in that file.
    pub line: u32,
}

impl HopEntry {
    /// Describes an entry of a dictionary, whose path is given.
    #[must_use]
    pub fn of(path: &str, dictionary: &SignalDictionary, entry: &Connector) -> Self {
        let of_type = entry.of_type.as_ref();
        let unit = of_type.and_then(|of_type| of_type.unit.as_ref());
        let defined = |name: &String| dictionary.units.iter().find(|(known, _)| *known == *name);
        let enumeration = of_type.and_then(|of_type| of_type.enumeration.as_ref());
        let named =
            |name: &String| dictionary.enumerations.iter().find(|known| known.name == *name);
        let items = enumeration.and_then(named).map_or(&[][..], |found| &found.items);
        Self {
            name: entry.name.clone(),
            dictionary: path.to_owned(),
            kind: match of_type {
                // `Real` and `Integer` stand for all types of their sort: the widest is passed.
                Some(of_type) if of_type.name == "Integer" => VariableType::Int64,
                Some(of_type) => of_type.kind,
                None => VariableType::Float64,
            },
            meaning: unit.and_then(defined).map(|(_, base)| *base),
            items: items.iter().map(|(name, value)| (*value, name.clone())).collect(),
            dimensions: entry.dimensions.clone(),
            file: dictionary.file.clone(),
            line: entry.line,
        }
    }
}

impl fmt::Display for HopEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, dictionary, file, line, .. } = self;
        write!(f, "the entry {name:?} of the signal dictionary {dictionary} ({file}:{line})")
    }
}

/// Place of a signal dictionary in a system.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatReference {
    /// Name, with the path of its system.
    pub name: String,
    /// Connectors of the place, each with the entry of the same name.
    pub connectors: Vec<(Connector, Connector)>,
    /// Name of the dictionary, with the path of its system.
    pub dictionary: String,
    /// Units that the dictionary defines.
    pub units: Vec<(String, BaseUnit)>,
}

/// Direction of values at an end of a connection, seen from within the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// Values come out.
    Gives,
    /// Values go in.
    Takes,
    /// Direction of the other end of the connection (kind inout).
    Either,
}

impl Direction {
    /// Returns whether values go from the start of a connection to its end, or why they can't go.
    pub(crate) fn forward(start: Self, end: Self) -> Result<bool, &'static str> {
        match (start, end) {
            (Self::Gives, Self::Takes | Self::Either) | (Self::Either, Self::Takes) => Ok(true),
            (Self::Takes, Self::Gives | Self::Either) | (Self::Either, Self::Gives) => Ok(false),
            (Self::Gives, Self::Gives) => Err(
                "both give values and none takes them: an output is connected with an input, or a \
                 system's connector with one of the same kind in it",
            ),
            (Self::Takes, Self::Takes) => Err(
                "both take values and none gives them: an output is connected with an input, or a \
                 system's connector with one of the same kind in it",
            ),
            (Self::Either, Self::Either) => Err(
                "are both of kind inout, which leaves the direction open: expected one of kind \
                 input or output",
            ),
        }
    }
}
