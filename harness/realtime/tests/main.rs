//! The tests of clocks and pacing from outside, in one program.

mod no_allocation;
