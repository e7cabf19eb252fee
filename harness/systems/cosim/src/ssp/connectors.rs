//! Connectors of elements, and the types of these and of entries of signal dictionaries.

use super::SspError;
use super::parameters::kind_named;
use super::parts::{Connector, ConnectorKind, ConnectorType};
use super::xml::{Element, SSC, SSD};
use octant_fmu_host::description::{BaseUnit, VariableType};

/// Reads the connectors of an element; `inout` tells whether that kind may occur, as it does at
/// references to signal dictionaries.
pub(super) fn connectors(
    element: &Element<'_>,
    units: &[(String, BaseUnit)],
    inout: bool,
) -> Result<Vec<Connector>, SspError> {
    let Some(list) = element.child(SSD, "Connectors")? else { return Ok(Vec::new()) };
    list.only(&[], &[(SSD, "Connector")])?;
    let mut connectors: Vec<Connector> = Vec::new();
    for element in list.children().filter(|child| child.is(SSD, "Connector")) {
        let kind = kind(&element, inout)?;
        element.only(&["name", "kind"], &types(&element))?;
        let read = typed(&element, kind, units)?;
        if connectors.iter().any(|known| known.name == read.name) {
            return Err(element.error("found a second time, expected unique names"));
        }
        connectors.push(read);
    }
    Ok(connectors)
}

fn kind(element: &Element<'_>, inout: bool) -> Result<ConnectorKind, SspError> {
    Ok(match element.required("kind")? {
        "input" => ConnectorKind::Input,
        "output" => ConnectorKind::Output,
        "parameter" => ConnectorKind::Parameter,
        "calculatedParameter" => ConnectorKind::CalculatedParameter,
        "structuralParameter" => ConnectorKind::StructuralParameter,
        "constant" => ConnectorKind::Constant,
        "local" => ConnectorKind::Local,
        "inout" if inout => ConnectorKind::Inout,
        other => {
            let also = if inout { ", inout" } else { "" };
            return Err(element.error(format!(
                "the kind {other:?} was found, expected input, output{also}, parameter, \
                 calculatedParameter, structuralParameter, constant or local"
            )));
        }
    })
}

/// Lists the elements that a connector, or an entry of a dictionary, may have for its type.
pub(super) fn types(element: &Element<'_>) -> Vec<(&'static str, &'static str)> {
    const TYPES: [&str; 17] = [
        "Real",
        "Float64",
        "Float32",
        "Integer",
        "Int8",
        "UInt8",
        "Int16",
        "UInt16",
        "Int32",
        "UInt32",
        "Int64",
        "UInt64",
        "Boolean",
        "String",
        "Enumeration",
        "Binary",
        "Dimension",
    ];
    // A clock has a message of its own.
    let has_clock = element.children().any(|child| child.name() == "Clock");
    let clock = has_clock.then_some((SSC, "Clock"));
    TYPES.iter().map(|name| (SSC, *name)).chain(clock).collect()
}

/// Reads name, type and dimensions of a connector, or of an entry of a dictionary.
pub(super) fn typed(
    element: &Element<'_>,
    kind: ConnectorKind,
    units: &[(String, BaseUnit)],
) -> Result<Connector, SspError> {
    let mut connector = Connector {
        name: element.required("name")?.to_owned(),
        kind,
        of_type: None,
        dimensions: Vec::new(),
        line: element.line(),
    };
    for child in element.children() {
        if child.name() == "Clock" {
            return Err(child.error("clocks are not part of this version"));
        }
        if child.is(SSC, "Dimension") {
            child.only(&["size", "sizeConnector"], &[])?;
            let size = child.integer("size")?;
            connector.dimensions.push(size.and_then(|size| u64::try_from(size).ok()));
            continue;
        }
        let Some(kind) = kind_named(child.name()).filter(|_| child.is(SSC, child.name())) else {
            // Geometry and the like.
            continue;
        };
        child.only(&["unit", "name", "mime-type"], &[])?;
        if connector.of_type.is_some() {
            return Err(child.error("found a second type, expected one"));
        }
        let enumeration = child.optional("name").map(str::to_owned);
        if kind == VariableType::Enumeration && enumeration.is_none() {
            return Err(child.error("the attribute \"name\" is missing"));
        }
        connector.of_type = Some(ConnectorType {
            name: child.name().to_owned(),
            kind,
            unit: child.unit(units).map(|(name, _)| name.to_owned()),
            enumeration,
        });
    }
    Ok(connector)
}
