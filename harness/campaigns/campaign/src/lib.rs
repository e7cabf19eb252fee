//! Campaigns: many cases of scenarios, planned, run anywhere, merged and judged.
//!
//! [`Campaign`](octant_scenario::campaign::Campaign) is the user's file. A campaign passes these modules in this order:
//!
//! | module | idea |
//! |---|---|
//! | [`mod@plan`] | the list of its cases, made once from the file |
//! | [`mod@execute`] | runs [one case](execute::case), or all of them in processes that do the [work](execute::work) |
//! | [`store`] | the results of cases, stored and read |
//! | [`journal`] | what was done with it: plans, looks, repetitions |
//! | [`merge`] | [tables](merge::results) of results, and those of all parts of a campaign as one |
//! | [`judge`] | the state of a campaign, its requirements, and whether its folder is consistent |
//! | [`report`] | numbers, discrepancies, and the evidence of both |
//!
//! [`table`] reads and writes the tables, [`against`] compares a predicted ensemble with the cases, [`sweep`] runs a grid
//! of one fault.

pub mod against;
pub mod execute;
pub mod journal;
pub mod judge;
pub mod merge;
pub mod plan;
pub mod report;
pub mod store;
pub mod sweep;
pub mod table;

// The tests name the crate as its users do. They are a part of its one test program.
#[cfg(test)]
extern crate self as octant_campaign;
#[cfg(test)]
#[path = "../tests/main.rs"]
mod tests;
