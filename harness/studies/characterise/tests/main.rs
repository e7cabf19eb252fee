//! Tests of the characterisation.

#![allow(clippy::unwrap_used, reason = "tests")]

mod coverage;
mod golden;
mod recordings;
mod spectra;
mod synthetic;
mod temperature;
mod variances;
