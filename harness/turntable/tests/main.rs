//! The tests of turntables and their drivers, in one program.
#![allow(clippy::unwrap_used)]

mod common;
mod drive;
mod following;
mod panic;
mod stop;
