//! Tests of evidence, in one program.
#![allow(clippy::unwrap_used)]

mod attestation;
mod disposition;
mod folder;
mod manifest;
mod signature;
mod statements;
