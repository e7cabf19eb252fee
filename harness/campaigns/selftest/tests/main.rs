//! Tests of the self-test, in one program.
#![allow(clippy::unwrap_used)]

mod answers;
mod golden;
mod judge;
mod limit;
mod record;
