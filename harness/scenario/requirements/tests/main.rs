//! Tests of requirements and their trace, in one program.
#![allow(clippy::unwrap_used)]

mod archive;
mod attributes;
mod decision;
mod dialects;
#[cfg(feature = "doorstop")]
mod doorstop;
mod equipment;
mod errors;
mod formats;
mod measures;
mod needs;
mod reqif;
mod signed;
mod trace;
