//! Tests of the nightly regression, in one program.
#![allow(clippy::unwrap_used)]

mod change;
mod trend;
mod units;
