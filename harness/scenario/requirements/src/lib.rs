//! Requirements in the files of other tools.
//!
//! - [`exchange`] reads and writes files by the format that their name tells; [`losses`] names what a format
//!   can't keep
//! - [`sdoc`] and [`reqif`] are formats of other tools: StrictDoc's documents, and ReqIF; a [`mapping`] has
//!   the names that those tools give to the parts of a requirement
//! - [`needs`] is the exchange file of sphinx-needs, `doorstop` (a feature of the build) Doorstop's folder
//! - [`xhtml`] is the formatting of texts
//! - [`strictdoc`] shows the trace from requirements to results in StrictDoc
//!
//! The requirements themselves, and `requirements.toml`, are of [`octant_verdict`].

#[cfg(feature = "doorstop")]
pub mod doorstop;
mod encoding;
pub mod error;
pub mod exchange;
mod foreign;
pub mod format;
mod hierarchy;
mod ledger;
mod lines;
pub mod losses;
pub mod mapping;
pub mod needs;
pub mod reqif;
pub mod sdoc;
pub mod strictdoc;
pub mod xhtml;

pub use error::{Attachment, Imported, Note};
