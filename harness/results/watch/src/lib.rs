//! Watches a run from outside, during the run and afterwards.
//!
//! A run writes its recording every 250 ms ([`FLUSH_INTERVAL`](octant_recorder::FLUSH_INTERVAL)).
//! The watching program reads that file as it grows ([`tail`]) and keeps the state of the run
//! ([`state`]); [`follow`] knows the place of the file and the end of the run. The state is shown
//! as a line ([`plain`]), as a dashboard or in Foxglove (`dashboard`, `foxglove`: features).
//!
//! Nothing here communicates with the run: it can't be delayed, and doesn't know that it is
//! watched.

#[cfg(feature = "dashboard")]
pub mod dashboard;
pub mod follow;
#[cfg(feature = "foxglove")]
pub mod foxglove;
#[cfg(feature = "foxglove")]
pub mod gate;
pub mod place;
pub mod plain;
pub mod tail;

pub use octant_views::{about, published, series, state};
