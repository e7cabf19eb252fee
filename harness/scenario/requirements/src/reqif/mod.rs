//! ReqIF 1.2 (OMG formal/2016-07-01), the exchange format of requirement tools: a file, or an archive of
//! files with pictures.
//!
//! Attributes are found by the names of a [`crate::mapping`]. They are written with the names of the
//! ReqIF implementation guide, if it defines one (`ReqIF.ForeignID`, `ReqIF.Name`, `ReqIF.Text`,
//! `ReqIF.ChapterName`), and otherwise those of the fields of [`crate::sdoc`]: so StrictDoc can convert
//! one file to the other. Enumerations, numbers and dates of other tools keep their type, and texts
//! their formatting.

mod archive;
mod columns;
mod identifier;
mod parse;
mod read;
mod types;
mod write;

pub use archive::{ReqIfArchiveError, read as read_archive, write as write_archive};
pub use read::{read, read_mapped};
pub(crate) use write::text_of;
pub use write::write;

pub(crate) use crate::foreign::{CHAPTER, FOREIGN_ID, NAME, TEXT};

/// Namespace of ReqIF 1.0 to 1.2.
pub(crate) const NAMESPACE: &str = "http://www.omg.org/spec/ReqIF/20110401/reqif.xsd";
/// Namespace of the model of ReqIF 1.0, which some tools write in place of that of the schema.
const NAMESPACE_2010: &str = "http://www.omg.org/spec/ReqIF/20101201";

/// Name of this program in the head of a file.
pub(crate) const TOOL: &str = "octant";

/// Reverts the escapes of Python's `unicode_escape`, with which StrictDoc writes strings.
#[must_use]
pub fn unescape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('\\') {
        out.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        let Some(first) = rest.chars().next() else {
            out.push('\\');
            break;
        };
        let digits = match first {
            'x' => 2,
            'u' => 4,
            'U' => 8,
            _ => 0,
        };
        let code = rest.get(1..=digits).filter(|_| digits > 0);
        let code = code.and_then(|hex| u32::from_str_radix(hex, 16).ok()).and_then(char::from_u32);
        match (first, code) {
            (_, Some(c)) => {
                out.push(c);
                rest = &rest[1 + digits..];
                continue;
            }
            ('n', _) => out.push('\n'),
            ('r', _) => out.push('\r'),
            ('t', _) => out.push('\t'),
            ('\\', _) => out.push('\\'),
            (other, _) => {
                out.push('\\');
                out.push(other);
            }
        }
        rest = &rest[first.len_utf8()..];
    }
    out.push_str(rest);
    out
}
