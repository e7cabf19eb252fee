//! ReqIF 1.2 (OMG formal/2016-07-01), the exchange format of requirement tools.
//!
//! Attributes have the names of the ReqIF implementation guide, if it defines one (`ReqIF.ForeignID`,
//! `ReqIF.Name`, `ReqIF.Text`, `ReqIF.ChapterName`), and otherwise those of the fields of
//! [`crate::sdoc`]: so StrictDoc can convert one file to the other. Enumerations, numbers and dates of
//! other tools keep their type. Formatting and indentation of a text are lost.

mod columns;
mod identifier;
mod read;
mod types;
mod write;
mod xhtml;

pub use read::{read, unescape};
pub use write::write;

/// Namespace of ReqIF 1.0 to 1.2.
pub(crate) const NAMESPACE: &str = "http://www.omg.org/spec/ReqIF/20110401/reqif.xsd";
pub(crate) const XHTML: &str = "http://www.w3.org/1999/xhtml";

pub(crate) const FOREIGN_ID: &str = "ReqIF.ForeignID";
pub(crate) const NAME: &str = "ReqIF.Name";
pub(crate) const TEXT: &str = "ReqIF.Text";
pub(crate) const CHAPTER: &str = "ReqIF.ChapterName";

/// Name of this program in the head of a file.
pub(crate) const TOOL: &str = "octant";
