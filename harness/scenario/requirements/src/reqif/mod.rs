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
mod escapes;
mod identifier;
mod parse;
mod read;
mod types;
mod write;

pub use archive::{ReqIfArchiveError, read as read_archive, write as write_archive};
pub use escapes::unescape;
pub use read::{read, read_mapped};
pub(crate) use write::text_of;
pub use write::write;

pub(crate) use crate::foreign::{CHAPTER, FOREIGN_ID, NAME, TEXT};

/// Namespace of ReqIF 1.0 to 1.2.
pub(crate) const NAMESPACE: &str = "http://www.omg.org/spec/ReqIF/20110401/reqif.xsd";

/// Name of this program in the head of a file.
pub(crate) const TOOL: &str = "octant";
