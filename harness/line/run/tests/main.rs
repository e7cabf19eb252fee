//! Tests of runs, in one program.
#![allow(clippy::unwrap_used)]

mod at_rest;
mod branches;
mod faults_any;
mod faults_compared;
mod faults_suite;
mod findings;
mod follow;
mod followed;
mod heading;
mod measures;
mod minimise;
mod moments;
mod observers;
mod passes;
mod real_recording;
mod refusal;
mod rotation;
mod unit;
mod whiteness;
mod wire_account;
