//! Tests of requirements, verdicts and their trace, in one program.
#![allow(clippy::unwrap_used)]

mod attributes;
mod decision;
mod equipment;
mod errors;
mod measures;
mod signed;
mod trace;
