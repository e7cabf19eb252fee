//! Tests of designs, as one program.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "tests")]

mod bound;
mod cells;
mod evaluation;
mod search;
