//! An object of another tool.

use crate::ledger::{Repair, Whereabouts};
use crate::mapping::{IDENTIFIER, Mapping, RequirementPart};
use octant_verdict::requirement::AttributeKind;

/// An attribute of an object; it has a value.
#[derive(Clone, Debug)]
pub(crate) struct Attribute {
    pub(crate) name: String,
    pub(crate) kind: AttributeKind,
    pub(crate) values: Vec<String>,
    /// XHTML, if the text has a formatting.
    pub(crate) formatted: Option<String>,
    pub(crate) line: usize,
}

/// An object of another tool.
#[derive(Clone, Debug, Default)]
pub(crate) struct Object {
    /// File in an archive or folder; empty if there is only one.
    pub(crate) file: String,
    pub(crate) line: usize,
    /// Name for machines, or for a message.
    pub(crate) identifier: String,
    /// True if the identifier can name the requirement.
    pub(crate) has_identifier: bool,
    /// Identifier that the requirement keeps.
    pub(crate) kept_identifier: Option<String>,
    /// Name of its type.
    pub(crate) kind: String,
    /// Name outside of its attributes.
    pub(crate) long_name: Option<String>,
    pub(crate) attributes: Vec<Attribute>,
    /// Names of the attributes that objects of its type can have.
    pub(crate) declared: std::rc::Rc<Vec<String>>,
    /// True if its title is what it requires, where it has no text.
    pub(crate) is_title_enough: bool,
    /// Repairs so far.
    pub(crate) repairs: Vec<Repair>,
}

/// A text that was taken out of an object.
pub(crate) struct Taken {
    pub(crate) text: String,
    pub(crate) formatted: Option<String>,
}

/// Meaning of an object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Head of a section, with its title; true if it has a text that requires nothing.
    Heading(String, bool),
    /// Text that requires nothing.
    Informative,
    /// A requirement.
    Requirement,
}

impl Object {
    /// Place for accounts and notes.
    pub(crate) fn at(&self) -> Whereabouts {
        Whereabouts::new(self.identifier.clone(), &self.file, self.line)
    }

    /// Returns whether another object has the same content.
    pub(crate) fn is_copy_of(&self, other: &Self) -> bool {
        let same = |(one, two): (&Attribute, &Attribute)| {
            one.name == two.name && one.values == two.values && one.formatted == two.formatted
        };
        self.kind == other.kind
            && self.long_name == other.long_name
            && self.attributes.len() == other.attributes.len()
            && self.attributes.iter().zip(&other.attributes).all(same)
    }

    /// Place of the attribute that holds a part.
    pub(crate) fn index(&self, mapping: &Mapping, part: RequirementPart) -> Option<usize> {
        let ranked = self.attributes.iter().enumerate().filter_map(|(index, attribute)| {
            let rank = mapping.rank(&self.kind, part, &attribute.name)?;
            let full = attribute.values.iter().any(|text| !text.is_empty());
            full.then_some((rank, index))
        });
        ranked.min().map(|(_, index)| index)
    }

    fn get(&self, mapping: &Mapping, part: RequirementPart) -> Option<String> {
        let attribute = self.attributes.get(self.index(mapping, part)?)?;
        Some(attribute.values.join("\n\n"))
    }

    /// Takes the attribute that holds a part out of the object.
    pub(crate) fn take(&mut self, mapping: &Mapping, part: RequirementPart) -> Option<Taken> {
        if mapping.rank(&self.kind, part, IDENTIFIER) == Some(0) && self.has_identifier {
            return Some(Taken { text: self.identifier.clone(), formatted: None });
        }
        let attribute = self.attributes.remove(self.index(mapping, part)?);
        let text = attribute.values.join("\n\n");
        let text = mapping.value(&self.kind, part, &text).to_owned();
        Some(Taken { text, formatted: attribute.formatted })
    }

    /// True if objects of this type can have an attribute for a part.
    pub(crate) fn declares(&self, mapping: &Mapping, part: RequirementPart) -> bool {
        self.declared.iter().any(|name| mapping.rank(&self.kind, part, name).is_some())
    }

    /// Name for messages: the id, or the identifier.
    pub(crate) fn name(&self, mapping: &Mapping) -> String {
        self.get(mapping, RequirementPart::Id)
            .unwrap_or_else(|| self.identifier.clone())
            .replace('\n', " ")
    }

    /// Meaning of the object, by its type, its enumerations, and its text.
    pub(crate) fn role(&self, mapping: &Mapping) -> Role {
        let text = self.get(mapping, RequirementPart::Text);
        let title = || {
            let heading = self.get(mapping, RequirementPart::Heading);
            let title = heading.or_else(|| self.get(mapping, RequirementPart::Title));
            title.or_else(|| self.long_name.clone()).map(|title| title.replace('\n', " "))
        };
        let value = self.attributes.iter().find_map(|attribute| {
            let among = |value: &&String| mapping.is_informative_value(&attribute.name, value);
            attribute.values.iter().find(among)
        });
        let heading = mapping.is_heading_type(&self.kind)
            || value.is_some_and(|value| Mapping::is_heading_value(value));
        if heading {
            return match (title(), text) {
                (Some(title), text) => Role::Heading(title, text.is_some()),
                // Its text is all that it has.
                (None, Some(text)) => Role::Heading(text.replace('\n', " "), false),
                (None, None) => Role::Informative,
            };
        }
        if mapping.is_informative_type(&self.kind) || value.is_some() {
            return Role::Informative;
        }
        match self.get(mapping, RequirementPart::Heading) {
            Some(title) if text.is_none() => Role::Heading(title.replace('\n', " "), false),
            _ => Role::Requirement,
        }
    }
}
