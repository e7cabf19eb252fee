//! Texts as XHTML: paragraphs at empty lines, breaks at other line ends.

use super::XHTML;
use quick_xml::events::{BytesEnd, BytesStart, BytesText, Event};
use quick_xml::writer::Writer;
use roxmltree::Node;
use std::io;

/// Writes a text as one `div`.
///
/// A line break is written after each `br`, for readers that take only the text.
pub(super) fn write(out: &mut Writer<Vec<u8>>, text: &str) -> io::Result<()> {
    out.write_event(Event::Start(BytesStart::new("xhtml:div")))?;
    for (index, line) in text.split('\n').enumerate() {
        if index > 0 {
            out.write_event(Event::Empty(BytesStart::new("xhtml:br")))?;
            out.write_event(Event::Text(BytesText::new("\n")))?;
        }
        out.write_event(Event::Text(BytesText::new(line)))?;
    }
    out.write_event(Event::End(BytesEnd::new("xhtml:div")))
}

/// A plain text, and the elements of its formatting that were lost.
#[derive(Default)]
pub(super) struct Plain {
    pub(super) text: String,
    /// Elements other than paragraphs and breaks.
    pub(super) lost: Vec<String>,
}

/// Plain text of the children of `THE-VALUE`.
pub(super) fn read(value: Node<'_, '_>) -> Plain {
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
            let plainly = matches!(name, "br" | "div" | "p");
            let inside = edge.tag_name().namespace().is_none_or(|space| space == XHTML);
            let kept = plainly && inside;
            if !kept && !plain.lost.iter().any(|known| known == name) {
                plain.lost.push(name.to_owned());
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
    plain
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
