//! Results of the cases of a campaign, stored and read.
//!
//! A worker appends results to a part file of its own ([`writer`]): `results/NAME.octres`, whose bytes
//! are those of `frame`. [`CampaignResults`] reads all parts of a folder, and the files of older
//! versions, one for each result: `cases/xx/ID.json`. Nothing stored is ever changed: a later record
//! names a result that doesn't count any more. The [facts](facts::CaseFacts) of a result are stored beside it.

mod account;
pub mod error;
pub mod facts;
mod frame;
pub(crate) mod in_plan_order;
mod index;
mod keep;
mod part;
pub(crate) mod result_error;
mod scan;
pub mod segment;
mod stored;
pub(crate) mod stream_key;
pub mod writer;

pub use index::{CampaignResults, StoredResult, file};
pub use keep::{StoreOutcome, forget_errors, has_at, keep, keep_in};

#[cfg(test)]
mod tests;
