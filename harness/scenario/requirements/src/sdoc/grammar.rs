//! Grammar of a document: the fields of its nodes.

use octant_verdict::requirement::{AttributeKind, Definition};

/// A field of the grammar.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Field {
    /// Name in nodes.
    pub(super) title: String,
    /// Name for people.
    pub(super) human: Option<String>,
    pub(super) kind: AttributeKind,
}

impl Field {
    /// Name of the attribute.
    pub(super) fn name(&self) -> &str {
        self.human.as_deref().unwrap_or(&self.title)
    }

    /// Definition that has to be kept for the field, if any.
    pub(super) fn definition(&self) -> Option<Definition> {
        let plain = self.kind == AttributeKind::Text;
        let field = self.human.as_ref().map(|_| self.title.clone());
        // A name from which this field follows needs no definition.
        let field = field.filter(|title| *title != field_of(self.name()));
        (!plain || field.is_some()).then(|| Definition {
            name: self.name().to_owned(),
            kind: self.kind.clone(),
            field,
        })
    }
}

/// Default field for an attribute: capitals, digits and `_`.
pub(super) fn field_of(name: &str) -> String {
    let mut field = String::new();
    for c in name.chars() {
        match c {
            c if c.is_ascii_alphanumeric() => field.push(c.to_ascii_uppercase()),
            '_' | '-' => field.push(c),
            _ => field.push('_'),
        }
    }
    if super::legal_field(&field) { field } else { format!("X_{field}") }
}

/// Kind of a `TYPE` in the grammar.
pub(super) fn kind(text: &str) -> Option<AttributeKind> {
    let options = |list: &str| -> Option<Vec<String>> {
        let inner = list.strip_prefix('(')?.strip_suffix(')')?;
        Some(inner.split(", ").map(|option| option.trim_matches('"').to_owned()).collect())
    };
    match text {
        "String" => Some(AttributeKind::Text),
        // Words separated by commas, from no fixed list.
        "Tag" => Some(AttributeKind::Text),
        _ => match (text.strip_prefix("SingleChoice"), text.strip_prefix("MultipleChoice")) {
            (Some(list), _) => options(list).map(AttributeKind::Choice),
            (_, Some(list)) => options(list).map(AttributeKind::Choices),
            _ => None,
        },
    }
}
