//! Times and whole numbers in `octant fmu run`: rows between communication points, a short last step,
//! time events, integers of 64 bits, bytes.

use crate::common::foreign;
use crate::common::program::ends;
use std::path::{Path, PathBuf};

/// Makes a copy of a foreign FMU whose step can't vary.
fn fixed(name: &str) -> tempfile::TempDir {
    foreign::copy(name, |text| text.replace("canHandleVariableCommunicationStepSize=\"true\"", ""))
}

/// Runs an FMU on inputs in this process; returns the last row and the messages.
fn run(fmu: &Path, inputs: &str, more: &[&str]) -> (Vec<String>, String) {
    let folder = tempfile::tempdir().unwrap();
    let (input, out) = (folder.path().join("in.csv"), folder.path().join("out.csv"));
    std::fs::write(&input, inputs).unwrap();
    let paths = [fmu, &input, &out].map(|path: &Path| path.to_str().unwrap().to_owned());
    let [fmu, input, out] = paths.each_ref().map(String::as_str);
    let mut arguments = vec!["fmu", "run", fmu, "--process", "shared", "--out", out];
    if !inputs.is_empty() {
        arguments.extend(["--input", input]);
    }
    arguments.extend(more);
    let (_, said) = ends(&arguments, 0);
    let text = std::fs::read_to_string(out).unwrap();
    (text.lines().last().unwrap().split(',').map(str::to_owned).collect(), said)
}

fn number(row: &[String], at: usize) -> f64 {
    row[at].parse().unwrap()
}

const TIMES: [&str; 6] = ["--output", "held_since", "--output", "shortest", "--output", "y"];

#[test]
fn a_row_between_communication_points_reaches_the_fmu_at_its_time_or_late_with_a_warning() {
    // Two rows of one time, and one between two points.
    let inputs = "time,level\n0,0\n0.2,0\n0.35,7\n";
    let (row, said) = run(&foreign::unpacked("timed_fmi3"), inputs, &TIMES);
    assert!((number(&row, 1) - 0.35).abs() < 1e-9, "{row:?}");
    assert!((number(&row, 2) - 0.05).abs() < 1e-9, "{row:?}");
    assert!(!said.contains("warning"), "{said}");
    let inputs = "time,level\n0,0\n0.35,7\n0.37,8\n0.81,9\n";
    let (row, said) = run(fixed("timed_fmi3").path(), inputs, &TIMES);
    assert!(
        (number(&row, 1) - 0.9).abs() < 1e-9 && (number(&row, 2) - 0.1).abs() < 1e-9,
        "{row:?}"
    );
    assert!(
        said.contains(
            "3 rows of inputs between communication points reached the FMU at the next one, the first of 0.35 s at 0.4 s"
        ) && said.contains("the largest shift 0.09"),
        "{said}"
    );
    assert!(said.contains("1 of them never"), "{said}");
}

#[test]
fn a_short_last_step_is_for_fmus_that_make_one() {
    let more = [&TIMES[..], &["--stop", "0.95"]].concat();
    let (row, said) = run(&foreign::unpacked("timed_fmi3"), "", &more);
    assert!(row[0] == "0.95" && (number(&row, 2) - 0.05).abs() < 1e-9, "{row:?}");
    assert!(!said.contains("last step"), "{said}");
    let (row, said) = run(fixed("timed_fmi3").path(), "", &more);
    assert_eq!(row[0], "0.9");
    assert!(said.contains("the last step, from 0.9 s to 0.95 s, wasn't made"), "{said}");
}

#[test]
fn a_time_event_acts_at_its_time_or_late_with_a_warning() {
    let (row, said) = run(&foreign::unpacked("timed_fmi3"), "", &TIMES);
    assert!(
        (number(&row, 3) - 101.0).abs() < 1e-9 && !said.contains("time event"),
        "{row:?} {said}"
    );
    let (row, said) = run(fixed("timed_fmi3").path(), "", &TIMES);
    assert!((number(&row, 3) - 101.0).abs() < 1e-9, "{row:?}");
    assert!(said.contains("the time event at 0.55 s is handled at 0.6"), "{said}");
}

fn signals() -> PathBuf {
    foreign::unpacked("signals_fmi3")
}

#[test]
fn whole_numbers_of_64_bits_go_through_an_fmu_digit_by_digit() {
    let inputs = "time,u64,i64\n0,18446744073709551615,-9007199254740993\n";
    let outputs = ["--output", "u64_out", "--output", "i64_out", "--stop", "0.2"];
    let (row, _) = run(&signals(), inputs, &outputs);
    assert_eq!(row[1..], ["18446744073709551615", "-9007199254740993"]);
    let set = ["--set", "u64=\"18446744073709551615\"", "--set", "i64=9007199254740993"];
    let (row, _) = run(&signals(), "", &[&set[..], &outputs].concat());
    assert_eq!(row[1..], ["18446744073709551615", "9007199254740993"]);
    let wrong =
        ["fmu", "run", signals().to_str().unwrap(), "--set", "u64=\"18446744073709551616\""]
            .map(str::to_owned);
    let (_, said) = ends(&wrong.each_ref().map(String::as_str), 2);
    assert!(
        said.contains("found \"18446744073709551616\"")
            && said.contains("a whole number from 0 to 18446744073709551615"),
        "{said}"
    );
}

#[test]
fn an_enumeration_beyond_2_to_the_53_is_not_another() {
    let far = foreign::copy("signals_fmi3", |text| {
        text.replace(
            "<Item name=\"busy\" value=\"-2\"/>",
            "<Item name=\"near\" value=\"9007199254740992\"/><Item name=\"far\" value=\"9007199254740993\"/>",
        )
    });
    let outputs = ["--output", "mode_out", "--stop", "0.2"];
    let (row, _) = run(far.path(), "time,mode\n0,9007199254740993\n", &outputs);
    assert_eq!(row[1], "9007199254740993");
    let (row, _) = run(far.path(), "", &[&outputs[..], &["--set", "mode=far"]].concat());
    assert_eq!(row[1], "9007199254740993");
}

#[test]
fn bytes_are_set_as_hexadecimal_digits() {
    let folder = foreign::without_clocks();
    let outputs = ["--output", "binary_out", "--stop", "0.2"];
    // The FMU gives them back in the other order.
    let (row, _) = run(folder.path(), "", &[&outputs[..], &["--set", "binary=00ff2a"]].concat());
    assert_eq!(row[1], "\"2aff00\"");
    for wrong in ["binary=00f", "binary=zz", "binary=12"] {
        let path = folder.path().to_str().unwrap();
        let (_, said) = ends(&["fmu", "run", path, "--set", wrong], 2);
        assert!(said.contains("expected bytes as pairs of hexadecimal digits"), "{wrong}: {said}");
    }
}
