//! Requirements of a campaign and their results.
//!
//! - [`requirement`] defines requirements, [`file`](mod@file) reads and writes `requirements.toml`
//! - [`verdict`] defines verdicts and the comparison of a measure with a limit
//! - [`measures`] lists the numbers that can be required, [`signed`] those that have a sign;
//!   [`decision`] defines the verdict on a value near its limit, [`equipment`] the equipment of a run
//! - [`sdoc`] and [`reqif`] are formats of other tools: StrictDoc's documents, and ReqIF; a [`mapping`] has
//!   the names that those tools give to the parts of a requirement
//! - [`needs`] is the exchange file of sphinx-needs, `doorstop` (a feature of the build) Doorstop's folder
//! - [`exchange`] reads and writes files by the format that their name tells; [`losses`] names what a format
//!   can't keep
//! - [`trace`] links requirements to cases, results and recordings, in both directions; [`strictdoc`]
//!   shows the trace in StrictDoc
//!
//! Nothing in this crate knows units: the caller passes a [`file::Checker`] that does.

pub mod decision;
mod document;
#[cfg(feature = "doorstop")]
pub mod doorstop;
pub mod equipment;
pub mod error;
pub mod exchange;
mod fields;
pub mod file;
mod foreign;
pub mod format;
mod hierarchy;
pub mod losses;
pub mod mapping;
pub mod measures;
pub mod needs;
pub mod reqif;
pub mod requirement;
pub mod sdoc;
pub mod signed;
pub mod strictdoc;
pub mod trace;
pub mod verdict;
mod xhtml;

pub use error::{Attachment, Imported, Note, RequirementsError, RequirementsProblem};
pub use requirement::{Requirement, Requirements};
pub use verdict::{Comparison, Verdict};
