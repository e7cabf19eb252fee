//! Tests of the smoother, in one program.
#![allow(clippy::unwrap_used)]

mod batch;
mod constancy;
mod linear;
mod quadratic;
