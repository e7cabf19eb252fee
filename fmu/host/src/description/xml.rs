//! Elements and attributes of an XML file, with the place of each in messages.

use super::DescriptionError;
use super::xml_limits;
use roxmltree::{Document, Node, ParsingOptions};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Largest number of nodes of a file: a description with a million variables has about eight
/// million. Each needs about 60 bytes of memory.
const NODES_MAX: u32 = 16_000_000;

/// Number of notes of one kind that are kept; the others are counted.
const NOTES_MAX: usize = 20;

/// A file that is read: its name, the starts of its lines, and its notes.
#[derive(Debug)]
pub struct File<'a> {
    name: &'a str,
    /// Offset of each line's first byte.
    lines: Vec<usize>,
    notes: RefCell<Notes>,
}

#[derive(Debug, Default)]
struct Notes {
    kept: Vec<String>,
    /// Number of notes of each kind.
    counts: BTreeMap<&'static str, usize>,
}

impl<'a> File<'a> {
    /// Makes a file from its name and text.
    pub fn new(name: &'a str, text: &str) -> Self {
        let lines =
            std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { name, lines, notes: RefCell::default() }
    }

    /// Parses the text into a tree.
    ///
    /// # Errors
    /// If it isn't well-formed, has a DOCTYPE, or exceeds the [limits](xml_limits) of any
    /// description.
    pub fn parse<'t>(&self, text: &'t str) -> Result<Document<'t>, DescriptionError> {
        xml_limits::check(text).map_err(|excess| DescriptionError {
            file: self.name.into(),
            line: Some(self.line(excess.at)),
            place: "XML".into(),
            found: excess.found,
            expected: excess.expected,
        })?;
        // Without a DOCTYPE there are no custom entities, so that none can expand.
        let options =
            ParsingOptions { allow_dtd: false, nodes_limit: NODES_MAX, ..Default::default() };
        Document::parse_with_options(text, options).map_err(|error| {
            let line = match error {
                roxmltree::Error::DtdDetected
                | roxmltree::Error::NoRootNode
                | roxmltree::Error::NodesLimitReached
                | roxmltree::Error::AttributesLimitReached
                | roxmltree::Error::NamespacesLimitReached => None,
                _ => Some(error.pos().row),
            };
            let (found, expected) = match error {
                roxmltree::Error::DtdDetected => {
                    ("a DOCTYPE".to_owned(), "none: an FMU has no use for one, but an attacker")
                }
                roxmltree::Error::NodesLimitReached => {
                    ("too many elements".to_owned(), "at most 16 million")
                }
                error => (error.to_string(), "well-formed XML"),
            };
            DescriptionError {
                file: self.name.into(),
                line,
                place: "XML".into(),
                found,
                expected: expected.into(),
            }
        })
    }

    /// Name of the file.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// Line of an offset, from 1.
    pub fn line(&self, offset: usize) -> u32 {
        self.lines.partition_point(|&start| start <= offset) as u32
    }

    /// Notes a deviation from the standard. `kind` is the name under which equal ones are counted.
    pub fn tolerate(&self, kind: &'static str, line: u32, what: impl FnOnce() -> String) {
        let mut notes = self.notes.borrow_mut();
        let count = notes.counts.entry(kind).or_default();
        *count += 1;
        if *count <= NOTES_MAX {
            let note = format!("line {line}: {}", what());
            notes.kept.push(note);
        }
    }

    /// Notes in their order.
    pub fn tolerated(&self) -> Vec<String> {
        let notes = self.notes.borrow();
        let mut all = notes.kept.clone();
        for (kind, count) in &notes.counts {
            if *count > NOTES_MAX {
                all.push(format!("{} more of the kind: {kind}", count - NOTES_MAX));
            }
        }
        all
    }
}

/// An element of a file.
#[derive(Clone, Copy, Debug)]
pub struct Element<'a, 't> {
    node: Node<'a, 't>,
    file: &'a File<'a>,
}

impl<'a, 't: 'a> Element<'a, 't> {
    /// Root of a tree.
    pub fn root(file: &'a File<'a>, document: &'a Document<'t>) -> Self {
        Self { node: document.root_element(), file }
    }

    /// Name of the element, without a namespace.
    pub fn name(self) -> &'a str {
        self.node.tag_name().name()
    }

    /// Line of the element.
    pub fn line(self) -> u32 {
        self.file.line(self.node.range().start)
    }

    /// File of the element.
    pub fn file(self) -> &'a File<'a> {
        self.file
    }

    /// Child elements.
    pub fn children(self) -> impl Iterator<Item = Self> + 'a {
        let file = self.file;
        self.node.children().filter(Node::is_element).map(move |node| Self { node, file })
    }

    /// First child of this name.
    pub fn child(self, name: &str) -> Option<Self> {
        self.children().find(|child| child.name() == name)
    }

    /// Attributes without a namespace: name and value.
    pub fn attributes(self) -> impl Iterator<Item = (&'a str, &'a str)> {
        self.node
            .attributes()
            .filter(|attribute| attribute.namespace().is_none())
            .map(|attribute| (attribute.name(), attribute.value()))
    }

    /// Value of an attribute.
    pub fn text(self, attribute: &str) -> Option<&'a str> {
        // Not `Node::attribute`: it would take `xsi:start` for `start`.
        self.attributes().find(|(name, _)| *name == attribute).map(|(_, value)| value)
    }

    /// Value of an attribute in a namespace.
    pub fn text_of(self, namespace: &str, attribute: &str) -> Option<&'a str> {
        self.node.attribute((namespace, attribute))
    }

    /// Describes the element's place for an error.
    pub fn place(self, attribute: Option<&str>) -> String {
        let mut place = self.name().to_owned();
        if let Some(name) = self.text("name") {
            place = format!("{place} {:?}", shortened(name));
        }
        if let Some(attribute) = attribute {
            place = format!("{place}, {attribute}");
        }
        place
    }

    /// Makes an error at this element, or at one of its attributes.
    pub fn error(
        self,
        attribute: Option<&str>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> DescriptionError {
        DescriptionError {
            file: self.file.name.into(),
            line: Some(self.line()),
            place: self.place(attribute),
            found: found.into(),
            expected: expected.into(),
        }
    }

    /// Notes a deviation from the standard.
    pub fn tolerate(self, kind: &'static str, what: impl FnOnce() -> String) {
        self.file.tolerate(kind, self.line(), || format!("{}: {}", self.place(None), what()));
    }

    /// Reads a required attribute.
    pub fn required(self, attribute: &str) -> Result<&'a str, DescriptionError> {
        self.text(attribute)
            .ok_or_else(|| self.error(Some(attribute), "the attribute is missing", "a value"))
    }

    /// Reads a number.
    pub fn real(self, attribute: &str) -> Result<Option<f64>, DescriptionError> {
        self.text(attribute)
            .map(|text| {
                real(text).ok_or_else(|| {
                    self.error(Some(attribute), format!("{text:?}"), "a number, INF, -INF or NaN")
                })
            })
            .transpose()
    }

    /// Reads a whole number of the type.
    pub fn whole<T: std::str::FromStr>(
        self,
        attribute: &str,
    ) -> Result<Option<T>, DescriptionError> {
        self.text(attribute)
            .map(|text| {
                text.trim().parse().map_err(|_| {
                    let expected = format!("a whole number ({})", std::any::type_name::<T>());
                    self.error(Some(attribute), format!("{text:?}"), expected)
                })
            })
            .transpose()
    }

    /// Reads a Boolean; false if missing.
    pub fn boolean(self, attribute: &str) -> Result<bool, DescriptionError> {
        let Some(text) = self.text(attribute) else { return Ok(false) };
        boolean(text)
            .ok_or_else(|| self.error(Some(attribute), format!("{text:?}"), "true, false, 1 or 0"))
    }

    /// Reads one of a list of words.
    pub fn one_of<T: Copy>(
        self,
        attribute: &str,
        words: &[(&str, T)],
    ) -> Result<Option<T>, DescriptionError> {
        let Some(text) = self.text(attribute) else { return Ok(None) };
        words
            .iter()
            .find(|(word, _)| *word == text.trim())
            .map(|&(_, value)| Some(value))
            .ok_or_else(|| {
                let words: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
                self.error(
                    Some(attribute),
                    format!("{text:?}"),
                    format!("one of {}", words.join(", ")),
                )
            })
    }

    /// Reads a list of whole numbers; `None` if the attribute is missing.
    pub fn list<T: std::str::FromStr>(
        self,
        attribute: &str,
    ) -> Result<Option<Vec<T>>, DescriptionError> {
        let Some(text) = self.text(attribute) else { return Ok(None) };
        let list: Result<Vec<T>, _> = text.split_ascii_whitespace().map(str::parse).collect();
        list.map(Some).map_err(|_| {
            self.error(Some(attribute), format!("{text:?}"), "whole numbers, separated by blanks")
        })
    }
}

/// Beginning of a text, for a message.
pub fn shortened(text: &str) -> String {
    match text.char_indices().nth(80) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// Reads a number in the form of XML Schema, or of vendors.
pub fn real(text: &str) -> Option<f64> {
    // Rust reads `inf`, `infinity` and `nan` in any case, and every decimal form of XML Schema.
    text.trim().parse().ok()
}

/// Reads a Boolean in the form of XML Schema, or of vendors.
pub fn boolean(text: &str) -> Option<bool> {
    match text.trim() {
        "true" | "1" | "True" | "TRUE" => Some(true),
        "false" | "0" | "False" | "FALSE" => Some(false),
        _ => None,
    }
}
