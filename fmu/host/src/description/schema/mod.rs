//! Elements and attributes in the standards, with their types.
//!
//! The tables correspond to the XML Schemas of the standards; rules beyond a schema are checked
//! elsewhere.

mod fmi2;
mod fmi3;
mod terminals;
mod values;

pub use fmi2::MODEL_DESCRIPTION as FMI2;
pub use fmi3::{BUILD_DESCRIPTION, MODEL_DESCRIPTION as FMI3};
pub use terminals::TERMINALS_AND_ICONS;
pub use values::AttributeType;

use super::xml::Element;

/// Largest depth of nested elements that is checked; only terminals are nested at all.
const DEPTH_MAX: usize = 64;

/// An element in the standard.
#[derive(Debug)]
pub struct ElementRule {
    /// Name of the element.
    pub name: &'static str,
    /// Attributes.
    pub attributes: &'static [AttributeRule],
    /// Child elements, in their order.
    pub children: &'static [Child],
    /// Other content that is allowed.
    pub open: Open,
}

/// Content allowed in an element beside that of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Open {
    /// No other content.
    No,
    /// Any attributes.
    Attributes,
    /// Any content: annotations.
    Everything,
}

/// An attribute in the standard.
#[derive(Debug)]
pub struct AttributeRule {
    /// Name of the attribute.
    pub name: &'static str,
    /// Type of the value.
    pub of: AttributeType,
    /// True if the attribute is required.
    pub required: bool,
}

/// A child element.
#[derive(Debug)]
pub struct Child {
    /// Definition of the child.
    pub node: &'static ElementRule,
    /// Position in the order. Elements of one position may be in any order.
    pub place: u8,
    /// Smallest total number of elements of this position.
    pub min: u32,
    /// Largest number of this element.
    pub max: u32,
}

/// No upper limit.
const MANY: u32 = u32::MAX;

const fn node(
    name: &'static str,
    attributes: &'static [AttributeRule],
    children: &'static [Child],
) -> ElementRule {
    ElementRule { name, attributes, children, open: Open::No }
}

const fn may(name: &'static str, of: AttributeType) -> AttributeRule {
    AttributeRule { name, of, required: false }
}

const fn must(name: &'static str, of: AttributeType) -> AttributeRule {
    AttributeRule { name, of, required: true }
}

/// Makes an optional element.
const fn optional(place: u8, node: &'static ElementRule) -> Child {
    Child { node, place, min: 0, max: 1 }
}

/// Makes an element that occurs exactly once.
const fn one(place: u8, node: &'static ElementRule) -> Child {
    Child { node, place, min: 1, max: 1 }
}

/// Makes an element that may occur any number of times.
const fn any(place: u8, node: &'static ElementRule) -> Child {
    Child { node, place, min: 0, max: MANY }
}

/// Makes an element that has to occur at least once.
const fn some(place: u8, node: &'static ElementRule) -> Child {
    Child { node, place, min: 1, max: MANY }
}

/// Violation of a schema.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Kind of rule.
    pub breaks: Breaks,
    /// Line.
    pub line: u32,
    /// Element and attribute.
    pub place: String,
    /// Text found.
    pub found: String,
    /// Text expected.
    pub expected: String,
}

/// Kinds of rules of a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Breaks {
    /// An element that is unknown at its place.
    UnknownElement,
    /// An attribute that is unknown.
    UnknownAttribute,
    /// A required element is missing.
    MissingElement,
    /// A required attribute is missing.
    MissingAttribute,
    /// The order of elements.
    Order,
    /// The number of elements.
    Repeated,
    /// The type of a value.
    Value,
}

/// Reports every violation of the schema to `report`.
pub fn walk(root: Element<'_, '_>, node: &ElementRule, report: &mut impl FnMut(Violation)) {
    if root.name() == node.name {
        walk_element(root, node, 0, report);
    } else {
        report(Violation {
            breaks: Breaks::UnknownElement,
            line: root.line(),
            place: root.place(None),
            found: "an unknown root element".into(),
            expected: node.name.into(),
        });
    }
}

fn walk_element(
    element: Element<'_, '_>,
    node: &ElementRule,
    depth: usize,
    report: &mut impl FnMut(Violation),
) {
    if node.open == Open::Everything {
        return;
    }
    attributes(element, node, report);
    let violation = |breaks, at: Element<'_, '_>, found: String, expected: String| Violation {
        breaks,
        line: at.line(),
        place: at.place(None),
        found,
        expected,
    };
    let mut counts = vec![0u32; node.children.len()];
    let mut place = 0;
    for child in element.children() {
        let known = node.children.iter().position(|known| known.node.name == child.name());
        let Some(index) = known else {
            let names: Vec<&str> = node.children.iter().map(|child| child.node.name).collect();
            let expected = match names.is_empty() {
                true => "no element".into(),
                false => names.join(", "),
            };
            let found = format!("an unknown element in {}", element.name());
            report(violation(Breaks::UnknownElement, child, found, expected));
            continue;
        };
        let known = &node.children[index];
        counts[index] += 1;
        // A list that is too long is reported once.
        if counts[index] == known.max.saturating_add(1) {
            let expected = format!("{} only once in {}", child.name(), element.name());
            report(violation(Breaks::Repeated, child, "the element is repeated".into(), expected));
        }
        if known.place < place {
            let before: Vec<&str> = node
                .children
                .iter()
                .filter(|other| other.place == place)
                .map(|other| other.node.name)
                .collect();
            let found = format!("it comes after {}", before.join(" or "));
            report(violation(
                Breaks::Order,
                child,
                found,
                format!("before {}", before.join(" and ")),
            ));
        }
        place = place.max(known.place);
        if depth < DEPTH_MAX {
            walk_element(child, known.node, depth + 1, report);
        } else {
            let found = format!("nested {depth} deep");
            report(violation(Breaks::UnknownElement, child, found, "a flat file".into()));
        }
    }
    let mut missing: Vec<u8> = Vec::new();
    for child in node.children.iter().filter(|child| child.min > 0) {
        let alternatives =
            || node.children.iter().zip(&counts).filter(|(c, _)| c.place == child.place);
        let count: u32 = alternatives().map(|(_, &count)| count).sum();
        if count < child.min && !missing.contains(&child.place) {
            missing.push(child.place);
            let names: Vec<&str> = alternatives().map(|(child, _)| child.node.name).collect();
            let found = format!("{} is missing", names.join(" or "));
            report(violation(Breaks::MissingElement, element, found, "the element".into()));
        }
    }
}

fn attributes(element: Element<'_, '_>, node: &ElementRule, report: &mut impl FnMut(Violation)) {
    let mut violation = |breaks, attribute: &str, found: String, expected: String| {
        report(Violation {
            breaks,
            line: element.line(),
            place: element.place(Some(attribute)),
            found,
            expected,
        });
    };
    for (name, value) in element.attributes() {
        match node.attributes.iter().find(|known| known.name == name) {
            Some(known) if known.of.allows(value) => {}
            Some(known) => {
                let found = format!("{:?}", super::xml::shortened(value));
                violation(Breaks::Value, name, found, known.of.to_string());
            }
            None if node.open == Open::Attributes => {}
            None => {
                let names = node.attributes.iter().map(|known| known.name);
                let near = octant_base::names::nearest(name, names);
                let expected = match near {
                    Some(near) => format!("a known one, such as {near}"),
                    None => "a known one".into(),
                };
                violation(Breaks::UnknownAttribute, name, "an unknown attribute".into(), expected);
            }
        }
    }
    for known in node.attributes.iter().filter(|known| known.required) {
        if element.text(known.name).is_none() {
            let found = "the attribute is missing".into();
            violation(Breaks::MissingAttribute, known.name, found, known.of.to_string());
        }
    }
}
