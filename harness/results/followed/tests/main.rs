//! Tests of whether a navigation followed its samples, in one program.
#![allow(clippy::unwrap_used)]

mod power;
mod regression;
