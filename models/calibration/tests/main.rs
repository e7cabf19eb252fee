//! Integration tests of the calibration core, in one program.
#![allow(clippy::unwrap_used)]

mod alignment;
mod external_turntable;
mod inertial_alignment;
mod instrument;
mod jacobian;
mod least_squares;
mod mechanization;
mod real_recording;
mod standstill;
#[cfg(feature = "state")]
mod state;
#[cfg(feature = "state")]
mod tune;
