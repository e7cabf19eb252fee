//! Integration tests of the Earth model, in one program.
#![allow(clippy::unwrap_used)]

mod golden;
