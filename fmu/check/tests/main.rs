//! Tests of the checks of FMUs, in one program.
#![allow(clippy::unwrap_used)]

mod binaries;
mod broken_rules;
mod functions;
mod identifiers;
mod names;
mod rules;
