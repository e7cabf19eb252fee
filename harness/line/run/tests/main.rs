//! Tests of runs, in one program.
#![allow(clippy::unwrap_used)]

mod at_rest;
mod findings;
mod follow;
mod minimise;
mod moments;
mod observers;
mod passes;
mod refusal;
mod rotation;
mod unit;
mod whiteness;
