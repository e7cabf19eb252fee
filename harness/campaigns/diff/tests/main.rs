//! Tests of differences, in one program.
#![allow(clippy::unwrap_used)]

mod fields;
mod settings;
