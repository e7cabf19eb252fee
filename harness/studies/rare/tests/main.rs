//! Tests of rare failures, in one program.
#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]

mod estimators;
mod runs;
