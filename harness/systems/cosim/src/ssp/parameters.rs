//! Reads the parts that the SSP formats share: parameter sets, parameter mappings, transformations,
//! units and enumerations.

use super::super::values::has;
use super::SspError;
use super::xml::{self, Element, SSC, SSM, SSV};
use octant_fmu_host::description::{BaseUnit, VariableType};
use octant_fmu_host::instance::whole;

/// Parameter set: an `.ssv` file, or inline content.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterSet {
    /// File that contains it.
    pub file: String,
    /// The parameters in the order of the file.
    pub parameters: Vec<SystemParameter>,
}

/// A parameter with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemParameter {
    /// Name, without the prefix of a binding.
    pub name: String,
    /// Value.
    pub value: Literal,
    /// Line of the file.
    pub line: u32,
}

/// Value as it stands in a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Literal {
    /// Type in the file.
    pub kind: VariableType,
    /// Numbers, Booleans as 0 and 1, whole numbers of 64 bits as their bits; empty for texts, enumerations and bytes.
    pub numbers: Vec<f64>,
    /// Text, name of an item, or bytes in hexadecimal digits; empty for numbers.
    pub text: String,
    /// Name of the unit, and its meaning in SI.
    pub unit: Option<(String, BaseUnit)>,
}

/// Parameter mapping: an `.ssm` file, or inline content.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterMapping {
    /// File that contains it.
    pub file: String,
    /// The entries in the order of the file.
    pub entries: Vec<MappingEntry>,
}

/// An entry of a parameter mapping.
#[derive(Clone, Debug, PartialEq)]
pub struct MappingEntry {
    /// Name in the parameter set, with the prefix of the binding.
    pub source: String,
    /// Name in the component or system.
    pub target: String,
    /// True if units are not converted.
    pub suppress_unit_conversion: bool,
    /// Transformation of the value.
    pub transformation: Option<Transformation>,
    /// Line of the file.
    pub line: u32,
}

/// Transformation of a value on its way, after the conversion of units.
#[derive(Clone, Debug, PartialEq)]
pub enum Transformation {
    /// target = factor · source + offset.
    Linear {
        /// Factor.
        factor: f64,
        /// Offset.
        offset: f64,
    },
    /// Booleans: results for false and for true; `None` if there is no entry.
    Boolean([Option<bool>; 2]),
    /// Whole numbers, and values of enumerations: source and target.
    Integer(Vec<(i64, i64)>),
    /// Items of enumerations by name: source and target.
    Enumeration(Vec<(String, String)>),
}

impl Transformation {
    /// Returns the name of the transformation's element.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Linear { .. } => "LinearTransformation",
            Self::Boolean(_) => "BooleanMappingTransformation",
            Self::Integer(_) => "IntegerMappingTransformation",
            Self::Enumeration(_) => "EnumerationMappingTransformation",
        }
    }
}

/// An enumeration: its name, and names and values of its items.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemEnumeration {
    /// Name.
    pub name: String,
    /// Names and values of its items.
    pub items: Vec<(String, i64)>,
}

/// Elements that hold a transformation.
pub(super) const TRANSFORMATIONS: [(&str, &str); 4] = [
    (SSC, "LinearTransformation"),
    (SSC, "BooleanMappingTransformation"),
    (SSC, "IntegerMappingTransformation"),
    (SSC, "EnumerationMappingTransformation"),
];

/// Returns the type of an SSP type name. `Real` and `Integer` are those of SSP 1.0.
pub(super) fn kind_named(name: &str) -> Option<VariableType> {
    Some(match name {
        "Real" | "Float64" => VariableType::Float64,
        "Float32" => VariableType::Float32,
        "Integer" | "Int32" => VariableType::Int32,
        "Int8" => VariableType::Int8,
        "UInt8" => VariableType::UInt8,
        "Int16" => VariableType::Int16,
        "UInt16" => VariableType::UInt16,
        "UInt32" => VariableType::UInt32,
        "Int64" => VariableType::Int64,
        "UInt64" => VariableType::UInt64,
        "Boolean" => VariableType::Boolean,
        "String" => VariableType::String,
        "Binary" => VariableType::Binary,
        "Enumeration" => VariableType::Enumeration,
        _ => return None,
    })
}

/// Checks the version of a file.
pub(super) fn version(root: &Element<'_>) -> Result<(), SspError> {
    match root.required("version")? {
        // 2.0 adds types, arrays and clocks; unknown ones are refused where they occur.
        "1.0" | "2.0" => Ok(()),
        other => Err(root.error(format!(
            "version {other:?} was found; this program reads 1.0, and of 2.0 what is scalar or an \
             array of fixed size"
        ))),
    }
}

/// Attributes of the root of a file that is no structure.
pub(super) const TOP: [&str; 8] = [
    "version",
    "name",
    "author",
    "fileversion",
    "copyright",
    "license",
    "generationTool",
    "generationDateAndTime",
];

/// Reads a `ParameterSet`; `outer` are units of the structure in which it stands.
pub(super) fn parameter_set(
    root: &Element<'_>,
    outer: &[(String, BaseUnit)],
) -> Result<ParameterSet, SspError> {
    root.expect(SSV, "ParameterSet")?;
    version(root)?;
    root.only(&TOP, &[(SSV, "Parameters"), (SSV, "Enumerations"), (SSV, "Units")])?;
    let mut units = match root.child(SSV, "Units")? {
        Some(units) => self::units(&units)?,
        None => Vec::new(),
    };
    // Units of its own come first.
    units.extend_from_slice(outer);
    let mut set = ParameterSet { file: root.file.to_owned(), parameters: Vec::new() };
    let Some(parameters) = root.child(SSV, "Parameters")? else {
        return Err(root.error("the element <Parameters> is missing"));
    };
    parameters.only(&[], &[(SSV, "Parameter")])?;
    for element in parameters.children().filter(|child| child.is(SSV, "Parameter")) {
        element.only(&["name"], &PARAMETER_TYPES)?;
        let mut of_type = element.children().filter(|child| kind_named(child.name()).is_some());
        let Some(value) = of_type.next() else {
            return Err(
                element.error("found no value, expected an element such as <Real value=…/>")
            );
        };
        if let Some(second) = of_type.next() {
            return Err(second.error("found a second value, expected one"));
        }
        set.parameters.push(SystemParameter {
            name: element.required("name")?.to_owned(),
            value: literal(&value, &units)?,
            line: element.line(),
        });
    }
    Ok(set)
}

const PARAMETER_TYPES: [(&str, &str); 16] = [
    (SSV, "Real"),
    (SSV, "Float64"),
    (SSV, "Float32"),
    (SSV, "Integer"),
    (SSV, "Int8"),
    (SSV, "UInt8"),
    (SSV, "Int16"),
    (SSV, "UInt16"),
    (SSV, "Int32"),
    (SSV, "UInt32"),
    (SSV, "Int64"),
    (SSV, "UInt64"),
    (SSV, "Boolean"),
    (SSV, "String"),
    (SSV, "Enumeration"),
    (SSV, "Binary"),
];

fn literal(element: &Element<'_>, units: &[(String, BaseUnit)]) -> Result<Literal, SspError> {
    let name = element.name();
    let kind = kind_named(name).ok_or_else(|| element.error("not a type"))?;
    element.only(&["value", "unit", "name", "mime-type"], &[])?;
    let text = element.required("value")?;
    let unit = element.unit(units).and_then(|(name, of)| Some((name.to_owned(), *of.first()?)));
    let mut literal = Literal { kind, numbers: Vec::new(), text: String::new(), unit };
    match kind {
        VariableType::String | VariableType::Enumeration | VariableType::Binary => {
            literal.text = text.to_owned()
        }
        _ => {
            for part in text.split_ascii_whitespace() {
                literal.numbers.push(number(part, kind).ok_or_else(|| {
                    element.error(format!("value is {part:?}, expected one of type {name}"))
                })?);
            }
            if literal.numbers.is_empty() {
                return Err(element.error(format!("value is empty, expected one of type {name}")));
            }
        }
    }
    Ok(literal)
}

/// Parses a number of a type, a whole number of 64 bits as its bits.
pub(crate) fn number(text: &str, kind: VariableType) -> Option<f64> {
    match kind {
        VariableType::Float64 | VariableType::Float32 => xml::double(text),
        VariableType::Boolean => xml::boolean(text).map(|value| f64::from(u8::from(value))),
        _ => {
            let value: i128 = text.trim().parse().ok()?;
            if whole::is_wide(kind) {
                return whole::to_bits(kind, value);
            }
            has(kind, value).then_some(value as f64)
        }
    }
}

/// Reads a `ParameterMapping`.
pub(super) fn mapping(root: &Element<'_>) -> Result<ParameterMapping, SspError> {
    root.expect(SSM, "ParameterMapping")?;
    version(root)?;
    root.only(&TOP, &[(SSM, "MappingEntry")])?;
    let mut mapping = ParameterMapping { file: root.file.to_owned(), entries: Vec::new() };
    for entry in root.children().filter(|child| child.is(SSM, "MappingEntry")) {
        entry.only(&["source", "target", "suppressUnitConversion"], &TRANSFORMATIONS)?;
        mapping.entries.push(MappingEntry {
            source: entry.required("source")?.to_owned(),
            target: entry.required("target")?.to_owned(),
            suppress_unit_conversion: entry.boolean("suppressUnitConversion")?.unwrap_or(false),
            transformation: transformation(&entry)?,
            line: entry.line(),
        });
    }
    Ok(mapping)
}

/// Reads the transformation in an element, if there is one.
pub(super) fn transformation(parent: &Element<'_>) -> Result<Option<Transformation>, SspError> {
    let mut found = None;
    for child in parent.children() {
        let Some((_, name)) = TRANSFORMATIONS.iter().find(|(space, name)| child.is(space, name))
        else {
            continue;
        };
        if found.is_some() {
            return Err(child.error("found a second transformation, expected one"));
        }
        found = Some(if *name == "LinearTransformation" {
            child.only(&["factor", "offset"], &[])?;
            Transformation::Linear {
                factor: child.finite("factor")?.unwrap_or(1.0),
                offset: child.finite("offset")?.unwrap_or(0.0),
            }
        } else {
            child.only(&[], &[(SSC, "MapEntry")])?;
            map_entries(&child)?
        });
    }
    Ok(found)
}

fn map_entries(table: &Element<'_>) -> Result<Transformation, SspError> {
    let entries = || table.children().filter(|child| child.is(SSC, "MapEntry"));
    for entry in entries() {
        entry.only(&["source", "target"], &[])?;
    }
    let twice = |entry: &Element<'_>| {
        let found = entry.optional("source").unwrap_or_default();
        entry.error(format!("the source {found:?} has an entry already"))
    };
    let needed = |entry: &Element<'_>, name: &str| {
        entry
            .integer(name)?
            .ok_or_else(|| entry.error(format!("the attribute {name:?} is missing")))
    };
    Ok(match table.name() {
        "BooleanMappingTransformation" => {
            let mut to = [None; 2];
            for entry in entries() {
                let missing = || entry.error("source and target are expected, true or false");
                let source = entry.boolean("source")?.ok_or_else(missing)?;
                let target = entry.boolean("target")?.ok_or_else(missing)?;
                if to[usize::from(source)].replace(target).is_some() {
                    return Err(twice(&entry));
                }
            }
            Transformation::Boolean(to)
        }
        "IntegerMappingTransformation" => {
            let mut to: Vec<(i64, i64)> = Vec::new();
            for entry in entries() {
                let source = needed(&entry, "source")?;
                if to.iter().any(|(known, _)| *known == source) {
                    return Err(twice(&entry));
                }
                to.push((source, needed(&entry, "target")?));
            }
            Transformation::Integer(to)
        }
        _ => {
            let mut to: Vec<(String, String)> = Vec::new();
            for entry in entries() {
                let source = entry.required("source")?;
                if to.iter().any(|(known, _)| known == source) {
                    return Err(twice(&entry));
                }
                to.push((source.to_owned(), entry.required("target")?.to_owned()));
            }
            Transformation::Enumeration(to)
        }
    })
}

/// Reads `Units`: names, and their meanings in SI.
pub(super) fn units(parent: &Element<'_>) -> Result<Vec<(String, BaseUnit)>, SspError> {
    const EXPONENTS: [&str; 8] = ["kg", "m", "s", "A", "K", "mol", "cd", "rad"];
    parent.only(&[], &[(SSC, "Unit")])?;
    let mut units: Vec<(String, BaseUnit)> = Vec::new();
    for unit in parent.children().filter(|child| child.is(SSC, "Unit")) {
        unit.only(&["name"], &[(SSC, "BaseUnit")])?;
        let name = unit.required("name")?;
        if name.is_empty() {
            unit.warn("a unit without a name: it is left out");
            continue;
        }
        if units.iter().any(|(known, _)| known == name) {
            return Err(unit.error("found a second time, expected unique names"));
        }
        let Some(base) = unit.child(SSC, "BaseUnit")? else {
            return Err(unit.error("the element <BaseUnit> is missing"));
        };
        let mut attributes = EXPONENTS.to_vec();
        attributes.extend(["factor", "offset"]);
        base.only(&attributes, &[])?;
        let mut exponents = [0i8; 8];
        for (exponent, name) in exponents.iter_mut().zip(EXPONENTS) {
            let value = base.integer(name)?.unwrap_or(0);
            *exponent = i8::try_from(value).map_err(|_| {
                base.error(format!("{name} is {value}, expected an exponent from -128 to 127"))
            })?;
        }
        let factor = base.finite("factor")?.unwrap_or(1.0);
        if factor == 0.0 {
            return Err(base.error("factor is 0, expected another number"));
        }
        let offset = base.finite("offset")?.unwrap_or(0.0);
        units.push((name.to_owned(), BaseUnit { exponents, factor, offset }));
    }
    Ok(units)
}

/// Reads `Enumerations`.
pub(super) fn enumerations(parent: &Element<'_>) -> Result<Vec<SystemEnumeration>, SspError> {
    parent.only(&[], &[(SSC, "Enumeration")])?;
    let mut all: Vec<SystemEnumeration> = Vec::new();
    for element in parent.children().filter(|child| child.is(SSC, "Enumeration")) {
        element.only(&["name"], &[(SSC, "Item")])?;
        let name = element.required("name")?;
        if all.iter().any(|known| known.name == name) {
            return Err(element.error("found a second time, expected unique names"));
        }
        let mut items = Vec::new();
        for item in element.children().filter(|child| child.is(SSC, "Item")) {
            item.only(&["name", "value"], &[])?;
            let value = item
                .integer("value")?
                .ok_or_else(|| item.error("the attribute \"value\" is missing"))?;
            items.push((item.required("name")?.to_owned(), value));
        }
        all.push(SystemEnumeration { name: name.to_owned(), items });
    }
    Ok(all)
}
