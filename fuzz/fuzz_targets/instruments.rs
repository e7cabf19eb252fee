#![no_main]

#[path = "../instruments.rs"]
mod instruments;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| instruments::stream(bytes));
