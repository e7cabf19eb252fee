//! Nights: the fault suite and campaigns, run every night and held against an accepted one.
//!
//! [`night`] is what is left of one, [`suite`] runs the fault suite, [`results`] reads what campaigns
//! came to, [`compare`](mod@compare) pairs two nights seed by seed and says what got worse, [`history`]
//! keeps every night's numbers, [`accept`](mod@accept) the baseline, [`render`] and [`trend`] show them.

pub mod accept;
pub mod compare;
pub mod history;
pub mod night;
pub mod render;
pub mod results;
pub mod suite;
pub mod trend;
