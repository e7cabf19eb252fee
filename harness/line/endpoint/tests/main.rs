//! Tests of endpoints, in one program.
#![allow(clippy::unwrap_used)]

mod answer;
mod fmu;
