//! Tests of FMUs stepped alone and together, in one program.
#![allow(clippy::unwrap_used)]

mod convert;
mod dictionaries;
mod elements;
mod graph;
mod master;
mod order;
mod single;
mod solve;
mod ssp;
mod ssp_package;
mod system;
mod system_tuned;
mod tuned;
mod values;
