//! Texts as XHTML: paragraphs at empty lines, breaks at other line ends; and formatting, which is kept
//! beside the plain text.

mod plain;

use plain::{is_deleted, plain};
use roxmltree::{Document, Node};
use std::fmt::Write as _;

/// Namespace of XHTML.
pub(crate) const NAMESPACE: &str = "http://www.w3.org/1999/xhtml";
const XML: &str = "http://www.w3.org/XML/1998/namespace";

/// Text that is no XHTML.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum XhtmlError {
    /// It isn't well-formed.
    #[error("not XHTML: {error}")]
    Form {
        /// Reason.
        error: roxmltree::Error,
    },
    /// It has elements of another namespace.
    #[error("found {name}, expected elements of XHTML")]
    Foreign {
        /// Name of the first of them.
        name: String,
    },
}

/// Writes a text as one `div`, with the prefix `xhtml`.
///
/// A line break is written after each `br`, for readers that take only the text.
pub(crate) fn of_plain(text: &str) -> String {
    let mut out = String::from("<xhtml:div>");
    for (index, line) in text.split('\n').enumerate() {
        if index > 0 {
            out.push_str("<xhtml:br/>\n");
        }
        escape(&mut out, line, false);
    }
    out + "</xhtml:div>"
}

/// Writes formatted text with the prefix `xhtml`, if its plain text is `text`.
pub(crate) fn of_formatted(xhtml: &str, text: &str) -> Option<String> {
    let wrapped = wrapped(xhtml);
    let document = Document::parse(&wrapped).ok()?;
    let root = document.root_element();
    if read(root).text != text {
        return None;
    }
    Some(serialized(root, "xhtml:"))
}

/// Checks that a text can be the formatting of one.
///
/// # Errors
/// If it isn't well-formed, or has elements of another namespace.
pub fn check(xhtml: &str) -> Result<(), XhtmlError> {
    let wrapped = wrapped(xhtml);
    let document = Document::parse(&wrapped).map_err(|error| XhtmlError::Form { error })?;
    let foreign = read(document.root_element()).foreign;
    match foreign.into_iter().next() {
        Some(name) => Err(XhtmlError::Foreign { name }),
        None => Ok(()),
    }
}

/// Files that formatted text shows or links: the data of its objects.
pub(crate) fn references(xhtml: &str) -> Vec<String> {
    let wrapped = wrapped(xhtml);
    let Ok(document) = Document::parse(&wrapped) else { return Vec::new() };
    let objects = document.descendants().filter(|node| node.tag_name().name() == "object");
    objects.filter_map(|node| node.attribute("data").map(str::to_owned)).collect()
}

fn wrapped(xhtml: &str) -> String {
    format!("<x xmlns=\"{NAMESPACE}\">{xhtml}</x>")
}

/// A plain text, and its formatting.
#[derive(Default)]
pub(crate) struct Plain {
    pub(crate) text: String,
    /// Formatted text, if it has more than a `div` with breaks.
    pub(crate) formatted: Option<String>,
    /// Elements of other namespaces, whose text alone is kept.
    pub(crate) foreign: Vec<String>,
    /// Text with that which its author marked as deleted, if there is any.
    pub(crate) undeleted: Option<String>,
}

/// Plain text of the children of `THE-VALUE`, and their formatting.
pub(crate) fn read(value: Node<'_, '_>) -> Plain {
    let mut read = Plain { text: plain(value, false), ..Plain::default() };
    for node in value.descendants().filter(|node| node.is_element() && *node != value) {
        let name = node.tag_name().name();
        if !is_ours(node) && !read.foreign.iter().any(|known| known == name) {
            read.foreign.push(name.to_owned());
        }
        if read.undeleted.is_none() && is_deleted(node) {
            read.undeleted = Some(plain(value, true)).filter(|before| *before != read.text);
        }
    }
    read.formatted = (!is_unformatted(value)).then(|| serialized(value, "").trim().to_owned());
    read
}

fn is_ours(node: Node<'_, '_>) -> bool {
    node.tag_name().namespace().is_none_or(|space| space == NAMESPACE)
}

/// True for text with nothing but breaks in it, or in one `div`.
fn is_unformatted(value: Node<'_, '_>) -> bool {
    let mut divs = 0;
    for node in value.descendants().filter(|node| node.is_element() && *node != value) {
        let of_value = node.parent() == Some(value);
        let legal = match node.tag_name().name() {
            "br" => true,
            "div" => of_value,
            _ => false,
        };
        divs += usize::from(node.tag_name().name() == "div");
        if !legal || divs > 1 || node.attributes().len() > 0 || !is_ours(node) {
            return false;
        }
    }
    true
}

/// Content of an element as text, with a prefix for the names of elements.
fn serialized(value: Node<'_, '_>, prefix: &str) -> String {
    let mut out = String::new();
    let mut open: Vec<Node<'_, '_>> = Vec::new();
    for node in value.descendants().filter(|node| *node != value) {
        while let Some(last) = open.last().filter(|last| Some(**last) != node.parent()) {
            close(&mut out, *last, prefix);
            open.pop();
        }
        if node.is_text() {
            escape(&mut out, node.text().unwrap_or_default(), false);
        } else if node.is_element() {
            if is_ours(node) {
                start(&mut out, node, prefix);
            }
            if node.has_children() {
                open.push(node);
            }
        }
    }
    for node in open.into_iter().rev() {
        close(&mut out, node, prefix);
    }
    out
}

fn start(out: &mut String, node: Node<'_, '_>, prefix: &str) {
    _ = write!(out, "<{prefix}{}", node.tag_name().name());
    for attribute in node.attributes() {
        let before = match attribute.namespace() {
            None => "",
            Some(XML) => "xml:",
            Some(_) => continue,
        };
        _ = write!(out, " {before}{}=\"", attribute.name());
        escape(out, attribute.value(), true);
        out.push('"');
    }
    out.push_str(if node.has_children() { ">" } else { "/>" });
}

fn close(out: &mut String, node: Node<'_, '_>, prefix: &str) {
    if is_ours(node) {
        _ = write!(out, "</{prefix}{}>", node.tag_name().name());
    }
}

fn escape(out: &mut String, text: &str, attribute: bool) {
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' if attribute => out.push_str("&quot;"),
            '\n' | '\t' if attribute => _ = write!(out, "&#{};", u32::from(c)),
            '\r' => out.push_str("&#13;"),
            c => out.push(c),
        }
    }
}
