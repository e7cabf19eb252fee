//! Tests of observability, in one program.
#![allow(clippy::unwrap_used)]

mod static_rank;
