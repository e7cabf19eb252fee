//! Markup of a document's texts.
//!
//! Without an option StrictDoc takes every text for reStructuredText, in which `|…|`, `*…*` and a `_` at
//! the end of a word have a meaning, and a mistake ends its export. So a document of Octant's says that
//! its texts are plain. In one whose author chose reStructuredText his texts are that, and the fields
//! that Octant makes are escaped.

use octant_verdict::fields::{MEASURE, TESTS};

/// Option of the document, by its name in [`octant_verdict::Requirements::document`].
pub(crate) const OPTION: &str = "OPTIONS.MARKUP";
/// Texts that are shown as they are.
pub(crate) const PLAIN: &str = "Text";
/// reStructuredText, the markup of a document that names none.
pub(crate) const DEFAULT: &str = "RST";

/// True if the document's texts are reStructuredText.
pub(crate) fn is_rst(document: &[(String, String)]) -> bool {
    document.iter().any(|(key, value)| key == OPTION && value == DEFAULT)
}

/// True if Octant makes the text of a field, of names that its author can't choose freely.
pub(crate) fn made(field: &str) -> bool {
    [MEASURE, TESTS].contains(&field)
}

fn has_meaning(c: char) -> bool {
    matches!(c, '\\' | '*' | '`' | '|' | '_')
}

/// Escapes a text for reStructuredText.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        // Inside of a word `_` is a letter.
        let letter = c == '_' && rest.peek().is_some_and(|next| next.is_alphanumeric());
        if has_meaning(c) && !letter {
            out.push('\\');
        }
        out.push(c);
    }
    out
}

/// Text without the escapes of reStructuredText.
pub(crate) fn plain(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let next = rest.next_if(|next| c == '\\' && has_meaning(*next));
        out.push(next.unwrap_or(c));
    }
    out
}
