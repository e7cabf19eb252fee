//! Judges a campaign from its results: the state of its cases, the verdicts of its requirements, and whether its
//! folder says the same.
//!
//! [`status`] is the state of a campaign, [`trace`] links its requirements to cases and results, [`stop`] ends it
//! early, [`looks`] are those at its results, [`independence`] groups cases into independent draws, [`consistency`] compares the
//! files of its folder; `twins` compares the twins that cases share.

mod case_states;
pub mod consistency;
pub(crate) mod except_requirements;
pub mod independence;
mod joint;
pub mod looks;
pub mod shown;
pub mod status;
pub mod stop;
pub mod trace;
pub(crate) mod twins;
mod words;
