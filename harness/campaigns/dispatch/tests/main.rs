//! Tests of campaigns on other computers, in one program.
#![allow(clippy::unwrap_used, reason = "tests")]

mod bundle;
mod emit;
mod planned;
#[cfg(feature = "object-storage")]
mod storage;
