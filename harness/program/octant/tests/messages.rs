//! Messages about wrong command lines and files: each says what to write instead.

use crate::common::program::{ends, octant_in};

/// Runs the program in a new folder with these files; returns what it says on stderr.
#[track_caller]
fn said(files: &[(&str, &str)], arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let output = octant_in(folder.path(), arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    said
}

const SCENARIO: &str = "schema = 1\n[procedure.calibration]\nduration = \"4 h\"\n";

#[test]
fn an_unknown_fault_is_told_with_what_there_is() {
    let none = said(&[("s.toml", SCENARIO)], &["run", "s.toml", "--only-faults=xyz"]);
    assert_eq!(
        none,
        "error: s.toml: --only-faults: no fault has the id \"xyz\": the scenario has no [[faults]]\n"
    );
    let spike =
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/scenarios/faults/spike.toml");
    let (_, near) = ends(&["run", spike, "--only-faults=spike"], 2);
    assert!(near.contains("did you mean \"spike-1\"? its faults: spike-1"), "{near}");
}

#[test]
fn a_seed_is_told_with_its_limits() {
    for seed in [&["--seed", "-1"][..], &["--seed=-1"], &["--seed", "x"], &["--seed", "1e30"]] {
        let said = said(&[("s.toml", SCENARIO)], &[&["run", "s.toml"][..], seed].concat());
        let expected = "for '--seed <N>': expected a whole number from 0 to 9223372036854775807";
        assert!(said.contains(expected), "{said}");
        assert!(said.starts_with("error: invalid value"), "{said}");
    }
}

#[test]
fn a_file_of_another_format_is_told_with_its_command() {
    let campaign = "schema = 1\ntitle = \"c\"\n[[scenarios]]\nid = \"s\"\nfile = \"s.toml\"\n";
    let files = [("s.toml", SCENARIO), ("c.toml", campaign)];
    assert_eq!(
        said(&files, &["campaign", "plan", "s.toml"]),
        "error: s.toml: found a scenario, expected a campaign: octant run s.toml runs it, and a campaign \
         names it in [[scenarios]]\n"
    );
    assert_eq!(
        said(&files, &["run", "c.toml"]),
        "error: c.toml: found a campaign, expected a scenario: octant campaign plan c.toml plans it\n"
    );
    let run = said(&files, &["campaign", "run", "c.toml"]);
    assert!(run.contains("found the file c.toml, expected the folder of a campaign"), "{run}");
}

#[test]
fn a_probability_belongs_to_a_campaign() {
    let requirement = "[[requirements]]\nid = \"A\"\ntext = \"t\"\npass = \"95 %\"\nlimit = \"1 nmi\"\n\
                       measure = \"navigation.radial_error_nmi.max\"\n";
    let said = said(&[("s.toml", format!("{SCENARIO}{requirement}").as_str())], &["run", "s.toml"]);
    assert!(
        said.contains("s.toml:7:8: requirements[0].pass: one run shows no probability"),
        "{said}"
    );
    assert!(said.contains("requirements = \"requirements.toml\""), "{said}");
}

#[test]
fn a_second_method_on_a_device_is_told_with_the_ways_out() {
    let device = "[endpoint]\nuri = \"udp:127.0.0.1:5999\"\n[baseline]\npositions = \"six\"\n";
    let said = said(&[("s.toml", format!("{SCENARIO}{device}").as_str())], &["run", "s.toml"]);
    assert!(said.contains("on the device at udp:127.0.0.1:5999, which has one core"), "{said}");
    assert!(said.contains("write endpoint.uri = \"in-process\", or remove [baseline]"), "{said}");
}

#[test]
fn a_limit_of_microseconds_is_told_with_an_example_of_its_size() {
    let text = format!("{SCENARIO}[realtime]\nlateness_p99 = 5\n");
    let said = said(&[("s.toml", text.as_str())], &["run", "s.toml"]);
    assert_eq!(
        said,
        "error: s.toml:5:16: realtime.lateness_p99: found the bare number 5, expected a time such as \
         \"500 us\"\n"
    );
}

#[test]
fn errors_of_the_command_line_have_the_same_style() {
    let (_, said) = ends(&["run", "s.toml", "--frobnicate"], 2);
    assert!(said.starts_with("error: unexpected argument '--frobnicate' found\n"), "{said}");
    assert!(said.ends_with("try --help for all options\n"), "{said}");
    let (_, said) = ends(&["rum"], 2);
    assert!(said.starts_with("error: unknown command \"rum\", did you mean \"run\"?"), "{said}");
}
