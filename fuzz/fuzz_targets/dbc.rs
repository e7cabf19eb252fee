#![no_main]

#[path = "../dbc.rs"]
mod dbc;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| dbc::bus(bytes));
