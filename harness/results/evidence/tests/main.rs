//! Tests of evidence, in one program.
#![allow(clippy::unwrap_used)]

mod attestation;
mod disposition;
mod folder;
mod inside;
mod manifest;
mod signature;
