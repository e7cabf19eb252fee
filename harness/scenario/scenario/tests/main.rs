//! Tests of scenarios from outside, in the one test program of the crate.

mod errors;
mod faults;
mod json_schema;
mod shipped;
mod solution_line;
