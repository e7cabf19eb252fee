//! Tests of observability, in one program.
#![allow(clippy::unwrap_used)]

mod covariance_golden;
mod static_rank;
