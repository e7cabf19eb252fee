//! What is asked of a run, and what came of it: requirements, measures, decisions and verdicts.
//!
//! - [`requirement`] defines requirements, [`file`](mod@file) reads and writes `requirements.toml`
//! - [`verdict`] defines verdicts and the comparison of a measure with a limit
//! - [`measures`] lists the numbers that can be required, [`signed`] those that have a sign;
//!   [`decision`] defines the verdict on a value near its limit, [`equipment`] the equipment of a run
//! - [`trace`] links requirements to cases, results and recordings, in both directions
//! - [`fields`] names the parts of a requirement in the formats of other tools; [`text`] and [`table`] read what
//!   their files share with `requirements.toml`, [`error`] has the problems of all of them
//!
//! Nothing in this crate knows units: the caller passes a [`file::Checker`] that does.

pub mod decision;
pub mod equipment;
pub mod error;
pub mod fields;
pub mod file;
pub mod measures;
pub mod requirement;
pub mod signed;
pub mod table;
pub mod text;
pub mod trace;
pub mod verdict;

pub use error::{RequirementsError, RequirementsProblem};
pub use requirement::{Requirement, Requirements};
pub use verdict::{Comparison, Verdict};
