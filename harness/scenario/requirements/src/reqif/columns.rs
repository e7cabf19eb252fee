//! Columns of the object types: the attributes of all requirements.

use super::{FOREIGN_ID, NAME, TEXT};
use octant_verdict::fields::{ALL, own_fields};
use octant_verdict::requirement::{AttributeKind, Requirements};

/// A column of every object type.
pub(super) struct Column {
    pub(super) name: String,
    pub(super) kind: AttributeKind,
    /// True for a text that isn't one line of plain ASCII. StrictDoc reads and writes strings with
    /// escapes of its own, which would change such texts; it leaves XHTML unchanged.
    pub(super) formatted: bool,
}

pub(super) fn columns(requirements: &Requirements) -> Vec<Column> {
    let all = &requirements.requirements;
    let plain = |text: &str| text.chars().all(|c| (' '..='~').contains(&c) && c != '\\');
    let has_format =
        |name: &str| all.iter().flat_map(|r| &r.formatted).any(|text| text.name == name);
    let column = |name: &str, kind: AttributeKind, values: &[String]| {
        let formatted = kind == AttributeKind::Text
            && (has_format(name) || !values.iter().all(|text| plain(text)));
        Column { name: name.to_owned(), kind, formatted }
    };
    let mut columns = vec![
        Column { name: FOREIGN_ID.to_owned(), kind: AttributeKind::Text, formatted: false },
        column(
            NAME,
            AttributeKind::Text,
            &all.iter().filter_map(|r| r.title.clone()).collect::<Vec<_>>(),
        ),
        Column { name: TEXT.to_owned(), kind: AttributeKind::Text, formatted: true },
    ];
    for field in ALL {
        let values: Vec<String> = all
            .iter()
            .flat_map(own_fields)
            .filter(|(name, _)| *name == field)
            .map(|(_, value)| value)
            .collect();
        columns.push(column(field, AttributeKind::Text, &values));
    }
    for name in requirements.attribute_names() {
        let values: Vec<String> = all
            .iter()
            .flat_map(|r| &r.attributes)
            .filter(|a| a.name == name)
            .map(|a| a.values.join("\n\n"))
            .collect();
        let new = column(name, requirements.kind(name), &values);
        // A field of Octant can be an attribute of a requirement whose own key is missing.
        match columns.iter_mut().find(|c| c.name == name) {
            Some(column) => column.formatted |= new.formatted,
            None => columns.push(new),
        }
    }
    columns
}
