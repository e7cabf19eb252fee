//! Scheduled execution in `octant fmu run`: the ticks of each sort of clock, their order, and what is
//! refused. The FMU is strict: it fails if a call comes out of order.

use crate::common::foreign;
use crate::common::program::ends;
use std::path::{Path, PathBuf};

/// Copies the FMU with another description.
fn copy(change: impl Fn(&str) -> String) -> tempfile::TempDir {
    let folder = tempfile::Builder::new().suffix(".fmu").tempdir().unwrap();
    let from = foreign::unpacked("scheduled_fmi3");
    let text = std::fs::read_to_string(from.join("modelDescription.xml")).unwrap();
    let changed = change(&text);
    assert_ne!(changed, text, "nothing is changed");
    std::fs::write(folder.path().join("modelDescription.xml"), changed).unwrap();
    let platform = std::fs::read_dir(from.join("binaries")).unwrap().next().unwrap().unwrap();
    let binaries = folder.path().join("binaries").join(platform.file_name());
    std::fs::create_dir_all(&binaries).unwrap();
    for file in std::fs::read_dir(platform.path()).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), binaries.join(file.file_name())).unwrap();
    }
    folder
}

/// Inputs with two ticks of the triggered clock; the time 0.5 s is one of other clocks too.
fn inputs(folder: &Path) -> PathBuf {
    let path = folder.join("in.csv");
    std::fs::write(&path, "time,u,kick\n0,1,0\n0.33,2,1\n0.5,4,1\n").unwrap();
    path
}

/// Runs the FMU; returns the rows of its outputs.
fn rows(fmu: &Path, folder: &Path, more: &[&str]) -> Vec<Vec<f64>> {
    let (input, out) = (inputs(folder), folder.join("out.csv"));
    let [fmu, input, path] = [fmu, &input, &out].map(|path| path.to_str().unwrap());
    let arguments = ["fmu", "run", fmu, "--interface", "scheduled-execution", "--input", input];
    let arguments = [&arguments[..], &["--out", path, "--force"], more].concat();
    let (told, _) = ends(&arguments, 0);
    assert!(told.contains("scheduled execution"), "{told}");
    let text = std::fs::read_to_string(&out).unwrap();
    let mut lines = text.lines();
    let head = lines.next().unwrap().replace('"', "");
    assert_eq!(head, "time,sum,order,alarm_s,kicks,adapt_s,done_s");
    lines.map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect()
}

#[test]
fn partitions_are_activated_in_the_order_of_time_and_priority() {
    let folder = tempfile::tempdir().unwrap();
    let fmu = foreign::fmu("scheduled_fmi3");
    let own = rows(&fmu, folder.path(), &["--set", "bias=0.5"]);
    let shared = rows(&fmu, folder.path(), &["--set", "bias=0.5", "--process", "shared"]);
    assert_eq!(own, shared);
    // Row 0 is that of the initialization. All times are whole hundredths of a second.
    assert_eq!(own[0], [0.0; 7]);
    let mut rest = own[1..].iter();
    let (mut sum, mut alarm_s, mut kicks, mut adapt_s, mut done_s) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for hundredths in 0..=100 {
        let time_s = f64::from(hundredths) / 100.0;
        let (mut order, mut ticks) = (0.0, false);
        let mut tick = |clock: f64, due: bool| {
            if due {
                (order, ticks) = (order * 10.0 + clock, true);
            }
            due
        };
        // By priority: the countdown from the third tick of the slow one, the slow one, the fast one,
        // the column's, and the one whose interval changes at its second tick.
        if tick(4.0, hundredths == 53) {
            alarm_s = time_s;
        }
        tick(2.0, hundredths % 25 == 0);
        if tick(1.0, hundredths % 10 == 0) {
            let u = [1.0, 2.0, 4.0][usize::from(hundredths >= 33) + usize::from(hundredths >= 50)];
            sum += u + 0.5;
            if hundredths == 20 {
                done_s = time_s;
            }
        }
        if tick(5.0, hundredths == 33 || hundredths == 50) {
            kicks += 1.0;
        }
        let after = hundredths - 40;
        if tick(3.0, hundredths == 0 || after == 0 || (after > 0 && after % 15 == 0)) {
            adapt_s = time_s;
        }
        if ticks {
            let row = rest.next().unwrap();
            let expected = [time_s, sum, order, alarm_s, kicks, adapt_s, done_s];
            for (found, expected) in row.iter().zip(expected) {
                assert!((found - expected).abs() < 1e-12, "{time_s}: {row:?} {expected:?}");
            }
        }
    }
    assert_eq!(rest.next(), None);
    assert_eq!(sum, 35.5);
}

#[test]
fn the_smallest_number_is_the_highest_priority() {
    let folder = tempfile::tempdir().unwrap();
    let other = copy(|text| {
        text.replace("priority=\"1\"", "priority=\"9\"").replace("priority=\"4\"", "priority=\"1\"")
    });
    let rows = rows(other.path(), folder.path(), &[]);
    let at = |time_s: f64| rows[1..].iter().find(|row| (row[0] - time_s).abs() < 1e-9).unwrap()[2];
    // Without its interval in time the slow clock now comes last, the adapting one first.
    assert_eq!((at(0.0), at(0.5), at(1.0)), (312.0, 152.0, 312.0));
}

#[test]
fn a_shift_delays_the_first_tick_and_the_stop_ends_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let shifted = copy(|text| {
        text.replace("intervalDecimal=\"0.25\"", "intervalDecimal=\"0.25\" shiftDecimal=\"0.05\"")
    });
    let rows = rows(shifted.path(), folder.path(), &["--stop", "0.3"]);
    let times: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    // 0.3 s is a tick of the fast clock and the second of the slow one.
    assert_eq!(times.len(), 6, "{times:?}");
    for (found, expected) in times.iter().zip([0.0, 0.0, 0.05, 0.1, 0.2, 0.3]) {
        assert!((found - expected).abs() < 1e-12, "{times:?}");
    }
    assert_eq!(rows[5][2], 21.0);
}

#[test]
fn what_can_not_be_scheduled_is_told_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let scheduled = foreign::fmu("scheduled_fmi3");
    let stepped = foreign::fmu("clocks_fmi3");
    let without = copy(|text| text.replace("intervalDecimal=\"0.25\" ", ""));
    let zero = copy(|text| text.replace("intervalDecimal=\"0.1\"", "intervalDecimal=\"0\""));
    let tiny = copy(|text| text.replace("intervalDecimal=\"0.1\"", "intervalDecimal=\"1e-300\""));
    let clockless = copy(|text| {
        let lines = text.lines().filter(|line| !line.contains("<Clock "));
        let text = lines.collect::<Vec<_>>().join("\n");
        let text = text.replace("<Output valueReference=\"6\"/>", "");
        (1..=6).fold(text, |text, clock| text.replace(&format!(" clocks=\"{clock}\""), ""))
    });
    let file = folder.path().join("bad.csv");
    std::fs::write(&file, "time,fast\n0,1\n").unwrap();
    let by = ["--interface", "scheduled-execution"];
    let with = |more: &[&'static str]| [&by[..], more].concat();
    let bad: Vec<&str> = [&by[..], &["--input", file.to_str().unwrap()]].concat();
    for (fmu, arguments, status, expected) in [
        (&stepped, with(&[]), 2, "run by scheduled execution: it has co-simulation"),
        (&scheduled, vec![], 2, "it has scheduled execution, by which octant fmu run --interface"),
        (
            &scheduled,
            vec!["--interface", "cs"],
            2,
            "run by co-simulation: it has scheduled execution",
        ),
        (&scheduled, with(&["--step", "0.1"]), 2, "--step: found with --interface scheduled"),
        (
            &scheduled,
            with(&["--source", "x.toml"]),
            2,
            "--source: found with --interface scheduled",
        ),
        (&scheduled, bad, 2, "fast is a clock with times of its own, expected a triggered one"),
        (&without.path().to_owned(), with(&[]), 4, "the clock slow of"),
        (&without.path().to_owned(), with(&[]), 4, "found no interval, neither in the description"),
        (
            &zero.path().to_owned(),
            with(&[]),
            4,
            "found the interval 0.0 s, expected a time above 0",
        ),
        (&clockless.path().to_owned(), with(&[]), 4, "has no input clock"),
    ] {
        let all = [&["fmu", "run", fmu.to_str().unwrap()][..], &arguments].concat();
        let (_, error) = ends(&all, status);
        assert!(error.contains(expected), "{expected}: {error}");
    }
    // An interval that is lost in the rounding of a time, or has no end of ticks, makes no progress.
    let tiny = tiny.path().to_str().unwrap().to_owned();
    for start in ["0", "1"] {
        let all = [&["fmu", "run", &tiny][..], &by, &["--start", start, "--stop", "2"]].concat();
        let (_, error) = ends(&all, 4);
        assert!(error.contains("expected a time above 0, and 1e12 ticks at most"), "{error}");
    }
}
