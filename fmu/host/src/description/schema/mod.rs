//! Which elements and attributes the standards know, and of which types.
//!
//! The tables say what the XML Schemas of the standards say; what a schema can't say is checked
//! elsewhere.

mod fmi2;
mod fmi3;
mod terminals;
mod values;

pub use fmi2::MODEL_DESCRIPTION as FMI2;
pub use fmi3::{BUILD_DESCRIPTION, MODEL_DESCRIPTION as FMI3};
pub use terminals::TERMINALS_AND_ICONS;
pub use values::Type;

use super::xml::Element;

/// How deep elements of a file may be nested and still be looked at; only terminals nest at all.
const DEPTH_MAX: usize = 64;

/// An element that the standard knows.
#[derive(Debug)]
pub struct Node {
    /// Its name.
    pub name: &'static str,
    /// Its attributes.
    pub attributes: &'static [Attribute],
    /// Its elements, in their order.
    pub children: &'static [Child],
    /// What else may be in it.
    pub open: Open,
}

/// What an element may have beside what the standard knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Open {
    /// Nothing.
    No,
    /// Any attributes.
    Attributes,
    /// Anything: annotations.
    Everything,
}

/// An attribute that the standard knows.
#[derive(Debug)]
pub struct Attribute {
    /// Its name.
    pub name: &'static str,
    /// The type of its value.
    pub of: Type,
    /// It has to be there.
    pub required: bool,
}

/// An element in an element.
#[derive(Debug)]
pub struct Child {
    /// What it is.
    pub node: &'static Node,
    /// Its place in the order. Elements of one place may stand in any order.
    pub place: u8,
    /// The elements of a place have to be there together at least so many times.
    pub min: u32,
    /// It may be there at most so many times.
    pub max: u32,
}

/// Any number of times.
const MANY: u32 = u32::MAX;

const fn node(
    name: &'static str,
    attributes: &'static [Attribute],
    children: &'static [Child],
) -> Node {
    Node { name, attributes, children, open: Open::No }
}

const fn may(name: &'static str, of: Type) -> Attribute {
    Attribute { name, of, required: false }
}

const fn must(name: &'static str, of: Type) -> Attribute {
    Attribute { name, of, required: true }
}

/// An element that may be missing.
const fn optional(place: u8, node: &'static Node) -> Child {
    Child { node, place, min: 0, max: 1 }
}

/// An element that has to be there once.
const fn one(place: u8, node: &'static Node) -> Child {
    Child { node, place, min: 1, max: 1 }
}

/// An element that may be there any number of times.
const fn any(place: u8, node: &'static Node) -> Child {
    Child { node, place, min: 0, max: MANY }
}

/// An element that has to be there, any number of times.
const fn some(place: u8, node: &'static Node) -> Child {
    Child { node, place, min: 1, max: MANY }
}

/// What doesn't follow the schema.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Which kind of rule is broken.
    pub breaks: Breaks,
    /// The line.
    pub line: u32,
    /// Element, and attribute.
    pub place: String,
    /// What is there.
    pub found: String,
    /// What should be there.
    pub expected: String,
}

/// The kinds of rules of a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Breaks {
    /// An element that isn't known at its place.
    UnknownElement,
    /// An attribute that isn't known.
    UnknownAttribute,
    /// An element that has to be there.
    MissingElement,
    /// An attribute that has to be there.
    MissingAttribute,
    /// The order of elements.
    Order,
    /// The number of elements.
    Repeated,
    /// The type of a value.
    Value,
}

/// Tells `report` everything that doesn't follow the schema.
pub fn walk(root: Element<'_, '_>, node: &Node, report: &mut impl FnMut(Violation)) {
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
    node: &Node,
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
        // Once is enough of a list that is too long.
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

fn attributes(element: Element<'_, '_>, node: &Node, report: &mut impl FnMut(Violation)) {
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
