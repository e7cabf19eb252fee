//! Tests with real runs.
#![allow(clippy::unwrap_used, missing_docs)]
mod known;
mod resumed;
