//! Checks references to signal dictionaries: type, unit and size of each connector against those of
//! its entry.

use super::convert::WireUnit;
use super::flat::{Flat, FlatReference, Hop};
use super::ssp::SspError;
use super::ssp::structure::{Connector, ConnectorType, SystemStructure};
use super::values::{is_float, is_numeric};
use octant_fmu_host::description::VariableType;

/// Checks the connectors of all references of a system. A connector may leave out what its entry
/// says; what it says is the same.
///
/// # Errors
/// If a connector differs from its entry.
pub fn check(structure: &SystemStructure, flat: &Flat) -> Result<(), SspError> {
    for reference in &flat.references {
        for (connector, entry) in &reference.connectors {
            differs(structure, reference, connector, entry).map_err(|message| SspError {
                file: structure.file.clone(),
                line: Some(connector.line),
                element: format!("Connector {:?} of {}", connector.name, reference.name),
                message,
            })?;
        }
    }
    Ok(())
}

fn differs(
    structure: &SystemStructure,
    reference: &FlatReference,
    connector: &Connector,
    entry: &Connector,
) -> Result<(), String> {
    let of = &reference.dictionary;
    let (Some(said), Some(own)) = (&connector.of_type, &entry.of_type) else { return Ok(()) };
    if !same_type(said, own) {
        return Err(format!(
            "it is of type {}, and the entry of the signal dictionary {of} is of type {}",
            said.name, own.name
        ));
    }
    if let (Some(said), Some(own)) = (&said.unit, &own.unit) {
        let said = WireUnit::named(said, &structure.units);
        let own = WireUnit::named(own, &reference.units);
        let same = said.to(&own).map_err(|reason| reason.to_string())?;
        if (same.factor - 1.0).abs() + same.offset.abs() > 1e-9 {
            return Err(format!(
                "it is in {:?}, and the entry of the signal dictionary {of} is in {:?}",
                said.name, own.name
            ));
        }
    }
    if let (Some(said), Some(own)) = (elements(&connector.dimensions), elements(&entry.dimensions))
        && said != own
    {
        return Err(format!(
            "it has {said} elements, and the entry of the signal dictionary {of} has {own}"
        ));
    }
    Ok(())
}

/// `Real` and `Integer` of SSP 1.0 stand for all types of their sort.
fn same_type(said: &ConnectorType, own: &ConnectorType) -> bool {
    let whole = |kind| {
        is_numeric(kind)
            && !is_float(kind)
            && kind != VariableType::Boolean
            && kind != VariableType::Enumeration
    };
    let (a, b) = (said.kind, own.kind);
    let either = |name: &str| said.name == name || own.name == name;
    a == b
        || (either("Real") && is_float(a) && is_float(b))
        || (either("Integer") && whole(a) && whole(b))
}

/// Returns the number of elements; `None` if the file leaves it open, as SSP 1.0 does.
fn elements(dimensions: &[Option<u64>]) -> Option<u64> {
    let sizes: Option<Vec<u64>> = dimensions.iter().copied().collect();
    let sizes = sizes.filter(|sizes| !sizes.is_empty())?;
    Some(sizes.into_iter().fold(1, u64::saturating_mul))
}

/// Checks that the entries on the way of a wire have as many elements as its ends.
pub(super) fn sizes(hops: &[Hop], count: usize) -> Result<(), String> {
    for entry in hops.iter().filter_map(|hop| hop.entry.as_ref()) {
        let size = elements(&entry.dimensions).filter(|size| *size != count as u64);
        if let Some(size) = size {
            return Err(format!(
                "the output has {count} elements, and {entry} has {size}: expected the same number"
            ));
        }
    }
    Ok(())
}
