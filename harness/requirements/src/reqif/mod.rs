//! ReqIF 1.2 (OMG formal/2016-07-01), the exchange format of tools for requirements.
//!
//! The names of attributes are those of the ReqIF implementation guide where it has one
//! (`ReqIF.ForeignID`, `ReqIF.Name`, `ReqIF.Text`, `ReqIF.ChapterName`), and the fields of
//! [`crate::sdoc`] for the rest: so StrictDoc turns one file into the other. Enumerations, numbers and
//! dates of other tools keep their type. Formatting and indentation
//! of a text don't survive.

mod read;
mod types;
mod write;
mod xhtml;

pub use read::read;
pub use write::write;

/// The namespace of ReqIF 1.0 to 1.2.
pub(crate) const NAMESPACE: &str = "http://www.omg.org/spec/ReqIF/20110401/reqif.xsd";
pub(crate) const XHTML: &str = "http://www.w3.org/1999/xhtml";

pub(crate) const FOREIGN_ID: &str = "ReqIF.ForeignID";
pub(crate) const NAME: &str = "ReqIF.Name";
pub(crate) const TEXT: &str = "ReqIF.Text";
pub(crate) const CHAPTER: &str = "ReqIF.ChapterName";

/// What this program is called in the head of a file.
pub(crate) const TOOL: &str = "octant";
