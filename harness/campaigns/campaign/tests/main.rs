//! Tests of campaigns from outside, in the one test program of the crate.

mod verdict_algebra;
