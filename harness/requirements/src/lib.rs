//! Requirements of a campaign, and what became of them.
//!
//! - [`requirement`] is what a requirement is, [`file`](mod@file) is `requirements.toml`
//! - [`verdict`] is what anything comes to, and how a measure is held against a limit
//! - [`measures`] are the numbers that can be required, [`signed`] which of them have a sign, [`decision`] is what a value
//!   near its limit comes to, [`equipment`] what a run was measured with
//! - [`sdoc`] and [`reqif`] are the formats of others: StrictDoc's documents, and ReqIF
//! - [`trace`] goes from requirements to cases, results and recordings, and back; [`strictdoc`] shows it
//!   in StrictDoc
//!
//! Nothing here knows units: who does gives a [`file::Checker`].

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

pub use error::{Imported, Problem, RequirementsError};
pub use requirement::{Requirement, Requirements};
pub use verdict::{Comparison, Verdict};
