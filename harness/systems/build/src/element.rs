//! XML elements with attributes, written in one fixed format.

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};
use std::io;

/// One element.
#[derive(Clone, Debug)]
pub(super) struct Element {
    name: &'static str,
    attributes: Vec<(&'static str, String)>,
    children: Vec<Element>,
}

impl Element {
    /// Creates an empty element.
    pub(super) fn new(name: &'static str) -> Self {
        Self { name, attributes: Vec::new(), children: Vec::new() }
    }

    /// Adds an attribute.
    pub(super) fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((name, value.into()));
        self
    }

    /// Adds an attribute if there is a value.
    pub(super) fn with_some(self, name: &'static str, value: Option<impl Into<String>>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// Appends a child.
    pub(super) fn child(mut self, child: Self) -> Self {
        self.children.push(child);
        self
    }

    /// Appends children.
    pub(super) fn children(mut self, children: impl IntoIterator<Item = Self>) -> Self {
        self.children.extend(children);
        self
    }

    /// True if the element has no children.
    pub(super) fn is_empty(&self) -> bool {
        self.children.is_empty()
    }

    /// Renders a whole file with this element as its root.
    pub(super) fn document(&self) -> io::Result<Vec<u8>> {
        let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
        writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
        self.write(&mut writer)?;
        let mut bytes = writer.into_inner();
        bytes.push(b'\n');
        Ok(bytes)
    }

    fn write(&self, writer: &mut Writer<Vec<u8>>) -> io::Result<()> {
        let attributes = self.attributes.iter().map(|(name, value)| (*name, value.as_str()));
        let start = BytesStart::new(self.name).with_attributes(attributes);
        if self.children.is_empty() {
            return writer.write_event(Event::Empty(start));
        }
        writer.write_event(Event::Start(start))?;
        for child in &self.children {
            child.write(writer)?;
        }
        writer.write_event(Event::End(BytesEnd::new(self.name)))
    }
}

/// Renders a number with as many digits as restore its bits, in the form of `xs:double`.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    // Outside this range a decimal would be a long row of zeros.
    if size != 0.0 && !(1e-5..1e15).contains(&size) {
        format!("{value:e}")
    } else {
        format!("{value}")
    }
}

/// Renders a whole number in the form of integers.
pub(super) fn whole(value: f64) -> String {
    format!("{value:.0}")
}

/// Renders numbers as an XML list.
pub(super) fn list<T: ToString>(values: impl IntoIterator<Item = T>) -> String {
    values.into_iter().map(|value| value.to_string()).collect::<Vec<_>>().join(" ")
}

/// Builds the graphical position of a terminal.
pub(super) fn picture(place: [f64; 4]) -> Element {
    corners(Element::new("TerminalGraphicalRepresentation"), place)
        .with("defaultConnectionColor", "0 101 163")
        .with("defaultConnectionStrokeSize", "1")
        .with("iconBaseName", "terminal")
}

/// Adds the corners of a rectangle.
pub(super) fn corners(element: Element, place: [f64; 4]) -> Element {
    ["x1", "y1", "x2", "y2"]
        .into_iter()
        .zip(place)
        .fold(element, |element, (name, value)| element.with(name, number(value)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]

    use super::*;

    #[test]
    fn what_is_not_xml_is_escaped() {
        let element = Element::new("a").with("b", "1 < 2 & \"x\"").child(Element::new("c"));
        let text = String::from_utf8(element.document().unwrap()).unwrap();
        let read = roxmltree::Document::parse(&text).unwrap();
        assert_eq!(read.root_element().attribute("b"), Some("1 < 2 & \"x\""));
        assert_eq!(read.root_element().first_element_child().unwrap().tag_name().name(), "c");
    }

    #[test]
    fn numbers_give_back_their_bits() {
        let limits = [0.0, -0.0, 1.0, -0.005, 1e-5, 9.9e-6, 1e15, 1e300, f64::MIN_POSITIVE];
        for value in limits.into_iter().chain((0..1000).map(|k| 1.1_f64.powi(k - 500))) {
            let text = number(value);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{text}");
            assert!(text.len() < 26, "{text}");
        }
    }
}
