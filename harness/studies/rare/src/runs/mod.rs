//! The probability that a requirement of a scenario fails, and protection levels of a calibration.
//!
//! [`mod@input`] makes standard normal components of what the scenario draws, [`mod@outcome`] runs one point, [`many`]
//! runs many on several threads with the [`journal`]. [`mod@failure`] and [`mod@protection`] are the two results.

pub mod error;
pub mod failure;
pub mod input;
pub mod journal;
pub mod many;
pub mod outcome;
pub mod protection;
mod words;
