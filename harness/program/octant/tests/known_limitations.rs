//! Known limitations: each row of the page names the test that fails when the limitation is gone, or says why there is
//! none.

use crate::common::program::octant_in;
use crate::qualification::is_there;
use octant_scenario::Scenario;
use std::path::{Path, PathBuf};

const PAGE: &str = "docs/qualification/known-limitations.md";

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../.."))
}

fn read(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap()
}

#[test]
fn every_limitation_names_its_test_or_has_a_reason() {
    let page = read(PAGE);
    let rows =
        page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| limitation "));
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        assert_eq!(cells.len(), 3, "{PAGE}: {row}");
        let held = cells[2];
        let test = held.strip_prefix('`').and_then(|held| held.strip_suffix('`'));
        match (test.and_then(|test| test.split_once("::")), held.strip_prefix("no test: ")) {
            (Some((file, name)), _) => assert!(is_there(file, name), "{PAGE}: no test {held}"),
            (None, Some(reason)) => assert!(reason.len() > 15, "{PAGE}: {row}"),
            (None, None) => panic!("{PAGE}: {held:?}, expected `FILE::NAME` or no test: REASON"),
        }
        count += 1;
    }
    assert!(count > 20, "{count}");
}

/// Returns the message with which a scenario is refused; empty if it is accepted.
fn refusal(keys: &str) -> String {
    let text = format!("schema = 1\n{keys}");
    Scenario::parse(&text, "s.toml", Path::new(""), &[])
        .err()
        .map_or_else(String::new, |error| error.to_string())
}

/// Returns the message of a command that is refused.
#[track_caller]
fn refused(scenario: &str, command: &[&str]) -> String {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("s.toml"), format!("schema = 1\n{scenario}")).unwrap();
    let output = octant_in(folder.path(), command);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{command:?}: {said}");
    said
}

#[test]
fn sway_is_white_noise_by_default() {
    let text = "schema = 1\nmotion.kind = \"dockside\"\n[procedure.calibration]\n";
    let scenario = Scenario::parse(text, "s.toml", Path::new(""), &[]).unwrap();
    let written = scenario.to_toml_with(&[], &[]).unwrap();
    assert!(written.contains("sway = \"white\"\n"), "{written}");
}

#[test]
fn coloured_sway_excludes_further_states_and_a_prediction() {
    let coloured =
        "motion.kind = \"dockside\"\n[procedure.calibration.aiding]\nsway = \"coloured\"\n";
    assert_eq!(refusal(coloured), "");
    let further = "[procedure.calibration.further]\naccel_lever = { estimated = \"5 cm\" }\n";
    let said = refusal(&format!("{coloured}{further}"));
    assert!(said.contains("the filter has room for one of the two"), "{said}");
    let said = refused(coloured, &["observe", "s.toml"]);
    assert!(said.contains("whose estimate isn't linear"), "{said}");
}

#[test]
fn height_is_held_in_navigation() {
    let navigation = "[procedure.calibration]\n[procedure.navigation]\nduration = \"1 h\"\n";
    assert_eq!(refusal(navigation), "");
    let said = refusal(&format!("{navigation}height = \"free\"\n"));
    assert!(said.contains("procedure.navigation.height"), "{said}");
}

#[test]
fn a_reference_on_a_clock_of_its_own_is_refused() {
    let scenario = read("fixtures/scenarios/faults/clock-skew.toml");
    assert!(scenario.contains("# Expected (fail, refused)"), "{scenario}");
    let suite = read("fixtures/scenarios/faults/nightly.toml");
    assert!(
        suite.contains("scenario = \"clock-skew.toml\"\nexpect = \"fail\"\nbecause = \"refused\"")
    );
}

#[test]
fn a_shared_process_has_no_time_limit() {
    let shared =
        "source.uri = \"fmu:x.fmu\"\nsource.fmu.process = \"shared\"\n[procedure.calibration]\n";
    let said = refusal(&shared.replace("[p", "source.fmu.time_limit = \"1 s\"\n[p"));
    assert!(said.contains("nothing can end a call there"), "{said}");
}

/// The names in the row are those of the page's sections that were run.
#[test]
fn tools_that_were_not_run_are_marked() {
    let tools = read("docs/tools.md");
    let sections: Vec<&str> = tools.split("\n## ").skip(1).collect();
    let is_run = |section: &&&str| section.contains("**Run here**");
    let ran: Vec<&str> =
        sections.iter().filter(is_run).map(|section| section.lines().next().unwrap()).collect();
    assert_eq!(ran, ["FMPy", "Ecos", "libcosim and cosim"]);
    let limitations = read(PAGE);
    assert!(limitations.contains("were run in FMPy, Ecos, libcosim and the Rust crates"));
    let tool =
        |section: &&&str| !section.starts_with("Settings") && !section.starts_with("The files");
    for section in sections.iter().filter(tool) {
        let marked = section.contains("**Run here**") || section.contains("**Not run here");
        assert!(marked, "docs/tools.md: {}", section.lines().next().unwrap());
    }
}

#[test]
fn scheduled_execution_is_for_a_single_fmu() {
    let interface = "source.uri = \"fmu:x.fmu\"\nsource.fmu.interface = \"scheduled-execution\"\n";
    let said = refusal(&format!("{interface}[procedure.calibration]\n"));
    assert!(said.contains("source.fmu.interface"), "{said}");
}

#[test]
fn only_the_kalman_filter_is_predicted() {
    let other = "[procedure.calibration]\nestimator = \"least-squares\"\n";
    let said = refused(other, &["observe", "s.toml", "--protection"]);
    assert!(said.contains("expected estimator = \"kalman\""), "{said}");
}

#[test]
fn a_report_needs_the_results_of_cases() {
    let folder = tempfile::tempdir().unwrap();
    let campaign = root().join("fixtures/formats/campaign");
    let here = folder.path().join("c");
    std::fs::create_dir(&here).unwrap();
    // The plan and the merged tables, as another machine may have sent them.
    for name in std::fs::read_dir(&campaign).unwrap().map(|entry| entry.unwrap().path()) {
        if name.is_file() {
            std::fs::copy(&name, here.join(name.file_name().unwrap())).unwrap();
        }
    }
    let output = octant_in(folder.path(), &["campaign", "report", "c", "--out", "r.html"]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("4 discrepancies, 4 without a disposition"), "{said}");
}
