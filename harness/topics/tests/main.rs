//! The layouts that are shipped show what recordings and live runs have.
#![allow(clippy::unwrap_used)]

mod layouts;
