//! Tests of the wire protocol, in one program.
#![allow(clippy::unwrap_used)]

mod agreement;
mod can_load;
#[cfg(unix)]
mod clients;
mod common;
mod damage;
mod database;
mod fuzz_corpus;
mod layout;
mod no_allocation;
mod parameters;
mod readme;
mod requests;
mod round_trip;
mod serial_load;
mod slots;
mod steps;
mod texts;
mod vectors;
