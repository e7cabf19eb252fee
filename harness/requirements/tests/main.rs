//! Tests of requirements and their trace, in one program.
#![allow(clippy::unwrap_used)]

mod attributes;
mod decision;
mod equipment;
mod errors;
mod formats;
mod measures;
mod reqif;
mod signed;
mod trace;
