//! The tests of the Earth from outside, in one program.
#![allow(clippy::unwrap_used)]

mod golden;
