//! The program `octant`, started as a user starts it.

use super::readers::read_written;
use octant_test_processes::command;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// Path of this build's program.
pub const OCTANT: &str = env!("CARGO_BIN_EXE_octant");

/// Builds a command of the program with its arguments.
pub fn program(arguments: &[&str]) -> Command {
    let mut command = command(OCTANT);
    command.args(arguments);
    command
}

/// Runs the program to its end. What `octant run` has written is read by every reader.
#[track_caller]
pub fn octant(arguments: &[&str]) -> Output {
    let output = program(arguments).output().unwrap();
    read_written(arguments, Path::new(""), &output);
    output
}

/// Runs the program to its end in a folder, as [`octant`].
#[track_caller]
pub fn octant_in(folder: &Path, arguments: &[&str]) -> Output {
    let output = program(arguments).current_dir(folder).output().unwrap();
    read_written(arguments, folder, &output);
    output
}

/// Checks the exit status; returns stdout and stderr.
#[track_caller]
pub fn ended(output: Output, status: i32) -> (String, String) {
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(status), "{error}");
    (String::from_utf8(output.stdout).unwrap(), error)
}

/// Runs the program and checks its exit status; returns stdout and stderr.
#[track_caller]
pub fn ends(arguments: &[&str], status: i32) -> (String, String) {
    ended(octant(arguments), status)
}

/// Reads a file that contains one JSON value.
#[track_caller]
pub fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Runs a test in a process of its own, and checks that the test exists and passes.
#[track_caller]
pub fn passes_as_process(test: &str) -> Output {
    let output = test_as_process(test).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains("1 passed"), "{output:?}");
    output
}

/// Builds the command of an ignored test of this program, which another test runs in a process of
/// its own.
///
/// `test` includes its module: `fmu_process::prints`.
pub fn test_as_process(test: &str) -> Command {
    let mut command = command(std::env::current_exe().unwrap());
    command.args(["--exact", test, "--ignored", "--nocapture", "--test-threads=1"]);
    command
}
