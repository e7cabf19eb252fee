//! Requirements of a campaign and their results.
//!
//! - [`requirement`] defines requirements, [`file`](mod@file) reads and writes `requirements.toml`
//! - [`verdict`] defines verdicts and the comparison of a measure with a limit
//! - [`measures`] lists the numbers that can be required, [`signed`] those that have a sign;
//!   [`decision`] defines the verdict on a value near its limit, [`equipment`] the equipment of a run
//! - [`sdoc`] and [`reqif`] are formats of other tools: StrictDoc's documents, and ReqIF
//! - [`trace`] links requirements to cases, results and recordings, in both directions; [`strictdoc`]
//!   shows the trace in StrictDoc
//!
//! Nothing in this crate knows units: the caller passes a [`file::Checker`] that does.

pub mod decision;
mod document;
pub mod equipment;
pub mod error;
mod fields;
pub mod file;
pub mod measures;
pub mod reqif;
pub mod requirement;
pub mod sdoc;
pub mod signed;
pub mod strictdoc;
pub mod trace;
pub mod verdict;

pub use error::{Imported, RequirementsError, RequirementsProblem};
pub use requirement::{Requirement, Requirements};
pub use verdict::{Comparison, Verdict};
