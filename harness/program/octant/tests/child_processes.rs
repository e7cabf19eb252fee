//! Tests start processes by `octant_test_processes` alone, so that each ends with the test that started it.

use std::path::{Path, PathBuf};

/// Calls that start a process in another way.
const STARTS: [&str; 2] = [concat!("Command::", "new("), concat!(".spawn", "()")];

/// Lines with code of tests that start a process in another way. A file of a library has its unit tests at
/// its end.
fn found(text: &str, is_test: bool) -> Vec<usize> {
    let mut is_test = is_test;
    let lines = text.lines().enumerate().filter(|(_, line)| {
        is_test |= line.trim() == "#[cfg(test)]";
        is_test && STARTS.iter().any(|start| line.contains(start))
    });
    lines.map(|(k, _)| k + 1).collect()
}

fn search(folder: &Path, is_test: bool, starts: &mut Vec<String>, files: &mut usize) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_test = is_test || ["tests", "benches"].iter().any(|name| path.ends_with(name));
        if path.is_dir() {
            if !path.ends_with("target") && !path.ends_with("testing/src") {
                search(&path, is_test, starts, files);
            }
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            *files += usize::from(is_test);
            let text = std::fs::read_to_string(&path).unwrap();
            let lines = found(&text, is_test).into_iter();
            starts.extend(lines.map(|line| format!("{}:{line}", path.display())));
        }
    }
}

#[test]
fn every_process_of_a_test_ends_with_it() {
    let root = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../.."));
    let (mut starts, mut files) = (Vec::new(), 0);
    for folder in ["models", "fmu", "harness"] {
        search(&root.join(folder), false, &mut starts, &mut files);
    }
    assert!(files > 200, "{files} files of tests");
    let starts = starts.join("\n");
    assert!(starts.is_empty(), "expected octant_test_processes::start or command, found\n{starts}");
}

/// The same of rigs in Python, with `children.popen`.
#[test]
fn every_process_beside_a_rig_ends_with_it() {
    let rigs = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tests/rigs");
    let mut users = 0;
    for entry in std::fs::read_dir(rigs).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() || path.ends_with("children.py") || path.ends_with("step.py") {
            continue;
        }
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        users += usize::from(text.contains("from children import popen"));
        let found = text.contains("subprocess.Popen(");
        assert!(!found, "{}: expected children.popen, found subprocess.Popen", path.display());
    }
    assert!(users >= 5, "{users} rigs");
}

#[test]
fn a_process_that_is_started_otherwise_is_found() {
    let product = format!("let mut child = {}program);\n", STARTS[0]);
    let tests = format!("#[cfg(test)]\nmod tests {{\n    command{};\n}}\n", STARTS[1]);
    assert_eq!(found(&product, true), [1]);
    assert_eq!(found(&format!("{product}{tests}"), false), [4]);
}
