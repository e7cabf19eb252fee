//! The names of other tools for the parts of a requirement.
//!
//! Without a file of its own a mapping has the names of the ReqIF implementation guide, those that DOORS,
//! Polarion, Jama, codebeamer and Enterprise Architect use, and the fields of [`crate::sdoc`].

mod check;
mod read;

pub(crate) use check::DeclaredType;
pub use read::{SCHEMA, read};

use octant_verdict::fields;
use std::collections::HashMap;

/// A part of a requirement that an attribute can hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RequirementPart {
    /// Id for people.
    Id,
    /// Statement.
    Text,
    /// Short name.
    Title,
    /// Title of a section: an object that has it and no text is a heading.
    Heading,
    /// Path of the measure.
    Measure,
    /// Comparison with the limit.
    Comparison,
    /// Limit.
    Limit,
    /// Whether the limit has the factor sec φ.
    SecantLatitude,
    /// Required probability.
    Pass,
    /// Confidence with which it is shown.
    Confidence,
    /// Verification method.
    Verification,
    /// Names of tests.
    Tests,
    /// Document and clause of the source.
    Clause,
    /// Reason.
    Rationale,
}

impl RequirementPart {
    /// All parts.
    pub const ALL: [Self; 14] = [
        Self::Id,
        Self::Text,
        Self::Title,
        Self::Heading,
        Self::Measure,
        Self::Comparison,
        Self::Limit,
        Self::SecantLatitude,
        Self::Pass,
        Self::Confidence,
        Self::Verification,
        Self::Tests,
        Self::Clause,
        Self::Rationale,
    ];

    /// Key in a mapping file.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Id => "id",
            Self::Text => "text",
            Self::Title => "title",
            Self::Heading => "heading",
            Self::Measure => "measure",
            Self::Comparison => "comparison",
            Self::Limit => "limit",
            Self::SecantLatitude => "secant_latitude",
            Self::Pass => "pass",
            Self::Confidence => "confidence",
            Self::Verification => "verification",
            Self::Tests => "tests",
            Self::Clause => "clause",
            Self::Rationale => "rationale",
        }
    }

    /// Names of attributes without a mapping file, in the order of preference.
    const fn defaults(self) -> &'static [&'static str] {
        match self {
            Self::Id => &[
                "ReqIF.ForeignID",
                "Object Identifier",
                "Identifier",
                "ID",
                "Requirement ID",
                "UID",
                "Key",
            ],
            Self::Text => &[
                "ReqIF.Text",
                "Object Text",
                "ReqIF.Description",
                "Description",
                "Text",
                "Requirement Text",
                "Statement",
                "Content",
            ],
            Self::Title => {
                &["ReqIF.Name", "Object Short Text", "Title", "Name", "ReqIF.ChapterName"]
            }
            Self::Heading => &["ReqIF.ChapterName", "Object Heading"],
            Self::Measure => &[fields::MEASURE],
            Self::Comparison => &[fields::COMPARISON],
            Self::Limit => &[fields::LIMIT],
            Self::SecantLatitude => &[fields::SECANT_LATITUDE],
            Self::Pass => &[fields::PASS],
            Self::Confidence => &[fields::CONFIDENCE],
            Self::Verification => &[fields::VERIFICATION],
            Self::Tests => &[fields::TESTS],
            Self::Clause => &[fields::CLAUSE],
            Self::Rationale => &[fields::RATIONALE],
        }
    }
}

/// Name in a mapping file, and its place there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Named {
    pub(crate) name: String,
    pub(crate) place: (usize, usize),
    /// Path of the field.
    pub(crate) path: String,
}

/// Names for all objects, or for those of one type.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Names {
    pub(crate) attributes: HashMap<RequirementPart, Vec<Named>>,
    /// Values of attributes, and what they stand for.
    pub(crate) values: HashMap<RequirementPart, Vec<(Named, String)>>,
}

/// Mapping of attributes to the parts of a requirement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mapping {
    /// File that it was read from; empty without one.
    pub(crate) file: String,
    /// True for a file that this program wrote, in which every part has one name.
    pub(crate) own: bool,
    pub(crate) all: Names,
    pub(crate) types: Vec<(Named, Names)>,
    /// Types of objects that are no requirements; `None`: the usual ones.
    pub(crate) informative_types: Option<Vec<Named>>,
    /// Attributes and values that say that an object is no requirement; `None`: the usual ones.
    pub(crate) informative_values: Option<Vec<(Named, Vec<Named>)>>,
}

/// Attribute of an enumeration that says whether an object is a requirement.
const TYPE_ATTRIBUTES: [&str; 6] =
    ["Object Type", "ObjectType", "Type", "Artifact Type", "ReqIF.Category", "Requirement Type"];
/// Types of objects, and values of enumerations, for headings.
const HEADINGS: [&str; 6] = ["heading", "headings", "folder", "chapter", "section", "headline"];
/// Types of objects, and values of enumerations, for text that requires nothing.
const INFORMATION: [&str; 8] =
    ["information", "informative", "info", "comment", "note", "remark", "explanation", "prose"];

fn is_among(name: &str, words: &[&str]) -> bool {
    let name = name.trim().to_ascii_lowercase();
    let name = name.strip_suffix(" type").unwrap_or(&name);
    words.contains(&name)
}

/// Type of a section in the files that this program writes.
const OWN_SECTION: &str = "SECTION";

/// Name of an identifier of ReqIF, which every object has, as that of an attribute.
pub(crate) const IDENTIFIER: &str = "IDENTIFIER";

impl Mapping {
    /// Mapping of files that this program wrote.
    pub(crate) fn own() -> Self {
        Self { own: true, ..Self::default() }
    }

    /// True without a mapping file.
    pub(crate) fn is_usual(&self) -> bool {
        self.file.is_empty()
    }

    fn of_type(&self, kind: &str) -> Option<&Names> {
        self.types.iter().find(|(named, _)| named.name == kind).map(|(_, names)| names)
    }

    /// True if an attribute with this name holds a part of objects of a type; with its rank.
    pub(crate) fn rank(&self, kind: &str, part: RequirementPart, attribute: &str) -> Option<usize> {
        let of_type = self.of_type(kind).and_then(|names| names.attributes.get(&part));
        match of_type.or_else(|| self.all.attributes.get(&part)) {
            Some(names) => names.iter().position(|named| named.name == attribute),
            None => {
                let all = part.defaults();
                let known = if self.own { &all[..1] } else { all };
                known.iter().position(|name| name.eq_ignore_ascii_case(attribute.trim()))
            }
        }
    }

    /// True if a mapping file names the attribute of a part.
    pub(crate) fn is_named(&self, kind: &str, part: RequirementPart) -> bool {
        self.of_type(kind).is_some_and(|names| names.attributes.contains_key(&part))
            || self.all.attributes.contains_key(&part)
    }

    /// Value that a value of another tool stands for: itself without an entry.
    pub(crate) fn value<'a>(
        &'a self,
        kind: &str,
        part: RequirementPart,
        value: &'a str,
    ) -> &'a str {
        let of = |names: &'a Names| {
            let all = names.values.get(&part)?;
            all.iter().find(|(named, _)| named.name == value).map(|(_, to)| to.as_str())
        };
        self.of_type(kind).and_then(of).or_else(|| of(&self.all)).unwrap_or(value)
    }

    /// True if objects of this type are headings.
    pub(crate) fn is_heading_type(&self, kind: &str) -> bool {
        self.is_informative_type(kind) && is_among(kind, &HEADINGS)
    }

    /// True if objects of this type are no requirements.
    pub(crate) fn is_informative_type(&self, kind: &str) -> bool {
        match &self.informative_types {
            Some(types) => types.iter().any(|named| named.name == kind),
            None if self.own => kind == OWN_SECTION,
            None => is_among(kind, &HEADINGS) || is_among(kind, &INFORMATION),
        }
    }

    /// True if this value of an attribute says that an object is no requirement.
    pub(crate) fn is_informative_value(&self, attribute: &str, value: &str) -> bool {
        match &self.informative_values {
            Some(all) => {
                let of = all.iter().find(|(named, _)| named.name == attribute);
                of.is_some_and(|(_, values)| values.iter().any(|named| named.name == value))
            }
            None => {
                !self.own
                    && TYPE_ATTRIBUTES
                        .iter()
                        .any(|name| name.eq_ignore_ascii_case(attribute.trim()))
                    && (is_among(value, &HEADINGS) || is_among(value, &INFORMATION))
            }
        }
    }

    /// True if no mapping file names the types that are no requirements.
    pub(crate) fn has_usual_information(&self) -> bool {
        self.informative_types.is_none() && !self.own
    }

    /// True if this value is that of a heading.
    pub(crate) fn is_heading_value(value: &str) -> bool {
        is_among(value, &HEADINGS)
    }
}
