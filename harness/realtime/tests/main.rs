//! Integration tests of clocks and pacing, in one program.

mod no_allocation;
