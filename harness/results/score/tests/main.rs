//! Tests of scores, in one program.
#![allow(clippy::unwrap_used)]

mod common;

mod alignment;
mod allan;
mod attitude;
mod claim;
mod compare;
mod counterfactual;
mod drift;
mod equipment;
mod every_answer;
mod gaps;
mod heading_output;
mod health;
mod information;
mod junit;
mod numerics;
mod parameters;
mod run_series;
mod series;
mod sessions;
mod trace;
mod verdicts;
mod work;
