//! Report of a campaign: numbers, discrepancies, and the evidence of both.
//!
//! [`rows`] reads the results, [`combination`] groups them, [`figures`], [`effects`] and [`requirement`] are
//! their statistics, [`envelope`] those of the errors over time, [`units`] the units of the page, [`sites`]
//! those at the site of a case, [`discrepancy`] lists everything that isn't a pass,
//! [`disposition`](octant_evidence::disposition) has its dispositions, [`CampaignReport`] puts them together.
//! The crate of the pages writes all of it into the folder of the campaign.

mod about;
mod columns;
pub mod combination;
mod contents;
mod curves;
pub mod discrepancy;
pub mod effects;
pub mod envelope;
mod error;
pub mod figures;
pub mod file_names;
pub mod junit;
mod makers;
mod outcome;
pub mod requirement;
mod row_bytes;
pub mod rows;
pub mod selftest;
pub mod sites;
mod spread;
mod tables;
pub mod units;

pub use contents::{CampaignReport, POLICY, ROWS_MAX, SCHEMA, Statistics, again};
pub use error::ReportError;
