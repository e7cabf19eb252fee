//! Measures of marine heading type tests, as functions of readings of a heading over time.
//!
//! A [`Series`] is what was read of one run-up: the heading that the unit shows and the true heading, at
//! times since the unit was switched on. Each measure takes readings at the times that the text of its
//! standard names, never at the best moment:
//!
//! - [`settle`]: settling time, settle point, root mean square of its readings
//! - [`repeatability`]: differences of the settle points of several run-ups
//! - [`motion`]: error after a motion of the table, amplitude and frequency of the error in it
//! - [`score`]: all of them together, as in the summary of a run
//!
//! Latency, follow-up and transmission of an output against a reference that turns are another subject: `octant-score`,
//! `heading_output`.
//!
//! A reading that is due and isn't in the record, or a record that is too short, gives no value. Angles are
//! in degrees, differences within ±180°, times in seconds.

pub mod angle;
pub mod motion;
mod reading;
pub mod repeatability;
pub mod score;
pub mod settle;

pub use reading::{Reading, Series};
