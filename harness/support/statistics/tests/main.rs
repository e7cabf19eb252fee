//! Tests of the statistics of campaigns, in one program.
#![allow(clippy::unwrap_used)]

mod allan;
mod cascade;
mod closed_forms;
mod cluster;
mod convergence;
mod coverage;
mod distribution;
mod draws;
mod looks;
mod multiple;
mod reference;
