//! Results of the cases of a campaign, stored and read.
//!
//! A worker appends results to a part file of its own ([`writer`]): `results/NAME.octres`, whose bytes
//! are those of `frame`. [`CampaignResults`] reads all parts of a folder, and the files of their own that older
//! versions wrote, `cases/xx/ID.json`. Nothing stored is ever changed: a result that doesn't count any
//! more is named by a record of its own.

pub mod error;
mod files;
mod frame;
mod index;
mod keep;
mod scan;
pub mod writer;

pub use files::file;
pub use index::{CampaignResults, StoredResult};
pub use keep::{StoreOutcome, forget_errors, keep, keep_in, part_has};

#[cfg(test)]
mod tests;
