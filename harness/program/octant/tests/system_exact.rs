//! Values that a system of FMUs carries and says exactly: whole numbers of 64 bits, values that are no
//! numbers, time events, and a hash of everything that is recorded.

use crate::common::foreign;
use crate::system_foreign::{component, connection, error, run, summary, system};
use std::path::Path;

/// Two FMUs of every type, one after the other.
fn chain() -> tempfile::TempDir {
    let ports =
        [("u64", "input"), ("u64_out", "output"), ("mode", "input"), ("mode_out", "output")];
    let elements =
        component("a", "signals_fmi3", &ports, &[]) + &component("b", "signals_fmi3", &ports, &[]);
    let wires = connection("a.u64_out", "b.u64") + &connection("a.mode_out", "b.mode");
    system(&["signals_fmi3"], &elements, &wires, "")
}

fn last_of(folder: &Path, name: &str) -> String {
    let text = std::fs::read_to_string(folder.join("values.csv")).unwrap();
    let mut rows = csv::Reader::from_reader(text.as_bytes());
    let at = rows.headers().unwrap().iter().position(|known| known == name).unwrap();
    rows.records().last().unwrap().unwrap()[at].to_owned()
}

#[test]
fn whole_numbers_of_64_bits_go_through_connections_digit_by_digit() {
    let folder = chain();
    let out = folder.path().join("run");
    let number = "18446744073709551613";
    let set = format!("a.u64={number}");
    let ran =
        run(folder.path(), &out, &["--set", &set, "--stop", "0.5 s", "--csv", "--in-process"]);
    assert_eq!(ran.status.code(), Some(0), "{}", error(&ran));
    for name in ["a.u64_out", "b.u64", "b.u64_out"] {
        assert_eq!(last_of(&out, name), number, "{name}");
    }
    let recording = std::fs::read(out.join("recording.mcap")).unwrap();
    let mut messages = mcap::MessageStream::new(&recording).unwrap();
    let found = messages.any(|message| {
        let data = message.unwrap().data.into_owned();
        String::from_utf8_lossy(&data).contains(&format!("\"b.u64_out\":{number}"))
    });
    assert!(found, "the recording has every digit");
}

#[test]
fn a_start_value_that_changes_an_unconnected_output_changes_the_hash() {
    let folder = chain();
    let hash = |name: &str, set: &[&str]| {
        let out = folder.path().join(name);
        let mut more = vec!["--stop", "0.3 s", "--in-process"];
        set.iter().for_each(|set| more.extend(["--set", *set]));
        let ran = run(folder.path(), &out, &more);
        assert_eq!(ran.status.code(), Some(0), "{}", error(&ran));
        summary(&out)["stream_hash"].as_str().unwrap().to_owned()
    };
    let plain = hash("plain", &[]);
    assert_eq!(hash("again", &[]), plain);
    // The value that it has anyway.
    assert_eq!(hash("same", &["a.i8=0"]), plain);
    for (at, set) in ["b.i8=3", "a.string=text", "b.u=[1, 2, 3]", "b.gain=2", "b.binary=00ff"]
        .into_iter()
        .enumerate()
    {
        assert_ne!(hash(&format!("other{at}"), &[set]), plain, "{set}");
    }
}

/// An FMU whose output isn't a number from 0.3 s on, and one that integrates it.
fn broken() -> tempfile::TempDir {
    let elements = component("timed", "timed_fmi3", &[("y", "output")], &[])
        + &component("sum", "gain_fmi2", &[("u", "input"), ("y", "output")], &[]);
    system(&["timed_fmi3", "gain_fmi2"], &elements, &connection("timed.y", "sum.u"), "")
}

#[test]
fn an_output_that_is_no_number_is_said_once_with_its_first_time_and_a_limit_ends_the_run() {
    let folder = broken();
    let out = folder.path().join("run");
    let more = ["--set", "timed.bad_from=0.3", "--stop", "1 s", "--step", "0.1 s", "--in-process"];
    let ran = run(folder.path(), &out, &more);
    assert_eq!(ran.status.code(), Some(0), "{}", error(&ran));
    let found = summary(&out)["warnings"].to_string();
    assert_eq!(found.matches("isn't a number").count(), 1, "{found}");
    assert!(found.contains("timed.y isn't a number, first at 0.3"), "{found}");
    assert!(found.contains("and went into sum.u"), "{found}");
    let limited = folder.path().join("limited");
    let ran = run(folder.path(), &limited, &[&more[..], &["--nan-limit", "3"]].concat());
    assert_eq!(ran.status.code(), Some(4), "{}", error(&ran));
    let found = error(&ran);
    assert!(found.contains("timed.y isn't a number, first at 0.3"), "{found}");
    assert!(
        found.contains("found 4 such values") && found.contains("expected 3 at most"),
        "{found}"
    );
}

#[test]
fn a_late_time_event_is_a_warning_of_the_system() {
    let fixed = foreign::copy("timed_fmi3", |text| {
        text.replace("canHandleVariableCommunicationStepSize=\"true\"", "")
    });
    let folder = broken();
    std::fs::remove_file(folder.path().join("resources/timed_fmi3.fmu")).unwrap();
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    foreign::pack(&mut archive, fixed.path(), "");
    let bytes = archive.finish().unwrap().into_inner();
    std::fs::write(folder.path().join("resources/timed_fmi3.fmu"), bytes).unwrap();
    let out = folder.path().join("run");
    let ran = run(folder.path(), &out, &["--stop", "1 s", "--step", "0.1 s", "--in-process"]);
    assert_eq!(ran.status.code(), Some(0), "{}", error(&ran));
    let found = summary(&out)["warnings"].to_string();
    assert!(found.contains("timed: the time event at 0.55 s is handled at 0.6"), "{found}");
}

#[test]
fn a_package_in_a_package_runs_as_the_system_that_it_is() {
    let inner = chain();
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    foreign::pack(&mut archive, inner.path(), "");
    let packed = archive.finish().unwrap().into_inner();
    let part = "<Component name=\"part\" type=\"application/x-ssp-package\" source=\"resources/chain.ssp\"/>";
    let outer = system(&[], part, "", "");
    std::fs::write(outer.path().join("resources/chain.ssp"), packed).unwrap();
    let runs = [(inner.path(), "a"), (outer.path(), "part.a")].map(|(folder, fmu)| {
        let out = folder.join("run");
        let set = format!("{fmu}.u64=18446744073709551613");
        let ran = run(folder, &out, &["--set", &set, "--stop", "0.3 s", "--csv", "--in-process"]);
        assert_eq!(ran.status.code(), Some(0), "{}", error(&ran));
        let text = std::fs::read_to_string(out.join("values.csv")).unwrap();
        text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    });
    assert_eq!(runs[0], runs[1]);
}
