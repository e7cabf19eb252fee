//! Tests of requirements and their trace, in one program.
#![allow(clippy::unwrap_used)]

mod errors;
mod formats;
mod trace;
