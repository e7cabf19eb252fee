//! Tests of evidence, in one program.
#![allow(clippy::unwrap_used)]

#[path = "../../score/tests/common/mod.rs"]
mod common;

mod attestation;
mod discrepancies;
mod disposition;
mod folder;
mod manifest;
mod signature;
mod statements;
