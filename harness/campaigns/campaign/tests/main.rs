//! Tests of campaigns from outside, in the one test program of the crate.

mod other_writers;
mod verdict_algebra;
