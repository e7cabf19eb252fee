//! Tests of the statistics of campaigns, in one program.
#![allow(clippy::unwrap_used)]

mod allan;
mod closed_forms;
mod cluster;
mod coverage;
mod draws;
mod multiple;
mod reference;
