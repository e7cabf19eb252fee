//! Reads elements and attributes of a file, with their lines; deviations that have one meaning all the same are warnings.

use super::SspError;
use octant_base::names::suggestion;
use octant_fmu_host::description::{BaseUnit, units};
use roxmltree::{Document, Node, ParsingOptions};
use std::borrow::Cow;
use std::cell::RefCell;

/// Namespaces of the standard, the same for 1.0 and 2.0.
pub(super) const SSD: &str = "http://ssp-standard.org/SSP1/SystemStructureDescription";
pub(super) const SSC: &str = "http://ssp-standard.org/SSP1/SystemStructureCommon";
pub(super) const SSV: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterValues";
pub(super) const SSM: &str = "http://ssp-standard.org/SSP1/SystemStructureParameterMapping";

pub(super) const SSB: &str = "http://ssp-standard.org/SSP1/SystemStructureSignalDictionary";

/// Maximum number of elements in a file.
const NODES_MAX: u32 = 4_000_000;

/// Declares the usual prefixes of the standard that a file uses and doesn't declare, with a warning each.
/// Lines stay.
pub(super) fn declared<'a>(text: &'a str, file: &str, warnings: &SspWarnings) -> Cow<'a, str> {
    let mut text = Cow::Borrowed(text);
    for (prefix, namespace) in
        [("ssd", SSD), ("ssc", SSC), ("ssv", SSV), ("ssm", SSM), ("ssb", SSB)]
    {
        let is_used = ["<", "</"].iter().any(|open| text.contains(&format!("{open}{prefix}:")));
        if !is_used || text.contains(&format!("xmlns:{prefix}")) {
            continue;
        }
        // The root element: not the declaration, a comment or a document type.
        let root = text.match_indices('<').find(|(at, _)| {
            text[at + 1..].starts_with(|letter: char| letter.is_alphabetic() || letter == '_')
        });
        let Some((root, _)) = root else { continue };
        let end = text[root..].find(|letter: char| letter.is_whitespace() || "/>".contains(letter));
        let Some(end) = end.map(|end| root + end) else { continue };
        let (before, after) = text.split_at(end);
        let with = format!("{before} xmlns:{prefix}=\"{namespace}\"{after}");
        let line = 1 + before.matches('\n').count() as u32;
        text = with.into();
        warnings.add(&SspError {
            file: file.to_owned(),
            line: Some(line),
            element: String::new(),
            message: format!("the prefix {prefix} isn't declared: it is read as {namespace}"),
        });
    }
    text
}

/// Parses a file.
pub(super) fn parse<'a>(text: &'a str, file: &str) -> Result<Document<'a>, SspError> {
    octant_fmu_host::description::xml_limits::check(text).map_err(|excess| SspError {
        file: file.to_owned(),
        line: Some(1 + text[..excess.at].matches('\n').count() as u32),
        element: String::new(),
        message: format!("found {}, expected {}", excess.found, excess.expected),
    })?;
    let options = ParsingOptions { nodes_limit: NODES_MAX, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| SspError {
        file: file.to_owned(),
        line: Some(error.pos().row),
        element: String::new(),
        message: format!("not XML: {error}"),
    })
}

/// Element with the name of its file.
#[derive(Clone, Copy)]
pub(super) struct Element<'a> {
    pub(super) node: Node<'a, 'a>,
    pub(super) file: &'a str,
    pub(super) warnings: &'a SspWarnings,
}

impl<'a> Element<'a> {
    /// Returns the root of a file, which must be this element.
    pub(super) fn root(
        document: &'a Document<'a>,
        file: &'a str,
        warnings: &'a SspWarnings,
        (namespace, name): (&str, &str),
    ) -> Result<Self, SspError> {
        let root = Self { node: document.root_element(), file, warnings };
        root.expect(namespace, name)?;
        Ok(root)
    }

    /// Checks that this is the expected element.
    pub(super) fn expect(&self, namespace: &str, name: &str) -> Result<(), SspError> {
        let found = self.node.tag_name();
        if found.name() == name && found.namespace() == Some(namespace) {
            return Ok(());
        }
        let of = |namespace: Option<&str>| match namespace {
            Some(namespace) => format!(" of namespace {namespace}"),
            None => " without namespace".to_owned(),
        };
        let draft = if found.namespace().is_some_and(|n| n.contains("Draft")) {
            ": a draft from before SSP 1.0 wrote it"
        } else {
            ""
        };
        Err(self.error(format!(
            "found <{}>{}{draft}, expected <{name}>{}",
            found.name(),
            of(found.namespace()),
            of(Some(namespace))
        )))
    }

    /// Name without prefix.
    pub(super) fn name(&self) -> &'a str {
        self.node.tag_name().name()
    }

    pub(super) fn is(&self, namespace: &str, name: &str) -> bool {
        self.node.has_tag_name((namespace, name))
    }

    /// Returns the line.
    pub(super) fn line(&self) -> u32 {
        self.node.document().text_pos_at(self.node.range().start).row
    }

    /// Creates an error about this element.
    pub(super) fn error(&self, message: impl Into<String>) -> SspError {
        let name = match self.node.attribute("name") {
            Some(name) => format!("{} {name:?}", self.name()),
            None => self.name().to_owned(),
        };
        SspError {
            file: self.file.to_owned(),
            line: Some(self.line()),
            element: name,
            message: message.into(),
        }
    }

    /// Lists the child elements.
    pub(super) fn children(&self) -> impl Iterator<Item = Self> + use<'a> {
        let Self { file, warnings, .. } = *self;
        self.node.children().filter(Node::is_element).map(move |node| Self { node, file, warnings })
    }

    /// Returns the child element of this name, which may occur once.
    pub(super) fn child(&self, namespace: &str, name: &str) -> Result<Option<Self>, SspError> {
        let mut found = self.children().filter(|child| child.is(namespace, name));
        let first = found.next();
        match found.next() {
            Some(second) => Err(second.error("found a second time, expected once")),
            None => Ok(first),
        }
    }

    /// Refuses elements and attributes that are neither known nor skippable, because their meaning
    /// would be lost. Attributes of other namespaces are ignored.
    pub(super) fn only(
        &self,
        attributes: &[&str],
        elements: &[(&str, &str)],
    ) -> Result<(), SspError> {
        for attribute in self.node.attributes().filter(|a| a.namespace().is_none()) {
            if !attributes.contains(&attribute.name())
                && !["id", "description"].contains(&attribute.name())
            {
                let known = suggestion(attribute.name(), attributes.iter().copied(), "known here");
                return Err(
                    self.error(format!("unknown attribute {:?}, {known}", attribute.name()))
                );
            }
        }
        for child in self.children() {
            if is_passed_over(&child) || elements.iter().any(|(space, name)| child.is(space, name))
            {
                continue;
            }
            let known =
                suggestion(child.name(), elements.iter().map(|(_, name)| *name), "known here");
            return Err(child.error(format!("unknown element <{}>, {known}", child.name())));
        }
        Ok(())
    }

    /// Warns about this element; `message` says what is read instead.
    pub(super) fn warn(&self, message: impl Into<String>) {
        self.warnings.add(&self.error(message));
    }

    /// Returns the child elements of this name, which should occur once.
    pub(super) fn several(&self, namespace: &str, name: &str) -> Vec<Self> {
        let found: Vec<Self> = self.children().filter(|child| child.is(namespace, name)).collect();
        for more in found.iter().skip(1) {
            more.warn("found once more, expected once: all are read, one after the other");
        }
        found
    }

    /// Returns the name of a unit in the attribute `unit`, and its meaning by the definitions of
    /// the file, else its common one.
    pub(super) fn unit(&self, defined: &[(String, BaseUnit)]) -> Option<(&'a str, Vec<BaseUnit>)> {
        let name = self.optional("unit")?;
        if name.is_empty() {
            self.warnings.unit(name, &self.error("the unit is empty: it is read as none"));
            return None;
        }
        if let Some((_, base)) = defined.iter().find(|(known, _)| known == name) {
            return Some((name, vec![*base]));
        }
        let known = units::known(name);
        let read = match known.is_empty() {
            true => "it is read as none",
            false => "its common meaning is used",
        };
        let message = format!("the unit {name:?} is not defined in this file: {read}");
        self.warnings.unit(name, &self.error(message));
        (!known.is_empty()).then_some((name, known))
    }

    pub(super) fn optional(&self, attribute: &str) -> Option<&'a str> {
        self.node.attribute(attribute)
    }

    pub(super) fn required(&self, attribute: &str) -> Result<&'a str, SspError> {
        self.optional(attribute)
            .ok_or_else(|| self.error(format!("the attribute {attribute:?} is missing")))
    }

    /// Parses a number in an attribute: xs:double.
    pub(super) fn number(&self, attribute: &str) -> Result<Option<f64>, SspError> {
        let Some(text) = self.optional(attribute) else { return Ok(None) };
        match double(text) {
            Some(value) => Ok(Some(value)),
            None => Err(self.error(format!("{attribute} is {text:?}, expected a number"))),
        }
    }

    /// Parses a finite number in an attribute.
    pub(super) fn finite(&self, attribute: &str) -> Result<Option<f64>, SspError> {
        match self.number(attribute)? {
            Some(value) if !value.is_finite() => {
                Err(self.error(format!("{attribute} is {value}, expected a finite number")))
            }
            other => Ok(other),
        }
    }

    /// Parses a whole number in an attribute.
    pub(super) fn integer(&self, attribute: &str) -> Result<Option<i64>, SspError> {
        let Some(text) = self.optional(attribute) else { return Ok(None) };
        match text.trim().parse() {
            Ok(value) => Ok(Some(value)),
            Err(_) => Err(self.error(format!("{attribute} is {text:?}, expected a whole number"))),
        }
    }

    /// Parses a Boolean in an attribute: xs:boolean.
    pub(super) fn boolean(&self, attribute: &str) -> Result<Option<bool>, SspError> {
        let Some(text) = self.optional(attribute) else { return Ok(None) };
        match boolean(text) {
            Some(value) => Ok(Some(value)),
            None => Err(self.error(format!("{attribute} is {text:?}, expected true or false"))),
        }
    }
}

/// Returns whether an element is irrelevant to a simulation: geometry, signatures, metadata,
/// annotations.
fn is_passed_over(element: &Element<'_>) -> bool {
    const PASSED_OVER: [&str; 9] = [
        "Annotations",
        "MetaData",
        "Signature",
        "ElementGeometry",
        "SystemGeometry",
        "ConnectorGeometry",
        "ConnectionGeometry",
        "GraphicalElements",
        "Geometry",
    ];
    PASSED_OVER.contains(&element.name())
}

/// Parses a number in the form of XML Schema.
pub(super) fn double(text: &str) -> Option<f64> {
    match text.trim() {
        "INF" | "+INF" => Some(f64::INFINITY),
        "-INF" => Some(f64::NEG_INFINITY),
        "NaN" => Some(f64::NAN),
        // Rust's own spellings of these aren't valid in XML Schema.
        text if text.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b)) => {
            text.parse().ok()
        }
        _ => None,
    }
}

/// Parses a Boolean in the form of XML Schema.
pub(super) fn boolean(text: &str) -> Option<bool> {
    match text.trim() {
        "true" | "1" => Some(true),
        "false" | "0" => Some(false),
        _ => None,
    }
}

/// Warnings about the files of a structure, each once.
#[derive(Debug, Default)]
pub(super) struct SspWarnings {
    all: RefCell<Vec<String>>,
    /// Files and units in them that were warned about.
    units: RefCell<Vec<(String, String)>>,
}

impl SspWarnings {
    /// Adds a warning in the form of an error, whose message says what is read instead.
    pub(super) fn add(&self, warning: &SspError) {
        self.all.borrow_mut().push(warning.to_string());
    }

    /// Adds a warning about a unit, if it is the first of the file about this unit.
    pub(super) fn unit(&self, unit: &str, warning: &SspError) {
        let place = (warning.file.clone(), unit.to_owned());
        if !self.units.borrow().contains(&place) {
            self.units.borrow_mut().push(place);
            self.add(warning);
        }
    }

    /// Adds the warnings of a part.
    pub(super) fn extend(&self, warnings: Vec<String>) {
        self.all.borrow_mut().extend(warnings);
    }

    /// Takes all warnings, in their order.
    pub(super) fn take(&self) -> Vec<String> {
        self.units.take();
        self.all.take()
    }
}
