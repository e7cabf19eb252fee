//! Tests of the pages, in one program.
#![allow(clippy::unwrap_used, clippy::indexing_slicing, reason = "tests")]

mod certificate;
mod chart;
mod filtered;
mod innovations;
mod marks;
mod page;
mod run;
mod units;
