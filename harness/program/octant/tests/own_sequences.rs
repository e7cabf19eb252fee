//! Names of sequences that a scenario gives itself.

use crate::common::program::{ended, octant_in};
use octant_scenario::{Method, Place, Problem, Scenario};
use serde_json::Value;
use std::path::Path;

const HEAD: &str =
    "schema = 1\ntitle = \"named\"\n[imu]\nrate = \"20 Hz\"\n[procedure.calibration]\n";
const STOPS: &str = "stops = [{}, { roll = \"45 deg\" }, { roll = \"90 deg\" }]\n";
const OTHERS: &str = "stops = [{}, { roll = \"90 deg\" }]\n";

fn parse(text: &str, set: &[&str]) -> Result<Scenario, Vec<Problem>> {
    let set: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    Scenario::parse(text, "test.toml", Path::new(""), &set).map_err(|error| error.problems)
}

fn labels(text: &str, set: &[&str]) -> [String; 2] {
    let scenario = parse(text, set).unwrap();
    [Method::Primary, Method::Baseline].map(|method| scenario.method_label(method))
}

#[track_caller]
fn refused(text: &str, (line, column): (usize, usize), path: &str, parts: &[&str]) {
    let problems = parse(text, &[]).unwrap_err();
    assert_eq!(problems.len(), 1, "{problems:?}");
    let Problem { place, path: found, message } = &problems[0];
    assert_eq!((place, found.as_str()), (&Place::File { line, column }, path), "{message}");
    for part in parts {
        assert!(message.contains(part), "{part:?} is not in {message:?}");
    }
}

#[test]
fn a_method_of_own_stops_is_called_by_its_name() {
    let one = format!("{HEAD}{STOPS}name = \"half a turn\"\n");
    assert_eq!(labels(&one, &[])[0], "half a turn with G states");
    assert_eq!(labels(&format!("{HEAD}{STOPS}"), &[])[0], "own stops with G states");
    assert_eq!(labels(HEAD, &[])[0], "eight positions with G states");
    // A word in another alphabet is counted by its characters: 60 of them have 120 bytes.
    let long = "é".repeat(60);
    assert_eq!(
        labels(&format!("{HEAD}{STOPS}name = \"{long}\"\n"), &[])[0],
        format!("{long} with G states")
    );
    // A named sequence in place of the stops takes the name with them, and other stops keep it.
    assert_eq!(
        labels(&one, &["procedure.calibration.positions=six"])[0],
        "six positions with G states"
    );
    assert_eq!(
        labels(&one, &["procedure.calibration.stops=[{}, { roll = \"90 deg\" }]"])[0],
        "half a turn with G states"
    );
}

#[test]
fn a_baseline_inherits_the_name_with_the_stops_alone() {
    let one = format!("{HEAD}{STOPS}name = \"tilts\"\n[baseline]\n");
    for (baseline, expected) in [
        ("g_states = false\n".to_owned(), "tilts without G states"),
        (OTHERS.to_owned(), "own stops with G states"),
        (format!("{OTHERS}name = \"no tilts\"\n"), "no tilts with G states"),
        (format!("{STOPS}name = \"tilts\"\n"), "tilts with G states"),
        ("name = \"again\"\n".to_owned(), "again with G states"),
        ("positions = \"six\"\n".to_owned(), "six positions with G states"),
    ] {
        let found = labels(&format!("{one}{baseline}"), &[]);
        assert_eq!(found, ["tilts with G states", expected], "{baseline}");
    }
}

#[test]
fn names_that_say_nothing_or_two_things_are_refused() {
    let key = "procedure.calibration.name";
    let named = |name: &str| format!("{HEAD}{STOPS}name = \"{name}\"\n");
    refused(&named(""), (7, 8), key, &["found an empty text", "1 to 60 characters"]);
    refused(&named("  "), (7, 8), key, &["found an empty text"]);
    refused(&named("a\\u0007b"), (7, 8), key, &["control character '\\u{7}'"]);
    refused(&named("a\\nb"), (7, 8), key, &["control character '\\n'"]);
    refused(&named(&"x".repeat(61)), (7, 8), key, &["found 61 characters", "1 to 60"]);
    refused(&named("eight"), (7, 8), key, &["found \"eight\", the name of a built-in sequence"]);
    let built_in = ["the built-in sequence has its name, \"eight\"", "expected stops"];
    refused(&format!("{HEAD}name = \"mine\"\n"), (6, 8), key, &built_in);
    let six = format!("{HEAD}{STOPS}[baseline]\npositions = \"six\"\nname = \"mine\"\n");
    refused(&six, (9, 8), "baseline.name", &["has its name, \"six\""]);
    let twice = format!("{}[baseline]\n{OTHERS}name = \"tilts\"\n", named("tilts"));
    let both = ["found \"tilts\"", "procedure.calibration.name at line 7, column 8", "other stops"];
    refused(&twice, (10, 8), "baseline.name", &both);
}

#[test]
fn a_resolved_scenario_keeps_the_name() {
    let scenario = parse(&format!("{HEAD}{STOPS}name = \"tilts\"\n"), &[]).unwrap();
    let (_, _, draws) =
        octant_source::configure::configurations(&scenario, Method::Primary, 1).unwrap();
    let again = parse(&scenario.to_resolved_toml(1, &draws), &[]).unwrap();
    assert_eq!(again.calibration.unwrap().name, "tilts");
}

#[test]
fn every_table_of_a_run_says_the_names() {
    let here = tempfile::tempdir().unwrap();
    let text = format!(
        "{HEAD}duration = \"3 min\"\n{STOPS}name = \"with a tilt\"\n[procedure.navigation]\n\
         duration = \"1 min\"\n[baseline]\n{OTHERS}name = \"level & edge\"\n"
    );
    std::fs::write(here.path().join("s.toml"), &text).unwrap();
    // A comparison has marks up to 24 h.
    let day = text.replace("\"1 min\"", "\"24 h\"");
    std::fs::write(here.path().join("day.toml"), day).unwrap();
    let names = ["with a tilt with G states", "level & edge with G states"];
    let shows = |text: &str| {
        for name in names {
            assert!(text.contains(name), "{name:?} is not in\n{text}");
        }
        assert!(!text.contains("own stops"), "{text}");
    };
    shows(&ended(octant_in(here.path(), &["run", "s.toml", "--out", "run"]), 0).0);
    let read = |name: &str| std::fs::read_to_string(here.path().join("run").join(name)).unwrap();
    let summary: Value = serde_json::from_str(&read("summary.json")).unwrap();
    assert_eq!(summary["method"], names[0]);
    assert_eq!(summary["baseline"]["label"], names[1]);
    shows(&read("report.html").replace("&amp;", "&"));
    shows(&ended(octant_in(here.path(), &["observe", "s.toml"]), 0).0);
    shows(&ended(octant_in(here.path(), &["compare", "day.toml", "--seeds", "2"]), 0).0);
    let (page, _) = ended(octant_in(here.path(), &["watch", "run", "--once"]), 0);
    assert!(page.contains("with a tilt with G states, seed 1"), "{page}");
}
