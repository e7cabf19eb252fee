//! Tests of campaigns from outside, in the one test program of the crate.

mod other_writers;
mod planned_draws;
mod verdict_algebra;
