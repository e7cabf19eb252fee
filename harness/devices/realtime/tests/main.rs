//! Integration tests of clocks and pacing, in one program.
#![allow(clippy::unwrap_used)]

mod host;
mod host_clock;
mod latency;
mod lateness;
mod no_allocation;
mod pace;
mod pps;
mod schedule;
mod series;
