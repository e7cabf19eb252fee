//! Little address space: the program ends with a sentence and the status of a broken bench, wherever it runs out.

use crate::common::program::OCTANT;
use std::path::Path;
use std::process::{Output, Stdio};
use std::time::{Duration, Instant};

/// Ends what hangs.
const LONG: Duration = Duration::from_secs(120);

/// Runs the program with at most so much address space, KiB.
#[track_caller]
fn within(kib: u64, folder: &Path, arguments: &str) -> Output {
    let mut command = octant_test_processes::command("sh");
    command.arg("-c").arg(format!("ulimit -v {kib}; exec {OCTANT:?} {arguments}"));
    command.current_dir(folder).stdin(Stdio::null());
    let mut child =
        octant_test_processes::start(command.stdout(Stdio::piped()).stderr(Stdio::piped()));
    let begun = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if begun.elapsed() > LONG {
            child.kill().unwrap();
            panic!("it hangs with {kib} KiB: {:?}", child.output());
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    child.output()
}

const SCENARIO: &str = "schema = 1\ntitle = \"short\"\n[procedure.calibration]\nduration = \"20 s\"\n\
    stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }, { azimuth = \"0 deg\", roll = \"45 deg\" }]\n\
    [procedure.navigation]\nduration = \"5 s\"\n";

#[test]
fn the_program_that_runs_out_of_memory_says_so_and_is_an_error_of_the_bench() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("s.toml"), SCENARIO).unwrap();
    // The least with which the program starts, to a MiB; below it the loader says why.
    let starts = |mib: &u64| within(mib << 10, at, "--version").status.success();
    let (mut too_little, mut enough) = (1, 2048);
    assert!(starts(&enough));
    while enough - too_little > 1 {
        let middle = (enough + too_little) / 2;
        *(if starts(&middle) { &mut enough } else { &mut too_little }) = middle;
    }
    let (mut refused, mut done) = (0, false);
    // With less the first stack can't grow, which the system ends with a signal. With the last it has what it needs.
    for more in [4, 5, 6, 7, 8, 10, 12, 16, 24, 32, 64, 1024] {
        let output = within((enough + more) << 10, at, "run s.toml --out run --force");
        let error = String::from_utf8_lossy(&output.stderr);
        match output.status.code() {
            Some(4) => {
                refused += 1;
                let said = error.contains("out of memory") || error.contains("failed to ");
                assert!(said, "{more} MiB: {error}");
                assert!(error.starts_with("error: ") || error.contains("\nerror: "), "{error}");
            }
            Some(0) => done = true,
            status => panic!("{more} MiB: {status:?}: {error}"),
        }
    }
    assert!(refused > 0 && done, "refused {refused} times");
}
