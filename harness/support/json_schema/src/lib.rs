//! Validator of JSON Schema, for the tests of other crates.
//!
//! It is a dependency of a workspace member, and not of the tests alone, so that Cargo builds what it shares with
//! the program (`ahash`, `num-complex`) with the same features for both: tests and program are of one build.

pub use jsonschema::draft202012;
