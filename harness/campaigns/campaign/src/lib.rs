//! Campaigns: many cases of scenarios, planned, run anywhere, merged and judged.
//!
//! [`Campaign`](octant_scenario::campaign::Campaign) is the user's file, [`plan`] the list of its
//! cases, [`case`] runs one of them, [`execute`] all of them in processes that do the [`work`],
//! [`mod@store`] stores their results and reads them, [`results`] writes their tables, [`merge`] merges
//! those of all shards, [`independence`] groups them into independent draws.

pub mod against;
pub mod alike;
mod besides;
pub mod case;
pub mod case_id;
mod case_places;
mod case_states;
pub mod chain;
mod draw;
pub mod execute;
mod execution;
pub mod factor_values;
pub mod factors;
pub mod facts;
mod in_plan_order;
pub mod independence;
pub mod inside;
mod make;
pub mod merge;
pub mod plan;
mod plan_error;
pub mod planned;
pub mod process;
pub mod reexecute;
pub mod report;
pub mod requirements;
mod result_error;
pub mod results;
pub mod selection;
mod shard;
pub mod shared;
mod shared_cases;
pub mod sites;
mod spill;
pub mod status;
pub mod stop;
pub mod store;
mod stream_key;
pub mod sweep;
pub mod table;
mod table_rows;
pub mod trace;
pub mod work;
mod worker;
