//! Texts as XHTML: paragraphs at empty lines, breaks at other line ends; and formatting, which is kept
//! beside the plain text.

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
}

/// Plain text of the children of `THE-VALUE`, and their formatting.
pub(crate) fn read(value: Node<'_, '_>) -> Plain {
    let mut plain = Plain::default();
    // Not recursive, because a file may be nested to any depth.
    for edge in value.descendants() {
        if edge.is_element() && edge != value {
            let name = edge.tag_name().name();
            match name {
                "br" => plain.text.push('\n'),
                "div" | "p" | "li" | "ul" | "ol" | "h1" | "h2" | "h3" | "h4" | "h5" | "h6"
                | "tr" | "table" | "pre" | "blockquote" | "td" => block(&mut plain.text),
                _ => {}
            }
            if !is_ours(edge) && !plain.foreign.iter().any(|known| known == name) {
                plain.foreign.push(name.to_owned());
            }
        } else if edge.is_text() {
            // Text after the end of a block begins a new one.
            if edge.prev_sibling().is_some_and(|before| is_block(before)) {
                block(&mut plain.text);
            }
            flow(&mut plain.text, edge.text().unwrap_or_default());
        }
    }
    let lines: Vec<&str> = plain.text.split('\n').map(str::trim).collect();
    plain.text = lines.join("\n").trim().to_owned();
    plain.formatted = (!is_unformatted(value)).then(|| serialized(value, "").trim().to_owned());
    plain
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

fn is_block(node: Node<'_, '_>) -> bool {
    matches!(node.tag_name().name(), "div" | "p" | "li" | "table" | "pre" | "blockquote")
}

/// Begins a block on a line of its own, after an empty one if there is text before it.
fn block(text: &mut String) {
    while text.ends_with([' ', '\t']) {
        text.pop();
    }
    if !text.is_empty() {
        while !text.ends_with("\n\n") {
            text.push('\n');
        }
    }
}

/// Characters that are space in XML.
const SPACE: [char; 4] = [' ', '\t', '\n', '\r'];

/// Adds running text. Space with a line break in it is indentation and becomes one space; other space
/// stays.
fn flow(text: &mut String, more: &str) {
    let mut rest = more;
    while let Some(at) = rest.find(SPACE) {
        text.push_str(&rest[..at]);
        rest = &rest[at..];
        let end = rest.find(|c| !SPACE.contains(&c)).unwrap_or(rest.len());
        let space = &rest[..end];
        if !space.contains('\n') {
            text.push_str(space);
        } else if !text.ends_with('\n') && !text.is_empty() {
            text.push(' ');
        }
        rest = &rest[end..];
    }
    text.push_str(rest);
}
