//! Watching a run from outside, while it goes on and after it.
//!
//! A run hands its recording to the system every 250 ms
//! ([`FLUSH_INTERVAL`](octant_recorder::FLUSH_INTERVAL)). Who watches reads that file as it grows
//! ([`tail`]) and keeps what is known of the run ([`state`]); [`follow`] knows where the file is
//! and how the run ended. What is known is shown as a line ([`plain`]), as a dashboard
//! ([`dashboard`]), or to Foxglove (`foxglove`, a feature).
//!
//! Nothing here talks to the run: it can't be made late, and doesn't know who watches.

pub mod about;
pub mod dashboard;
pub mod follow;
#[cfg(feature = "foxglove")]
pub mod foxglove;
pub mod place;
pub mod plain;
pub mod published;
pub mod series;
pub mod state;
pub mod tail;
