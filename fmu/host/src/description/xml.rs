//! Elements and attributes of an XML file, with the place of each in messages.

use super::DescriptionError;
use roxmltree::{Document, Node, ParsingOptions};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Most nodes of a file: a description with a million variables has about eight million. Each is
/// about 60 bytes in memory.
const NODES_MAX: u32 = 16_000_000;

/// How many notes of one kind are kept one by one; the others are counted.
const NOTES_MAX: usize = 20;

/// A file that is read: its name, where its lines begin, and what was tolerated.
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
    /// How many of each kind.
    counts: BTreeMap<&'static str, usize>,
}

impl<'a> File<'a> {
    /// A file and its text.
    pub fn new(name: &'a str, text: &str) -> Self {
        let lines =
            std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { name, lines, notes: RefCell::default() }
    }

    /// The text as a tree.
    ///
    /// # Errors
    /// If it isn't well-formed, has a DOCTYPE, or has more nodes than any description.
    pub fn parse<'t>(&self, text: &'t str) -> Result<Document<'t>, DescriptionError> {
        // Without a DOCTYPE there are no entities of its own, so none that grow.
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

    /// The name of the file.
    pub fn name(&self) -> &'a str {
        self.name
    }

    /// Line of an offset, from 1.
    pub fn line(&self, offset: usize) -> u32 {
        self.lines.partition_point(|&start| start <= offset) as u32
    }

    /// Notes something that isn't as the standard says. `kind` names what is alike.
    pub fn tolerate(&self, kind: &'static str, line: u32, what: impl FnOnce() -> String) {
        let mut notes = self.notes.borrow_mut();
        let count = notes.counts.entry(kind).or_default();
        *count += 1;
        if *count <= NOTES_MAX {
            let note = format!("line {line}: {}", what());
            notes.kept.push(note);
        }
    }

    /// What was tolerated, in the order in which it was found.
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
    /// The root of a tree.
    pub fn root(file: &'a File<'a>, document: &'a Document<'t>) -> Self {
        Self { node: document.root_element(), file }
    }

    /// Its name, without a namespace.
    pub fn name(self) -> &'a str {
        self.node.tag_name().name()
    }

    /// Its line.
    pub fn line(self) -> u32 {
        self.file.line(self.node.range().start)
    }

    /// Its file.
    pub fn file(self) -> &'a File<'a> {
        self.file
    }

    /// The elements in it.
    pub fn children(self) -> impl Iterator<Item = Self> + 'a {
        let file = self.file;
        self.node.children().filter(Node::is_element).map(move |node| Self { node, file })
    }

    /// The first element of this name in it.
    pub fn child(self, name: &str) -> Option<Self> {
        self.children().find(|child| child.name() == name)
    }

    /// Its attributes without a namespace: name and value.
    pub fn attributes(self) -> impl Iterator<Item = (&'a str, &'a str)> {
        self.node
            .attributes()
            .filter(|attribute| attribute.namespace().is_none())
            .map(|attribute| (attribute.name(), attribute.value()))
    }

    /// An attribute.
    pub fn text(self, attribute: &str) -> Option<&'a str> {
        // Not `Node::attribute`: it would take `xsi:start` for `start`.
        self.attributes().find(|(name, _)| *name == attribute).map(|(_, value)| value)
    }

    /// An attribute of a namespace.
    pub fn text_of(self, namespace: &str, attribute: &str) -> Option<&'a str> {
        self.node.attribute((namespace, attribute))
    }

    /// What an error says of the element's place.
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

    /// An error at this element, or at one of its attributes.
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

    /// Notes something that isn't as the standard says.
    pub fn tolerate(self, kind: &'static str, what: impl FnOnce() -> String) {
        self.file.tolerate(kind, self.line(), || format!("{}: {}", self.place(None), what()));
    }

    /// An attribute that has to be there.
    pub fn required(self, attribute: &str) -> Result<&'a str, DescriptionError> {
        self.text(attribute)
            .ok_or_else(|| self.error(Some(attribute), "the attribute is missing", "a value"))
    }

    /// A number.
    pub fn real(self, attribute: &str) -> Result<Option<f64>, DescriptionError> {
        self.text(attribute)
            .map(|text| {
                real(text).ok_or_else(|| {
                    self.error(Some(attribute), format!("{text:?}"), "a number, INF, -INF or NaN")
                })
            })
            .transpose()
    }

    /// A whole number of the type.
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

    /// A Boolean; false where it is missing.
    pub fn boolean(self, attribute: &str) -> Result<bool, DescriptionError> {
        let Some(text) = self.text(attribute) else { return Ok(false) };
        boolean(text)
            .ok_or_else(|| self.error(Some(attribute), format!("{text:?}"), "true, false, 1 or 0"))
    }

    /// One of some words.
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

    /// A list of whole numbers; `None` where the attribute is missing.
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

/// The beginning of a text, for a message.
pub fn shortened(text: &str) -> String {
    match text.char_indices().nth(80) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// A number as XML Schema writes it, and as vendors do.
pub fn real(text: &str) -> Option<f64> {
    // Rust reads `inf`, `infinity` and `nan` in any case, and every decimal form of XML Schema.
    text.trim().parse().ok()
}

/// A Boolean as XML Schema writes it, and as vendors do.
pub fn boolean(text: &str) -> Option<bool> {
    match text.trim() {
        "true" | "1" | "True" | "TRUE" => Some(true),
        "false" | "0" | "False" | "FALSE" => Some(false),
        _ => None,
    }
}
