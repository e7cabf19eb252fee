//! Campaigns: many cases of scenarios, planned, run anywhere, merged and judged.
//!
//! [`file`] is what a user writes, [`plan`] the list of cases that it makes, [`case`] one of them run,
//! [`execute`] all of them, each in a process of its own, [`results`] their tables, [`merge`] those of all
//! shards.

pub mod case;
mod draw;
pub mod emit;
pub mod execute;
pub mod file;
pub mod merge;
pub mod plan;
pub mod results;
pub mod status;
pub mod table;
