//! Tests of turntables and their drivers, in one program.
//!
//! Tables that follow a run are stopped by any panic in the process: if one test fails, others may fail
//! after it with "the harness panicked".
#![allow(clippy::unwrap_used)]

mod common;
mod drive;
mod following;
mod guard;
mod panic;
mod set_points;
mod shared;
mod stop;
mod track;
