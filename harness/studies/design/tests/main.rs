//! Tests of designs, as one program.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod bound;
mod cells;
mod confirm;
mod continuous;
mod evaluation;
mod largest;
mod measure;
mod search;
