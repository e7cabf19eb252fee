//! Texts and clocks in the rows of `octant fmu run`.

use crate::common::foreign;
use crate::common::program::ends;

#[test]
fn texts_and_bytes_are_rows_of_a_run() {
    let folder = foreign::without_clocks();
    let out = folder.path().join("out.csv");
    let arguments = [
        "fmu",
        "run",
        folder.path().to_str().unwrap(),
        "--set",
        "string=\"größer, \\\"als\\\"\"",
        "--stop",
        "0.2",
        "--output",
        "string_out",
        "--output",
        "binary_out",
        "--output",
        "i8_out",
        "--out",
        out.to_str().unwrap(),
    ];
    ends(&arguments, 0);
    let text = std::fs::read_to_string(&out).unwrap();
    let last = text.lines().last().unwrap();
    assert_eq!(last, "0.2,\"größer, \"\"als\"\"\",\"\",0", "{text}");
}

#[test]
fn a_clock_ticks_by_a_column_of_a_run() {
    let folder = tempfile::tempdir().unwrap();
    let (input, out) = (folder.path().join("in.csv"), folder.path().join("out.csv"));
    std::fs::write(&input, "time,kick\n0,1\n0.2,0\n0.3,1\n").unwrap();
    let fmu = foreign::fmu("signals_fmi3");
    let paths = [&fmu, &input, &out].map(|path| path.to_str().unwrap());
    for process in ["own", "shared"] {
        let [fmu, input, out] = paths;
        let arguments =
            ["fmu", "run", fmu, "--input", input, "--stop", "0.5", "--process", process];
        let named = ["--output", "kicked", "--out", out, "--force"];
        ends(&[&arguments[..], &named[..]].concat(), 0);
        let text = std::fs::read_to_string(paths[2]).unwrap();
        let kicked: Vec<&str> =
            text.lines().skip(1).map(|line| line.split_once(',').unwrap().1).collect();
        assert_eq!(kicked, ["0", "1", "1", "1", "2", "2"], "{text}");
    }
}
