//! The program `octant` of the wheel: its launcher (`launcher.c`) loads this library, without Python.
#![allow(unsafe_code, reason = "a function that a program of C calls by its name")]

use std::ffi::c_int;

/// Runs the program with the arguments of the process, and returns its exit status. The name has the version:
/// a launcher finds no library of another one.
// SAFETY: no other symbol has this name.
#[unsafe(export_name = concat!("octant_program_", env!("CARGO_PKG_VERSION")))]
extern "C" fn octant_program() -> c_int {
    // A panic has been told on stderr already; it may not go on into C. The status is that of a Rust program.
    std::panic::catch_unwind(octant::embedded::program).map_or(101, c_int::from)
}
