//! Signal dictionaries: `.ssb` files, or inline content (SSP 1.0 and 2.0, clauses "System Structure
//! Signal Dictionaries (SSB)" and "SignalDictionaries").

use super::SspError;
use super::connectors::{typed, types};
use super::parameters::{self, TOP};
use super::parts::{Connector, ConnectorKind, SignalDictionary};
use super::xml::{Element, SSB};

/// Reads a `SignalDictionary` of the namespace SSB. Its name is that of the element of the
/// structure around it, or of the one that names the file.
pub(super) fn dictionary(root: &Element<'_>) -> Result<SignalDictionary, SspError> {
    root.expect(SSB, "SignalDictionary")?;
    parameters::version(root)?;
    root.only(&TOP, &[(SSB, "DictionaryEntry"), (SSB, "Enumerations"), (SSB, "Units")])?;
    let units = match root.child(SSB, "Units")? {
        Some(units) => parameters::units(&units)?,
        None => Vec::new(),
    };
    let enumerations = match root.child(SSB, "Enumerations")? {
        Some(enumerations) => parameters::enumerations(&enumerations)?,
        None => Vec::new(),
    };
    let mut entries: Vec<Connector> = Vec::new();
    for element in root.children().filter(|child| child.is(SSB, "DictionaryEntry")) {
        element.only(&["name"], &types(&element))?;
        let entry = typed(&element, ConnectorKind::Inout, &units)?;
        if entries.iter().any(|known| known.name == entry.name) {
            return Err(element.error("found a second time, expected unique names"));
        }
        let Some(of_type) = &entry.of_type else {
            return Err(element.error("found no type, expected an element such as <ssc:Real/>"));
        };
        if let Some(name) = &of_type.enumeration
            && !enumerations.iter().any(|known| known.name == *name)
        {
            return Err(element.error(format!(
                "found the enumeration {name:?}, expected one that the dictionary defines: its \
                 <Enumerations> have {}",
                match enumerations.is_empty() {
                    true => "none".to_owned(),
                    false => enumerations
                        .iter()
                        .map(|known| format!("{:?}", known.name))
                        .collect::<Vec<_>>()
                        .join(", "),
                }
            )));
        }
        entries.push(entry);
    }
    Ok(SignalDictionary {
        name: String::new(),
        file: root.file.to_owned(),
        entries,
        units,
        enumerations,
    })
}
