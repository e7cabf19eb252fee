//! The calibration core of a dual-axis rotational INS: the unit under test.
//!
//! A state machine that is stepped one sample at a time: it aligns, turns its own gimbals through a
//! position sequence, estimates its sensors' errors, compensates them and navigates. It sees
//! samples and aiding, never the truth, and it neither allocates nor asks for the time.
#![no_std]

pub mod alignment;
pub mod config;
pub mod external_turntable;
pub mod least_squares;
pub mod sequence;
